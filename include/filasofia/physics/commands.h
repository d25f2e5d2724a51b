#pragma once

#include "filasofia/physics/clip_def.h"
#include "filasofia/physics/defs.h"
#include "filasofia/physics/haptic_target.h"

#include "filasofia/core/attachment_id.h"
#include "filasofia/core/body_id.h"

#include <array>
#include <functional>
#include <limits>

/// Commands are the only way into a running simulation: they are applied at the start of the next step, in the order of
/// posting.
namespace filasofia::physics {

class PhysicsEngine;

/// A finished body in the engine's own form: built and checked on the caller's thread, moved into the engine at the
/// start of a step.
class BuiltBody {
public:
    virtual ~BuiltBody() = default;
    [[nodiscard]] virtual int nodeCount() const = 0; ///< nodes of a soft body, elements of a rigid one
};

struct AddBody {
    BodyId id = {};
    std::shared_ptr<const BodyDef> def = {};
    std::unique_ptr<BuiltBody> body = {};
    AttachmentId attachments =
        {}; ///< id of the first of its Def's attachments, the others follow; none if its Def has none
};
/// Removes a body and every attachment to it.
struct RemoveBody {
    BodyId id = {};
};
/// Sets the pose of a rigid element: its target at the end of the step for a kinematic body, or, if the body is
/// dynamic, its pose at once and at rest.
struct SetPose {
    BodyId id = {};
    int element = 0;
    Pose pose = {}; ///< the orientation may have any length > 1e-6: the engine normalises it
};
/// Sets the wrench on an element of a dynamic body at its centre of mass; replaces the former one.
struct SetWrench {
    BodyId id = {};
    int element = 0;
    Vec3 force = {};  ///< [N], in world axes
    Vec3 torque = {}; ///< [N m], in world axes
};
/// Sets the command of a joint of an articulated body: a position, or a force.
struct SetJoint {
    BodyId id = {};
    int joint = 0; ///< [-], index in its Def
    JointCommand command = {};
};
/// Sets the motion of the hand that holds an element. A dynamic body is pulled towards it by the virtual coupling until
/// the next such command; if stiffness and damping are all zero, it is released. A dynamic body with joints cannot be
/// held. A kinematic body moves there in the step and stays, as with SetPose, whatever the coupling.
struct SetHaptic {
    BodyId id = {};
    int element = 0;
    HapticTarget target = {};
};
struct SetGravity {
    Vec3 gravity = {}; ///< [m/s^2]
};
struct SetMaterial {
    BodyId id = {};
    SoftMaterial material = {};
    /// The body built with the new material. The engine takes from it what depends on the material, and leaves the
    /// former data in it. If it is missing (in a replay), the step builds it.
    std::unique_ptr<BuiltBody> body = {};
};
/// Changes the tissue of a part of a soft FEM body: coagulation stiffens and shrinks it. A box or a ball has the
/// elements whose centre is there now, in the world; all other shapes are those of the body's mesh at rest. Lasts until
/// the next SetMaterial or Reset. The density stays.
struct SetTissue {
    BodyId id = {};
    TissueRegion region = {};
    /// If given, modulus, threshold and scale of the region are first set to those of the material times these.
    std::optional<TissueFactors> factors = {};
};
/// Sets the stress by which a family of fibres contracts (FibreFamily::activeStress). Lasts until the next SetMaterial;
/// a Reset keeps it.
struct SetFibreStress {
    BodyId id = {};
    int family = 0;      ///< [-], index in FemMaterial::fibres
    double stress = 0.0; ///< [Pa], in [0, 1e9]
};
/// Switches the blades of a rigid body, its collision models with `cutting`: a pedal of a hook, or a shaver that is
/// started. Blades that do not cut touch what they would cut, as any surface does, and open no surface. Lasts until the
/// next such command; a Reset keeps it.
struct SetCutting {
    BodyId id = {};
    bool cutting = true;
};
inline constexpr double kMostTurnPerNode = 2.0; ///< [rad] by which a RodSection bends a rod at a node, at most
/// A part of a rod that bends by itself, as the tip of a steerable catheter or of a flexible endoscope does.
struct RodSection {
    double begin = 0.0; ///< [m], >= 0, along the rod at rest, from its first node on
    /// [m], > begin and at most the rod's length; infinite: to its end
    double end = std::numeric_limits<double>::infinity();
    /// [1/m] where it bends to: the part towards its directors, and that towards direction x director. A node turns the
    /// rod by at most kMostTurnPerNode
    std::array<double, 2> curvature = {};
};
/// Commands the curvature that parts of a rod have at rest, beside that which it was made with, and replaces all that
/// was commanded before. Lasts until the next such command; a Reset keeps it.
struct SetCurvature {
    BodyId id = {};
    std::vector<RodSection> sections = {}; ///< from the first node on, without overlaps; none: nothing is commanded
    /// [1/(m s)], > 0, by which the curvature goes there; infinite: at once
    double rate = std::numeric_limits<double>::infinity();
};
/// Replaces all nodal forces of a soft body.
struct SetForces {
    BodyId id = {};
    std::vector<NodalForce> forces = {};
};
struct SetPressure {
    BodyId id = {};
    double pressure = 0.0; ///< [Pa]
};
/// Attaches nodes of a soft body at their positions at the start of the step.
struct Attach {
    AttachmentId id = {};
    BodyId body = {};
    AttachmentDef def = {};
};
/// The same for a rigid body.
struct AttachRigid {
    AttachmentId id = {};
    BodyId body = {};
    RigidAttachmentDef def = {};
};
/// Releases an attachment. Does nothing if it has broken, or its body is gone.
struct Release {
    AttachmentId id = {};
};
/// Removes a piece that cuts or tears have detached. Does nothing if there is no piece of this number, or if it is all
/// that is left of the body; the step then counts it in TopologyReport::noPiece.
struct RemovePiece {
    BodyId id = {};
    int piece = 0; ///< number as in LoosePiece; 0: the part that kept the body's number
};
/// Attaches to a rigid body what it touches of the target in the step; while paused, in the first step after the pause.
struct Grasp {
    AttachmentId id = {};
    BodyId rigid = {};
    BodyId target = {};
    GraspDef def = {};
};
/// Returns every body to the pose and the velocities with which it was added; time and step count continue. The current
/// attachments stay.
struct Reset {};
/// While paused, steps apply commands and nothing moves.
struct Pause {
    bool paused = true;
};
/// Runs once between two steps with access to the engine itself; see filasofia/engine/native/native.h.
struct Tune {
    std::function<void(PhysicsEngine&)> change;
};

// For recordings: the content of each command. A built body is not part of it: it is built again from the Def.
constexpr auto fields(const AddBody*)
{
    return describe("AddBody", field("id", &AddBody::id, "id of the new body"),
                    field("def", &AddBody::def, "Def of the new body"),
                    field("attachments", &AddBody::attachments, "id of the first of its Def's attachments"));
}
constexpr auto fields(const RemoveBody*)
{
    return describe("RemoveBody", field("id", &RemoveBody::id, "the body to remove"));
}
constexpr auto fields(const SetPose*)
{
    return describe("SetPose", field("id", &SetPose::id, "the rigid body"),
                    field("element", &SetPose::element, "-", nonNegative(), "index of the element"),
                    field("pose", &SetPose::pose, "pose from now on"));
}
constexpr auto fields(const SetWrench*)
{
    return describe("SetWrench", field("id", &SetWrench::id, "the dynamic body"),
                    field("element", &SetWrench::element, "-", nonNegative(), "index of the element"),
                    field("force", &SetWrench::force, "N", finite(), "force at its centre of mass"),
                    field("torque", &SetWrench::torque, "N m", finite(), "torque in world axes"));
}
constexpr auto fields(const SetJoint*)
{
    return describe("SetJoint", field("id", &SetJoint::id, "the articulated body"),
                    field("joint", &SetJoint::joint, "-", nonNegative(), "index of the joint"),
                    field("command", &SetJoint::command, "position or force of the joint"));
}
constexpr auto fields(const SetHaptic*)
{
    return describe("SetHaptic", field("id", &SetHaptic::id, "the rigid body"),
                    field("element", &SetHaptic::element, "-", nonNegative(), "index of the element"),
                    field("target", &SetHaptic::target, "motion of the hand that holds it"));
}
constexpr auto fields(const SetGravity*)
{
    return describe("SetGravity", field("gravity", &SetGravity::gravity, "m/s^2", finite(), "gravity on every body"));
}
constexpr auto fields(const SetMaterial*)
{
    return describe("SetMaterial", field("id", &SetMaterial::id, "the soft body"),
                    field("material", &SetMaterial::material, "new material, of the kind it was made with"));
}
constexpr auto fields(const SetTissue*)
{
    return describe("SetTissue", field("id", &SetTissue::id, "the soft body"),
                    field("region", &SetTissue::region, "what differs, and where"),
                    field("factors", &SetTissue::factors, "of what the material says there"));
}
/// The last field is younger than the first recordings of this command.
constexpr std::size_t addedFields(const SetTissue*) { return 1; }
constexpr auto fields(const SetFibreStress*)
{
    using T = SetFibreStress;
    return describe("SetFibreStress", field("id", &T::id, "the soft body"),
                    field("family", &T::family, "-", nonNegative(), "index of the family of fibres"),
                    field("stress", &T::stress, "Pa", closed(0, 1e9), "stress by which they contract"));
}
constexpr auto fields(const SetCutting*)
{
    return describe("SetCutting", field("id", &SetCutting::id, "the rigid body"),
                    field("cutting", &SetCutting::cutting, "whether its blades cut"));
}
constexpr auto fields(const RodSection*)
{
    using T = RodSection;
    return describe(
        "RodSection", field("begin", &T::begin, "m", nonNegative(), "where it begins, along the rod"),
        field("end", &T::end, "m", positiveOrInfinite(), "where it ends; infinite: at the rod's end"),
        field("curvature", &T::curvature, "1/m", finite(), "towards the directors, and towards direction x director"));
}
constexpr auto fields(const SetCurvature*)
{
    using T = SetCurvature;
    return describe("SetCurvature", field("id", &T::id, "the rod"),
                    field("sections", &T::sections, "parts that bend by themselves; none: nothing is commanded"),
                    field("rate", &T::rate, "1/(m s)", positiveOrInfinite(), "by which the curvature changes"));
}
constexpr auto fields(const SetForces*)
{
    return describe("SetForces", field("id", &SetForces::id, "the soft body"),
                    field("forces", &SetForces::forces, "nodal forces that replace the former ones"));
}
constexpr auto fields(const SetPressure*)
{
    return describe(
        "SetPressure", field("id", &SetPressure::id, "the soft body"),
        field("pressure", &SetPressure::pressure, "Pa", finite(), "pressure on the whole surface, positive inwards"));
}
constexpr auto fields(const Attach*)
{
    return describe("Attach", field("id", &Attach::id, "id of the new attachment"),
                    field("body", &Attach::body, "the soft body"), field("def", &Attach::def, "Def of the attachment"));
}
constexpr auto fields(const AttachRigid*)
{
    using T = AttachRigid;
    return describe("AttachRigid", field("id", &T::id, "id of the new attachment"),
                    field("body", &T::body, "the rigid body"), field("def", &T::def, "Def of the attachment"));
}
constexpr auto fields(const Release*)
{
    return describe("Release", field("id", &Release::id, "the attachment to release"));
}
constexpr auto fields(const RemovePiece*)
{
    return describe("RemovePiece", field("id", &RemovePiece::id, "the soft body"),
                    field("piece", &RemovePiece::piece, "-", nonNegative(), "number of the piece"));
}
constexpr auto fields(const Grasp*)
{
    return describe("Grasp", field("id", &Grasp::id, "id of the new attachment"),
                    field("rigid", &Grasp::rigid, "the body that grasps"),
                    field("target", &Grasp::target, "the body that is grasped"),
                    field("def", &Grasp::def, "Def of the grasp"));
}
constexpr auto fields(const Reset*) { return describe("Reset"); }
constexpr auto fields(const Pause*)
{
    return describe("Pause", field("paused", &Pause::paused, "true to pause, false to continue"));
}
constexpr auto fields(const Tune*) { return describe("Tune"); } // a function cannot be stored

using Command = std::variant<AddBody, RemoveBody, SetPose, SetGravity, SetMaterial, SetForces, SetPressure, SetWrench,
                             Attach, AttachRigid, Release, Grasp, RemovePiece, Reset, Pause, Tune, SetJoint, SetHaptic,
                             SetTissue, SetFibreStress, SetCurvature, SetCutting, SetCavity, ApplyClip>;

} // namespace filasofia::physics
