#include "simulation.h"

#include "arrays.h"
#include "defs.h"

#include "filasofia/core/error.h"
#include "filasofia/physics/give.h"

#include <numeric>

namespace filasofia::python {
namespace {

using namespace physics;

BodyId body(nb::handle value, const char* method) { return readArgument<BodyId>(value, method, "body"); }
int element(nb::handle value, const char* method) { return readArgument<int>(value, method, "element", nonNegative()); }

/// Gives a command that was read from a Def. Returns the id that it gives, if it gives one.
template <class Command> nb::object give(HeldSimulation& held, const Command& command)
{
    Session& session = usable(held, "apply");
    if constexpr (std::is_same_v<Command, physics::Reset>) {
        session.simulation().reset(); // removes the paint, too
        held.owed = 0.0;
    } else if constexpr (std::is_same_v<Command, SetMaterial>) {
        const nb::gil_scoped_release free; // it builds a solver
        session.physics().setMaterial(command.id, command.material);
    } else if (const AttachmentId id = physics::give(session.physics(), command)) {
        return Convert<AttachmentId>::make(id);
    }
    return nb::none();
}

using Applied = std::variant<RemoveBody, SetPose, SetGravity, SetForces, SetPressure, SetWrench, Release, RemovePiece,
                             Pause, SetJoint, SetHaptic, SetTissue, SetFibreStress, SetCurvature, SetCutting, SetCavity,
                             SetMaterial, Attach, AttachRigid, Grasp, ApplyClip, physics::Reset>;

/// Reads the alternative whose class the object is of: SetMaterial cannot be copied, so this is no Convert<variant>.
template <class... T> nb::object applyAs(HeldSimulation& held, nb::handle command, const std::variant<T...>*)
{
    const std::string name = defName(command);
    nb::object out;
    const auto attempt = [&]<class Command>(const Command*) {
        if (name != typeName<Command>() || PyType_Check(command.ptr())) return false;
        out = give(held, readDef<Command>(command, typeName<Command>()));
        return true;
    };
    if ((attempt(static_cast<const T*>(nullptr)) || ...)) return out;
    std::string all;
    ((all += text(all.empty() ? "" : ", ", typeName<T>())), ...);
    throw nb::type_error(text("apply: the command must be one of ", all, ", got ", shown(command)).c_str());
}

/// How many nodes a body has now, with those that cuts have made; 0 for a rigid one.
std::size_t nodeCount(PhysicsServer& physics, BodyId id)
{
    const auto def = physics.def(id);
    if (const auto frame = physics.latest())
        if (const frame::SoftBodyFrame* now = frame->softBody(id)) return now->positions.size();
    if (const auto* rod = std::get_if<RodBodyDef>(&*def)) return centreLine(*rod).size();
    const auto* soft = std::get_if<SoftBodyDef>(&*def);
    if (!soft) return 0;
    return isShell(*soft) ? loadShell(*soft)->vertices.size() : loadMesh(*soft)->nodes.size();
}

/// Indices of nodes, or a mask with a truth value per node.
std::vector<int> readNodes(nb::handle nodes, PhysicsServer& physics, BodyId id)
{
    const nb::module_ numpy = nb::module_::import_("numpy");
    nb::object array;
    try {
        array = numpy.attr("asarray")(nodes);
    } catch (nb::python_error&) { // no array at all: readRows() says so
    }
    const bool isMask = array.is_valid() && nb::cast<std::string>(array.attr("dtype").attr("kind")) == "b";
    if (!isMask) return readRows<int, int, 1>(nodes, "set_forces: nodes");
    const std::size_t count = nodeCount(physics, id);
    if (nb::cast<std::size_t>(array.attr("ndim")) != 1 || nb::cast<std::size_t>(array.attr("size")) != count)
        fail("set_forces: nodes must be indices, or a mask with a truth value for each of the body's ", count,
             " nodes, got a mask of the shape ", nb::cast<std::string>(nb::str(nb::object(array.attr("shape")))));
    return readRows<int, int, 1>(nb::object(numpy.attr("flatnonzero")(array)), "set_forces: nodes");
}

/// Nodal forces as Python gives them: a list of NodalForce, or rows of an array with their nodes.
std::vector<NodalForce> readForces(nb::handle forces, nb::handle nodes, PhysicsServer& physics, BodyId id)
{
    if (nodes.is_none() && !nb::hasattr(forces, "__array__"))
        return readArgument<std::vector<NodalForce>>(forces, "set_forces", "forces");
    const auto rows = readRows<Vec3, double, 3>(forces, "set_forces: forces");
    std::vector<int> at(rows.size());
    std::iota(at.begin(), at.end(), 0);
    if (!nodes.is_none()) at = readNodes(nodes, physics, id);
    if (at.size() != rows.size())
        fail("set_forces: nodes must be as many as the rows of forces, ", rows.size(), ", got ", at.size());
    std::vector<NodalForce> out(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) out[i] = {at[i], rows[i]};
    return out;
}

PhysicsServer& server(HeldSimulation& held, const char* what) { return usable(held, what).physics(); }

void addRigid(nb::class_<HeldSimulation>& sim)
{
    sim.def(
        "set_pose",
        [](HeldSimulation& self, nb::handle id, nb::handle pose, nb::handle at) {
            server(self, "set_pose")
                .setPose(body(id, "set_pose"), readArgument<Pose>(pose, "set_pose", "pose"), element(at, "set_pose"));
        },
        nb::arg("body").none(), nb::arg("pose").none(), nb::arg("element").none() = 0,
        nb::sig("def set_pose(self, body: filasofia.BodyId, pose: filasofia.Pose | collections.abc.Sequence[float], "
                "element: int = 0) -> None"),
        "The pose of a kinematic element at the end of the next step; of a dynamic one from now on, at rest.");
    sim.def(
        "set_wrench",
        [](HeldSimulation& self, nb::handle id, nb::handle force, nb::handle torque, nb::handle at) {
            server(self, "set_wrench")
                .setWrench(body(id, "set_wrench"), readArgument<Vec3>(force, "set_wrench", "force"),
                           readArgument<Vec3>(torque, "set_wrench", "torque"), element(at, "set_wrench"));
        },
        nb::arg("body").none(), nb::arg("force").none(), nb::arg("torque").none() = nb::make_tuple(0.0, 0.0, 0.0),
        nb::arg("element").none() = 0,
        nb::sig("def set_wrench(self, body: filasofia.BodyId, force: collections.abc.Sequence[float], torque: "
                "collections.abc.Sequence[float] = (0, 0, 0), element: int = 0) -> None"),
        "Force [N] and torque [N m] on a dynamic element, in world axes, until changed.");
}

void addHandsAndJoints(nb::class_<HeldSimulation>& sim)
{
    sim.def(
        "set_joint",
        [](HeldSimulation& self, nb::handle id, nb::handle joint, nb::handle command) {
            server(self, "set_joint")
                .setJoint(body(id, "set_joint"), readArgument<int>(joint, "set_joint", "joint", nonNegative()),
                          readArgument<JointCommand>(command, "set_joint", "command"));
        },
        nb::arg("body").none(), nb::arg("joint").none(), nb::arg("command").none(),
        nb::sig("def set_joint(self, body: filasofia.BodyId, joint: int, command: filasofia.JointPosition | "
                "filasofia.JointForce | filasofia.JointSpring) -> None"),
        "The target position of a joint, its force, or a spring that draws it, until changed.");
    sim.def(
        "set_haptic",
        [](HeldSimulation& self, nb::handle id, nb::handle target, nb::handle at) {
            server(self, "set_haptic")
                .setHaptic(body(id, "set_haptic"), readArgument<HapticTarget>(target, "set_haptic", "target"),
                           element(at, "set_haptic"));
        },
        nb::arg("body").none(), nb::arg("target").none(), nb::arg("element").none() = 0,
        nb::sig(
            "def set_haptic(self, body: filasofia.BodyId, target: filasofia.HapticTarget, element: int = 0) -> None"),
        "Couples an element to a hand.");
}

void addBlades(nb::class_<HeldSimulation>& sim)
{
    sim.def(
        "set_cutting",
        [](HeldSimulation& self, nb::handle id, nb::handle cutting) {
            server(self, "set_cutting")
                .setCutting(body(id, "set_cutting"), readArgument<bool>(cutting, "set_cutting", "cutting"));
        },
        nb::arg("body").none(), nb::arg("cutting").none(),
        nb::sig("def set_cutting(self, body: filasofia.BodyId, cutting: bool) -> None"),
        "Whether the blades of a rigid body cut. Otherwise they touch what they would cut.");
}

void addSoft(nb::class_<HeldSimulation>& sim)
{
    sim.def(
        "set_material",
        [](HeldSimulation& self, nb::handle id, nb::handle material) {
            PhysicsServer& physics = server(self, "set_material");
            const BodyId soft = body(id, "set_material");
            const auto read = readArgument<SoftMaterial>(material, "set_material", "material");
            const nb::gil_scoped_release free; // it builds a solver
            physics.setMaterial(soft, read);
        },
        nb::arg("body").none(), nb::arg("material").none(),
        nb::sig("def set_material(self, body: filasofia.BodyId, material: filasofia.FemMaterial | "
                "filasofia.MassSpringMaterial | filasofia.ShellMaterial) -> None"),
        "A material of the kind that the body was made with.");
    sim.def(
        "set_tissue",
        [](HeldSimulation& self, nb::handle id, nb::handle region, nb::handle factors) {
            std::optional<TissueFactors> times;
            if (!factors.is_none()) times = readArgument<TissueFactors>(factors, "set_tissue", "factors");
            server(self, "set_tissue")
                .setTissue(body(id, "set_tissue"), readArgument<TissueRegion>(region, "set_tissue", "region"), times);
        },
        nb::arg("body").none(), nb::arg("region").none(), nb::arg("factors").none() = nb::none(),
        nb::sig("def set_tissue(self, body: filasofia.BodyId, region: filasofia.TissueRegion, "
                "factors: filasofia.TissueFactors | None = None) -> None"),
        "Changes the tissue of a part of a FEM body: coagulation stiffens and shrinks it.");
    sim.def(
        "set_fibre_stress",
        [](HeldSimulation& self, nb::handle id, nb::handle family, nb::handle stress) {
            server(self, "set_fibre_stress")
                .setFibreStress(body(id, "set_fibre_stress"),
                                readArgument<int>(family, "set_fibre_stress", "family", nonNegative()),
                                readArgument<double>(stress, "set_fibre_stress", "stress", closed(0, 1e9)));
        },
        nb::arg("body").none(), nb::arg("family").none(), nb::arg("stress").none(),
        nb::sig("def set_fibre_stress(self, body: filasofia.BodyId, family: int, stress: float) -> None"),
        "The stress [Pa] by which a family of fibres contracts.");
    sim.def(
        "set_curvature",
        [](HeldSimulation& self, nb::handle id, nb::handle sections, nb::handle rate) {
            server(self, "set_curvature")
                .setCurvature(body(id, "set_curvature"),
                              readArgument<std::vector<RodSection>>(sections, "set_curvature", "sections"),
                              readArgument<double>(rate, "set_curvature", "rate", positiveOrInfinite()));
        },
        nb::arg("body").none(), nb::arg("sections").none(),
        nb::arg("rate").none() = std::numeric_limits<double>::infinity(),
        nb::sig("def set_curvature(self, body: filasofia.BodyId, sections: "
                "collections.abc.Sequence[filasofia.RodSection], rate: float = float('inf')) -> None"),
        "The curvature that parts of a rod take by themselves, in place of all that was commanded before. rate "
        "[1/(m s)]: how fast they go there.");
}

void addLoads(nb::class_<HeldSimulation>& sim)
{
    sim.def(
        "set_forces",
        [](HeldSimulation& self, nb::handle id, nb::handle forces, nb::handle nodes) {
            PhysicsServer& physics = server(self, "set_forces");
            const BodyId soft = body(id, "set_forces");
            physics.setForces(soft, readForces(forces, nodes, physics, soft));
        },
        nb::arg("body").none(), nb::arg("forces").none(), nb::arg("nodes") = nb::none(),
        nb::sig("def set_forces(self, body: filasofia.BodyId, forces: collections.abc.Sequence[filasofia.NodalForce] | "
                "numpy.typing.NDArray[typing.Any], nodes: collections.abc.Sequence[int] | "
                "numpy.typing.NDArray[typing.Any] | None = None) -> None"),
        "Replaces all nodal forces of a soft body: a list of NodalForce, or an array (n, 3) [N] of the forces on "
        "`nodes`, n indices or a mask with n of all nodes; without them on the first n nodes.");
    sim.def(
        "set_pressure",
        [](HeldSimulation& self, nb::handle id, nb::handle pressure) {
            server(self, "set_pressure")
                .setPressure(body(id, "set_pressure"), readArgument<double>(pressure, "set_pressure", "pressure"));
        },
        nb::arg("body").none(), nb::arg("pressure").none(),
        nb::sig("def set_pressure(self, body: filasofia.BodyId, pressure: float) -> None"),
        "[Pa] on the whole surface, positive inwards.");
    sim.def(
        "set_cavity",
        [](HeldSimulation& self, nb::handle id, nb::handle cavity, nb::handle pressure, nb::handle inflow) {
            server(self, "set_cavity")
                .setCavity({.id = body(id, "set_cavity"),
                            .cavity = readArgument<int>(cavity, "set_cavity", "cavity"),
                            .pressure = readArgument<std::optional<double>>(pressure, "set_cavity", "pressure"),
                            .inflow = readArgument<std::optional<double>>(inflow, "set_cavity", "inflow")});
        },
        nb::arg("body").none(), nb::arg("cavity") = 0, nb::arg("pressure") = nb::none(), nb::arg("inflow") = nb::none(),
        nb::sig("def set_cavity(self, body: filasofia.BodyId, cavity: int = 0, pressure: float | None = None, "
                "inflow: float | None = None) -> None"),
        "What a cavity of a soft body holds: filled to a `pressure` [Pa] at once; `inflow` [m^3/s] from now on.");
    sim.def(
        "remove_piece",
        [](HeldSimulation& self, nb::handle id, nb::handle piece) {
            server(self, "remove_piece")
                .removePiece(body(id, "remove_piece"),
                             readArgument<int>(piece, "remove_piece", "piece", nonNegative()));
        },
        nb::arg("body").none(), nb::arg("piece").none(),
        nb::sig("def remove_piece(self, body: filasofia.BodyId, piece: int) -> None"),
        "Removes a piece that cuts or tears have detached.");
}

void addAttachments(nb::class_<HeldSimulation>& sim)
{
    sim.def(
        "attach",
        [](HeldSimulation& self, nb::handle id, nb::handle def) {
            PhysicsServer& physics = server(self, "attach");
            using Either = std::variant<AttachmentDef, RigidAttachmentDef>;
            const auto read = readArgument<Either>(def, "attach", "definition");
            const BodyId which = body(id, "attach");
            return std::visit(
                [&](const auto& each) { return Convert<AttachmentId>::make(physics.attach(which, each)); }, read);
        },
        nb::arg("body").none(), nb::arg("definition").none(),
        nb::sig("def attach(self, body: filasofia.BodyId, definition: filasofia.AttachmentDef | "
                "filasofia.RigidAttachmentDef) -> filasofia.AttachmentId"),
        "Attaches nodes of a soft body, or an element of a rigid one, where they are when it takes effect.");
    sim.def(
        "grasp",
        [](HeldSimulation& self, nb::handle rigid, nb::handle target, nb::handle def) {
            PhysicsServer& physics = server(self, "grasp");
            const auto how = def.is_none() ? GraspDef{} : readArgument<GraspDef>(def, "grasp", "definition");
            return Convert<AttachmentId>::make(physics.grasp(readArgument<BodyId>(rigid, "grasp", "rigid"),
                                                             readArgument<BodyId>(target, "grasp", "target"), how));
        },
        nb::arg("rigid").none(), nb::arg("target").none(), nb::arg("definition") = nb::none(),
        nb::sig("def grasp(self, rigid: filasofia.BodyId, target: filasofia.BodyId, definition: filasofia.GraspDef | "
                "None = None) -> filasofia.AttachmentId"),
        "Attaches to a rigid body what it touches of the target.");
    sim.def(
        "clip",
        [](HeldSimulation& self, nb::handle rigid, nb::handle soft, nb::handle def) {
            PhysicsServer& physics = server(self, "clip");
            const auto how = def.is_none() ? ClipDef{} : readArgument<ClipDef>(def, "clip", "definition");
            return Convert<AttachmentId>::make(physics.clip(readArgument<BodyId>(rigid, "clip", "rigid"),
                                                            readArgument<BodyId>(soft, "clip", "soft"), how));
        },
        nb::arg("rigid").none(), nb::arg("soft").none(), nb::arg("definition") = nb::none(),
        nb::sig("def clip(self, rigid: filasofia.BodyId, soft: filasofia.BodyId, definition: filasofia.ClipDef | "
                "None = None) -> filasofia.AttachmentId"),
        "Closes a clip, a dynamic rigid body, on the tissue between its legs.");
}

void addReleases(nb::class_<HeldSimulation>& sim)
{
    sim.def(
        "release",
        [](HeldSimulation& self, nb::handle id) {
            server(self, "release").release(readArgument<AttachmentId>(id, "release", "attachment"));
        },
        nb::arg("attachment").none(), nb::sig("def release(self, attachment: filasofia.AttachmentId) -> None"));
    sim.def(
        "attachments",
        [](HeldSimulation& self, nb::handle id) {
            return Convert<std::vector<AttachmentId>>::make(
                server(self, "attachments").attachments(body(id, "attachments")));
        },
        nb::arg("body").none(),
        nb::sig("def attachments(self, body: filasofia.BodyId) -> list[filasofia.AttachmentId]"),
        "The attachments of a body's Def, in its order.");
}

} // namespace

void addCommands(nb::class_<HeldSimulation>& sim)
{
    sim.def(
        "apply",
        [](HeldSimulation& self, nb::handle command) {
            return applyAs(self, command, static_cast<const Applied*>(nullptr));
        },
        nb::arg("command").none(), nb::sig("def apply(self, command: typing.Any) -> filasofia.AttachmentId | None"),
        "Applies a command (SetPose, Grasp, Reset, ...). Returns the id of an attachment that it makes; its own is not "
        "read.");
    sim.def(
        "set_gravity",
        [](HeldSimulation& self, nb::handle gravity) {
            server(self, "set_gravity").setGravity(readArgument<Vec3>(gravity, "set_gravity", "gravity"));
        },
        nb::arg("gravity").none(), nb::sig("def set_gravity(self, gravity: collections.abc.Sequence[float]) -> None"),
        "[m/s^2]");
    sim.def(
        "pause", [](HeldSimulation& self, bool paused) { usable(self, "pause").simulation().pause(paused); },
        nb::arg("paused") = true, "While paused, steps apply commands and nothing moves.");
    sim.def(
        "reset",
        [](HeldSimulation& self) {
            usable(self, "reset").simulation().reset();
            self.owed = 0.0;
        },
        "Puts the bodies back to their start at the next step, and removes all paint.");
    addRigid(sim);
    addHandsAndJoints(sim);
    addBlades(sim);
    addSoft(sim);
    addLoads(sim);
    addAttachments(sim);
    addReleases(sim);
}

} // namespace filasofia::python
