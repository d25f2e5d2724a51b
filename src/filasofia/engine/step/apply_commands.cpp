#include "filasofia/core/assert.h"
#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/engine/rigid/articulation_step.h"
#include "filasofia/engine/contact/attachments.h"
#include "filasofia/engine/contact/attachment_points.h"
#include "filasofia/engine/build/build_body.h"
#include "filasofia/engine/contact/warm_start.h"
#include "filasofia/engine/body/find_body.h"
#include "filasofia/engine/rigid/virtual_coupling.h"
#include "filasofia/engine/topology/loose_pieces.h"
#include "filasofia/engine/native/native.h"
#include "filasofia/engine/topology/remove_piece.h"
#include "filasofia/engine/step/stages.h"

#include <algorithm>
#include <utility>

namespace filasofia::engine {
namespace {

/// The index of a body by its id. The server has checked that it is there.
template <class Bodies> std::size_t indexOf(const Bodies& bodies, BodyId id)
{
    const auto index = findIn(bodies, id);
    FILASOFIA_ASSERT(index.has_value());
    return *index;
}

template <class List> bool eraseAt(List& list, std::size_t index)
{
    list.erase(list.begin() + static_cast<std::ptrdiff_t>(index));
    return true;
}

/// Carries out one command; one function per kind.
struct Apply {
    physics::PhysicsEngine& self;
    Model& model;
    State& state;
    Systems& systems;
    Topologies& topologies;
    physics::StepReport& report;

    void operator()(physics::AddBody& add) const
    {
        if (auto* soft = dynamic_cast<BuiltSoftBody*>(add.body.get())) { // ids rise: the lists stay in order
            soft->model.id = add.id;
            model.softBodies.push_back(std::move(soft->model));
            state.softBodies.push_back(std::move(soft->state));
            systems.push_back(std::move(soft->system));
            topologies.push_back(std::move(soft->topology));
        } else {
            auto& rigid = dynamic_cast<BuiltRigidBody&>(*add.body);
            rigid.model.id = add.id;
            model.rigidBodies.push_back(std::move(rigid.model));
            state.rigidBodies.push_back(std::move(rigid.state));
            placeLinks(model, model.rigidBodies.size() - 1, state);
        }
        addAttachments(add);
        add.body.reset(); // the command goes on into the log: its empty shell need not
    }
    void operator()(const physics::RemoveBody& remove) const
    {
        removeAttachmentsOf(remove.id, state);
        const auto touches = [&](const auto& contact) {
            return contact.first == remove.id || contact.second == remove.id;
        };
        std::erase_if(state.touching, touches);
        std::erase_if(state.contacts, touches);
        std::erase_if(state.sides, [&](const SideKept& kept) {
            return kept.source.body == remove.id || kept.target.body == remove.id;
        });
        const auto is = [&](const auto& body) { return body.id == remove.id; };
        if (std::any_of(model.softBodies.begin(), model.softBodies.end(), is)) {
            const std::size_t index = indexOf(model.softBodies, remove.id);
            eraseAt(model.softBodies, index);
            eraseAt(state.softBodies, index);
            eraseAt(systems, index);
            eraseAt(topologies, index);
        } else {
            const std::size_t index = indexOf(model.rigidBodies, remove.id);
            eraseAt(model.rigidBodies, index);
            eraseAt(state.rigidBodies, index);
        }
        for (RigidModel& body : model.rigidBodies) // a base that it took along stays where it is
            if (body.articulation.to == remove.id) body.articulation.to = {};
    }
    void operator()(const physics::SetPose& set) const
    {
        const std::size_t index = indexOf(model.rigidBodies, set.id);
        RigidState& body = state.rigidBodies[index];
        const Pose pose = physics::unitPose(set.pose, "pose");
        if (!model.rigidBodies[index].dynamic) { // moveRigid takes it there
            body.targets[set.element] = pose;
            return;
        }
        body.poses[set.element] = pose;
        body.velocities[set.element] = body.angularVelocities[set.element] = {};
        for (JointState& joint : body.joints) joint.now.velocity = 0.0;
        placeLinks(model, index, state);
    }
    void operator()(const physics::SetWrench& set) const
    {
        state.rigidBodies[indexOf(model.rigidBodies, set.id)].wrenches[set.element] = {set.force, set.torque};
    }
    void operator()(const physics::SetJoint& set) const
    {
        RigidState& body = state.rigidBodies[indexOf(model.rigidBodies, set.id)];
        body.joints[static_cast<std::size_t>(set.joint)].command = set.command;
    }
    void operator()(const physics::SetHaptic& set) const
    {
        const std::size_t index = indexOf(model.rigidBodies, set.id);
        physics::HapticTarget target = set.target;
        target.pose = physics::unitPose(target.pose, "target.pose");
        if (model.rigidBodies[index].dynamic)
            hold({set.element, target}, state.rigidBodies[index]);
        else
            state.rigidBodies[index].targets[set.element] = target.pose;
    }
    void operator()(const physics::SetGravity& set) const { state.gravity = set.gravity; }
    void operator()(physics::SetMaterial& set) const
    {
        const std::size_t index = indexOf(model.softBodies, set.id);
        setMaterial(set.material, model.softBodies[index]);
        if (SoftModel* start = topologies[index].start.get()) setMaterial(set.material, *start);
        // A system follows from the model alone, and the model from Def and material: any order of commands will do.
        // The old one goes back with the command: a step has no time to take it apart.
        if (auto* built = dynamic_cast<BuiltSoftBody*>(set.body.get()); built && !systems[index].tuned)
            std::swap(systems[index], built->system);
        else
            haveRemade(index, systems[index].tuned);
    }
    void operator()(const physics::SetForces& set) const
    {
        setForces(set.forces, state.softBodies[indexOf(model.softBodies, set.id)]);
    }
    void operator()(const physics::SetPressure& set) const
    {
        state.softBodies[indexOf(model.softBodies, set.id)].pressure = set.pressure;
    }
    void operator()(const physics::Attach& command) const
    {
        attach(command.id, command.body, command.def, model, state, report);
    }
    void operator()(const physics::AttachRigid& command) const
    {
        attach(command.id, command.body, command.def, model, state, report);
    }
    void operator()(const physics::Grasp& grasp) const
    {
        state.grasps.push_back({grasp.id, grasp.rigid, grasp.target, grasp.def.stiffness, grasp.def.breakForce});
    }
    void operator()(const physics::RemovePiece& remove) const
    {
        const std::size_t b = indexOf(model.softBodies, remove.id);
        if (removePiece(remove.piece, topologies[b], model.softBodies[b], state.softBodies[b], state))
            haveRemade(b, true);
        else
            ++report.topology.noPiece;
    }
    void operator()(const physics::Release& command) const
    {
        release(command.id, state);
        for (std::size_t b = 0; b < model.softBodies.size(); ++b) {
            Pins& pins = model.softBodies[b].pins;
            const auto group = std::ranges::find(pins.groups, command.id, &PinGroup::id);
            if (group == pins.groups.end()) continue;
            const auto place = group - pins.groups.begin();
            releaseGroup(static_cast<std::size_t>(place), pins);
            findHeld(pins, model.softBodies[b].pieces);
            if (SoftModel* start = topologies[b].start.get())
                releaseGroup(static_cast<std::size_t>(place), start->pins);
            haveRemade(b, true); // its Def holds more than it does
        }
    }
    void operator()(const physics::Reset&) const
    {
        for (std::size_t b = 0; b < model.softBodies.size(); ++b) makeWhole(b);
        for (std::size_t b = 0; b < model.softBodies.size(); ++b) { // positions and motion; what was given stays given
            SoftState fresh = stateAtRest(model.softBodies[b]);
            fresh.forces = std::move(state.softBodies[b].forces);
            fresh.pressure = state.softBodies[b].pressure;
            state.softBodies[b] = std::move(fresh);
        }
        for (std::size_t b = 0; b < model.rigidBodies.size(); ++b) {
            RigidState fresh = stateAtStart(model.rigidBodies[b]);
            fresh.wrenches = std::move(state.rigidBodies[b].wrenches);
            fresh.hands = std::move(state.rigidBodies[b].hands);
            state.rigidBodies[b] = std::move(fresh);
            placeLinks(model, b, state); // bodies that take others along come before them
        }
        state.contacts.clear();
        state.touching.clear();
        state.sides.clear(); // who was on which side of a sheet is no longer so
        for (std::vector<Vec3>& forces : state.holding) std::ranges::fill(forces, Vec3{});
        state.held.clear();
    }
    void operator()(const physics::Pause&) const {} // the server's: it steps with dt = 0
    void operator()(const physics::Tune& tune) const
    {
        report.set(physics::StepFlag::Tuned);
        const Model modelBefore = model;
        const State stateBefore = state;
        bool changed = false;
        try {
            tune.change(self);
            checkSameBodies(modelBefore);
            recheck(modelBefore);
            forgetReplacedSurfaces(modelBefore);
            for (SoftModel& body : model.softBodies) findHeld(body.pins, body.pieces);
            changed = true;
            for (std::size_t b = 0; b < topologies.size(); ++b) // of one that was edited a reset brings back what was
                if (topologies[b].start && topologies[b].revision == 0) *topologies[b].start = model.softBodies[b];
            for (std::size_t b = 0; b < topologies.size(); ++b) // where it was put is no way that tissue went
                if (state.softBodies[b].x != stateBefore.softBodies[b].x) topologies[b].followed = false;
        } catch (const std::exception& problem) {
            putBack(modelBefore, stateBefore, problem.what());
        } catch (...) {
            putBack(modelBefore, stateBefore, "it threw something that is no exception");
        }
        for (std::size_t b = 0; b < systems.size(); ++b) haveRemade(b, changed || systems[b].tuned);
    }

private:
    /// A body that was cut or torn is what it was before; attachments made meanwhile are gone with the nodes they held.
    void makeWhole(std::size_t b) const
    {
        BodyTopology& topology = topologies[b];
        topology.strokes.clear();
        topology.followed = false; // it is put back: no way that tissue went
        if (topology.revision == 0) return;
        SoftModel whole = std::move(*topology.start);
        whole.id = model.softBodies[b].id;
        const std::size_t nodes = whole.rest.size();
        for (std::size_t m = 0; m < whole.collision.size(); ++m) forgetSurface({whole.id, static_cast<int>(m)}, state);
        for (std::size_t side : {0, 1}) putBackAttachments(topology, whole, side);
        model.softBodies[b] = std::move(whole);
        state.softBodies[b].forces.resize(nodes);
        topology = makeTopology(model.softBodies[b]);
        model.softBodies[b].pieces = findPieces(model.softBodies[b], *topology.pieces);
        haveRemade(b, true);
    }

    /// Points at which a body that is whole again is held (side 0) or holds (side 1): those of before the first edit
    /// are where they were; attachments made since that held nodes which are no more are gone.
    void putBackAttachments(const BodyTopology& topology, const SoftModel& whole, std::size_t side) const
    {
        const auto lost = [&](const NodeWeight& each) {
            return static_cast<std::size_t>(each.node) >= whole.rest.size();
        };
        for (std::size_t a = state.attachments.size(); a-- > 0;) {
            Attachment& each = state.attachments[a];
            if ((side == 0 ? each.body : each.to) != whole.id) continue;
            const auto before = std::ranges::find(topology.startAttachments, each.id, &Attachment::id);
            bool gone = false;
            for (std::size_t p = 0; p < each.pairs.size(); ++p) {
                if (before != topology.startAttachments.end()) each.pairs[p][side] = before->pairs[p][side];
                gone = gone || std::ranges::any_of(each.pairs[p][side].nodes, lost);
            }
            if (gone) release(each.id, state);
        }
    }

    /// Those of a body that has just come: pins are in it already, and are told their names.
    void addAttachments(const physics::AddBody& add) const
    {
        std::uint32_t next = add.attachments.value;
        const auto takeId = [&] { return AttachmentId{next == 0 ? 0 : next++}; };
        if (const auto* soft = std::get_if<physics::SoftBodyDef>(add.def.get())) {
            std::vector<PinGroup>& groups = model.softBodies.back().pins.groups;
            for (std::size_t group = 0; const physics::AttachmentDef& def : soft->attachments) {
                const AttachmentId id = takeId();
                if (isPins(def)) {
                    if (SoftModel* start = topologies.back().start.get()) start->pins.groups[group].id = id;
                    groups[group++].id = id;
                } else
                    attach(id, add.id, def, model, state, report);
            }
        } else {
            for (const auto& def : std::get<physics::RigidBodyDef>(*add.def).attachments)
                attach(takeId(), add.id, def, model, state, report);
        }
    }

    /// After the last command of the step, which may change more.
    void haveRemade(std::size_t body, bool tuned) const
    {
        systems[body].outdated = true;
        systems[body].tuned = tuned;
    }

    void putBack(const Model& modelBefore, const State& stateBefore, const char* why) const
    {
        model = modelBefore;
        state = stateBefore;
        report.set(physics::StepFlag::TuneRejected);
        logError("tune() was undone: ", why);
    }

    /// Callers know bodies by id and have checked their commands against the node counts: both must stay.
    void checkSameBodies(const Model& before) const
    {
        const auto same = [](const auto& a, const auto& b) { return a.id == b.id && a.rest.size() == b.rest.size(); };
        if (!std::ranges::equal(model.softBodies, before.softBodies, same) ||
            !std::ranges::equal(model.rigidBodies, before.rigidBodies, same))
            fail("tune: bodies, their ids, nodes and elements must stay; use add() and remove()");
    }

    void recheck(const Model& before) const
    {
        if (!nonNegative().contains(state.time)) fail("tune: time must be >= 0 s, got ", state.time);
        if (state.softBodies.size() != model.softBodies.size() || state.rigidBodies.size() != model.rigidBodies.size())
            fail("tune: model and state must hold the same bodies");
        if (!isFinite(state.gravity)) fail("tune: gravity must be finite");
        for (std::size_t b = 0; b < model.softBodies.size(); ++b) check(model.softBodies[b], state.softBodies[b]);
        for (std::size_t b = 0; b < model.rigidBodies.size(); ++b) check(model.rigidBodies[b], state.rigidBodies[b]);
        for (std::size_t b = 0; b < model.softBodies.size(); ++b)
            checkSameMesh(topologies[b], before.softBodies[b], model.softBodies[b]);
        checkAttachments(model, state);
        checkMemories(model, state);
    }

    /// What is cut is the mesh as edits know it.
    void checkSameMesh(const BodyTopology& topology, const SoftModel& before, const SoftModel& body) const
    {
        if (body.dynamicTopology != (topology.mesh != nullptr))
            fail("tune: soft body '", body.name, "': dynamicTopology must stay what it is");
        if (!topology.mesh) return;
        const MeshTopology& mesh = topology.mesh->data();
        bool same = body.rest == mesh.rest && body.surface == before.surface &&
                    body.elements.size() + body.tetrahedra.size() == mesh.tetrahedra.size();
        for (std::size_t e = 0; same && e < mesh.tetrahedra.size(); ++e)
            same = mesh.tetrahedra[e] == (body.elements.empty() ? body.tetrahedra[e] : body.elements[e].nodes);
        if (!same)
            fail("tune: soft body '", body.name, "': nodes at rest, elements and surface must stay: it may be cut");
    }

    /// The numbers of a surface's features mean nothing of another one.
    void forgetReplacedSurfaces(const Model& before) const
    {
        const auto forget = [&](const auto& old, const auto& now) { // the same bodies, in the same order
            for (std::size_t b = 0; b < now.size(); ++b)
                for (std::size_t m = 0; m < std::max(old[b].collision.size(), now[b].collision.size()); ++m)
                    if (m >= old[b].collision.size() || m >= now[b].collision.size() ||
                        old[b].collision[m].shape != now[b].collision[m].shape)
                        forgetSurface({now[b].id, static_cast<int>(m)}, state);
        };
        forget(before.softBodies, model.softBodies);
        forget(before.rigidBodies, model.rigidBodies);
    }
};

} // namespace

void applyCommands(std::span<physics::Command> commands, physics::PhysicsEngine& self, Model& model, State& state,
                   Systems& systems, Topologies& topologies, physics::StepReport& report)
{
    const Apply apply{self, model, state, systems, topologies, report};
    for (physics::Command& command : commands) std::visit(apply, command);
}

void remakeSystems(const Model& model, double period, Systems& systems)
{
    for (std::size_t b = 0; b < systems.size(); ++b) {
        if (!systems[b].outdated) continue;
        const bool tuned = systems[b].tuned;
        systems[b] = makeSystem(model.softBodies[b], period);
        systems[b].tuned = tuned;
    }
}

} // namespace filasofia::engine
