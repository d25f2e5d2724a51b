#include "filasofia/engine/step/apply_commands.h"

#include "filasofia/core/assert.h"
#include "filasofia/core/log.h"
#include "filasofia/engine/body/tissue.h"
#include "filasofia/engine/build/build_body.h"
#include "filasofia/engine/contact/attachments.h"
#include "filasofia/engine/contact/sheathed_blades.h"
#include "filasofia/engine/rigid/articulation_step.h"
#include "filasofia/engine/rigid/virtual_coupling.h"
#include "filasofia/engine/scene/find_body.h"
#include "filasofia/engine/step/add_body.h"
#include "filasofia/engine/step/close_clips.h"
#include "filasofia/engine/step/reset_scene.h"
#include "filasofia/engine/step/tune_scene.h"
#include "filasofia/engine/topology/loose_pieces.h"
#include "filasofia/engine/topology/remove_piece.h"

#include <algorithm>
#include <utility>

namespace filasofia::engine {
namespace {

/// Applies one command, with one overload per kind. The server has checked that the bodies it names exist.
struct ApplyCommand {
    physics::PhysicsEngine& self;
    Scene& scene;
    physics::StepReport& report;

    void operator()(physics::AddBody& add) const { addBody(add, scene, report); }
    void operator()(const physics::RemoveBody& remove) const { removeBody(remove.id, scene); }
    void operator()(const physics::SetPose& set) const
    {
        const std::size_t index = rigidIndex(set.id);
        RigidState& state = scene.rigid[index].state;
        const Pose pose = physics::unitPose(set.pose, "pose");
        if (!scene.rigid[index].model.dynamic) { // moveRigid() or moveArticulations() moves it there
            state.targets[set.element] = pose;
            return;
        }
        state.poses[set.element] = pose;
        state.velocities[set.element] = state.angularVelocities[set.element] = {};
        for (JointState& joint : state.joints) joint.now.velocity = 0.0;
        placeLinks(index, scene);
    }
    void operator()(const physics::SetWrench& set) const
    {
        rigid(set.id).state.wrenches[set.element] = {set.force, set.torque};
    }
    void operator()(const physics::SetJoint& set) const
    {
        rigid(set.id).state.joints[static_cast<std::size_t>(set.joint)].command = set.command;
    }
    void operator()(const physics::SetHaptic& set) const
    {
        RigidBody& body = rigid(set.id);
        physics::HapticTarget target = set.target;
        target.pose = physics::unitPose(target.pose, "target.pose");
        if (body.model.dynamic)
            setCoupling({set.element, target}, body.state);
        else
            body.state.targets[set.element] = target.pose;
    }
    void operator()(const physics::SetGravity& set) const { scene.gravity = set.gravity; }
    void operator()(physics::SetMaterial& set) const
    {
        SoftBody& body = soft(set.id);
        // The server looked the new material up in the mesh and built a system for it in advance. Both depend on Def
        // and material alone, so the order of commands does not matter. The old ones are returned with the command, as
        // freeing them would take too long in a step.
        auto* built = dynamic_cast<BuiltSoftBody*>(set.body.get());
        std::shared_ptr<const TissueMap> map = built ? built->body.model.tissue : mapTissue(set.material, body.model);
        const auto* fem = std::get_if<physics::FemMaterial>(&set.material);
        const bool relaxes = fem && fem->relaxation != body.model.material.relaxation;
        if (built) built->body.model.tissue = body.model.tissue;
        setMaterial(set.material, map, body.model);
        if (relaxes) restartRelaxation(body.model, body.state);
        if (SoftModel* start = body.topology.start.get()) setMaterial(set.material, map, *start);
        if (built && !body.system.tuned)
            std::swap(body.system, built->body.system);
        else
            body.system.outdated = true;
    }
    void operator()(const physics::SetTissue& set) const
    {
        SoftBody& body = soft(set.id);
        const std::vector<int> elements = changeTissue(set, body.state, body.model);
        if (elements.empty()) {
            report.set(physics::StepFlag::NothingChanged);
            logWarning("soft body '", body.model.name, "': a change of tissue reached no element");
            return;
        }
        followTissue(body.model, elements, body.system);
    }
    void operator()(const physics::SetFibreStress& set) const
    {
        SoftBody& body = soft(set.id);
        const auto family = static_cast<std::size_t>(set.family);
        for (SoftModel* model : {&body.model, body.topology.start.get()})
            if (model) model->material.fibres[family].activeStress = set.stress;
    }
    void operator()(const physics::SetCurvature& set) const
    {
        SoftBody& body = soft(set.id);
        setCurvature(set, body.model.rod, body.state.rod);
    }
    void operator()(const physics::SetCutting& set) const
    {
        RigidBody& body = rigid(set.id);
        if (set.cutting != body.state.cutting)
            body.state.sheath = set.cutting ? 0 : sheathOf(elementsAtBlades(scene, body));
        body.state.cutting = set.cutting;
    }
    void operator()(const physics::SetCavity& set) const
    {
        SoftBody& body = soft(set.id);
        const auto c = static_cast<std::size_t>(set.cavity);
        const Cavity& cavity = body.model.cavities[c];
        CavityState& state = body.state.cavities[c];
        if (set.inflow) state.inflow = *set.inflow;
        if (!set.pressure) return;
        state.pressure = *set.pressure;
        state.content = contentAt(cavity, *set.pressure, volumeOf(cavity, body.state.x));
    }
    void operator()(const physics::SetForces& set) const { setForces(set.forces, soft(set.id).state); }
    void operator()(const physics::SetPressure& set) const { soft(set.id).state.pressure = set.pressure; }
    void operator()(const physics::Attach& command) const
    {
        attach({command.id, command.body}, command.def, scene, report);
    }
    void operator()(const physics::AttachRigid& command) const
    {
        attach({command.id, command.body}, command.def, scene, report);
    }
    void operator()(const physics::Grasp& grasp) const
    {
        // Ids may arrive slightly out of order: threads take them before their commands are queued.
        const auto place = std::ranges::upper_bound(scene.grasps, grasp.id, {}, &PendingGrasp::id);
        scene.grasps.insert(
            place, {grasp.id, grasp.rigid, grasp.target, grasp.def.stiffness, grasp.def.breakForce, grasp.def.mouth});
    }
    void operator()(const physics::ApplyClip& clip) const { applyClip(clip, scene, report); }
    void operator()(const physics::RemovePiece& remove) const
    {
        SoftBody& body = soft(remove.id);
        if (removePiece(remove.piece, body, scene, report))
            outdate(true, body.system);
        else {
            ++report.topology.noPiece;
            logWarning(describe(body.model), ": RemovePiece: piece ", remove.piece,
                       " does not exist, or is all that is left of it; nothing is removed");
        }
    }
    void operator()(const physics::Release& command) const
    {
        release(command.id, scene);
        for (SoftBody& body : scene.soft) {
            Pins& pins = body.model.pins;
            const auto group = std::ranges::find(pins.groups, command.id, &PinGroup::id);
            if (group == pins.groups.end()) continue;
            const auto place = group - pins.groups.begin();
            releaseGroup(static_cast<std::size_t>(place), pins);
            findHeld(pins, body.model.pieces);
            if (SoftModel* start = body.topology.start.get())
                releaseGroup(static_cast<std::size_t>(place), start->pins);
            outdate(true, body.system); // the model differs from its Def now
        }
    }
    void operator()(const physics::Reset&) const { resetScene(scene); }
    void operator()(const physics::Pause&) const {} // handled by the server, which steps with dt = 0
    void operator()(const physics::Tune& tune) const { tuneScene(tune, self, scene, report); }

private:
    [[nodiscard]] std::size_t rigidIndex(BodyId id) const
    {
        const auto index = findIn(scene.rigid, id);
        FILASOFIA_ASSERT(index.has_value());
        return *index;
    }
    [[nodiscard]] RigidBody& rigid(BodyId id) const { return scene.rigid[rigidIndex(id)]; }
    [[nodiscard]] SoftBody& soft(BodyId id) const
    {
        const auto index = findIn(scene.soft, id);
        FILASOFIA_ASSERT(index.has_value());
        return scene.soft[*index];
    }
};

} // namespace

void applyCommands(const StepContext& context, std::span<physics::Command> commands, physics::PhysicsEngine& self,
                   Scene& scene)
{
    const ApplyCommand apply{self, scene, context.report};
    for (physics::Command& command : commands) std::visit(apply, command);
}

void rebuildSystems(double period, Scene& scene)
{
    findHeldEdges(scene);
    for (SoftBody& body : scene.soft) {
        if (!body.system.outdated) continue;
        const bool tuned = body.system.tuned;
        body.system = makeSystem(body.model, period);
        body.system.tuned = tuned;
    }
}

} // namespace filasofia::engine
