#include "filasofia/engine/scene/mechanical_energy.h"

#include "filasofia/engine/body/elastic_energy.h"

namespace filasofia::engine {
namespace {

/// Per node, whether it belongs to a removed piece; empty if none was removed. All edges of a rod's piece are cut: its
/// nodes rest where they were.
std::vector<bool> goneNodes(const SoftBody& body)
{
    std::vector<bool> gone;
    if (body.model.removed.empty()) return gone;
    gone.resize(body.model.rest.size());
    if (isRod(body.model)) {
        const Rod& rod = body.model.rod;
        const auto alone = [&](std::size_t edge) { return edge >= rod.edges.size() || isCut(rod, edge); };
        for (std::size_t i = 0; i < gone.size(); ++i) {
            const std::size_t before = wrapped(i + gone.size() - 1, gone.size());
            gone[i] = body.model.pins.hard[i] && alone(before) && alone(i);
        }
        return gone;
    }
    const std::vector<int>& pieces = body.topology.pieces->ofTetrahedron();
    for (std::size_t e = 0; e < pieces.size(); ++e)
        if (body.model.removed.contains(pieces[e]))
            for (const int node : body.topology.mesh->data().tetrahedra[e])
                if (node >= 0) gone[static_cast<std::size_t>(node)] = true; // a triangle has three
    return gone;
}

} // namespace

physics::MechanicalEnergy mechanicalEnergy(const SoftBody& body, Vec3 gravity)
{
    const SoftModel& model = body.model;
    const std::vector<bool> gone = goneNodes(body);
    physics::MechanicalEnergy out{.elastic = elasticEnergy(model, body.state, gone)};
    for (std::size_t i = 0; i < model.masses.size(); ++i) {
        if (!gone.empty() && gone[i]) continue;
        out.kinetic += 0.5 * model.masses[i] * lengthSquared(body.state.v[i]);
        // With the liquid in cavities, whose weight acts as its pressure.
        if (model.gravity) out.gravitational -= model.masses[i] * dot(gravity, body.state.x[i]);
    }
    for (std::size_t e = 0; e < model.rod.inertias.size(); ++e)
        out.kinetic += 0.5 * model.rod.inertias[e] * body.state.rod.spins[e] * body.state.rod.spins[e];
    return out;
}

namespace {

/// Whether a joint, or the one that it mimics, moves under forces.
bool isFree(const RigidBody& body, std::size_t joint)
{
    const int other = body.model.articulation.tree.joints[joint].mimics;
    const JointState& state = body.state.joints[other < 0 ? joint : static_cast<std::size_t>(other)];
    return physics::isByForce(state.command);
}

/// Whether nothing but commands moves a link.
bool isTold(const RigidBody& body, std::size_t link)
{
    const LinkTree& tree = body.model.articulation.tree;
    if (tree.joints.empty() || body.model.dynamic) return false;
    for (int joint = tree.jointOf[link]; joint >= 0;) { // up to the base
        const auto at = static_cast<std::size_t>(joint);
        if (isFree(body, at)) return false;
        joint = tree.jointOf[static_cast<std::size_t>(tree.joints[at].parent)];
    }
    return true;
}

} // namespace

physics::MechanicalEnergy mechanicalEnergy(const RigidBody& body, Vec3 gravity)
{
    const RigidModel& model = body.model;
    const RigidState& state = body.state;
    const LinkTree& tree = model.articulation.tree;
    physics::MechanicalEnergy out;
    for (std::size_t e = 0; e < state.poses.size(); ++e) {
        const physics::RigidInertia& inertia = model.inertias[e];
        if (inertia.mass == 0.0 || isTold(body, e)) continue;
        const Vec3 centre = transform(state.poses[e], inertia.centre), spin = state.angularVelocities[e];
        // A link's velocity is that of its origin.
        const Vec3 velocity = tree.joints.empty() ? state.velocities[e]
                                                  : state.velocities[e] + cross(spin, centre - state.poses[e].position);
        const Vec3 turning = rotate(conjugate(state.poses[e].orientation), spin);
        out.kinetic += 0.5 * inertia.mass * lengthSquared(velocity) + 0.5 * dot(turning, inertia.inertia * turning);
        if (model.gravity) out.gravitational -= inertia.mass * dot(gravity, centre);
    }
    for (std::size_t j = 0; j < tree.joints.size(); ++j)
        if (tree.joints[j].mimics < 0 && isFree(body, j)) // the inertia of what mimics it is in it
            out.kinetic += 0.5 * tree.joints[j].inertia * state.joints[j].now.velocity * state.joints[j].now.velocity;
    return out;
}

} // namespace filasofia::engine
