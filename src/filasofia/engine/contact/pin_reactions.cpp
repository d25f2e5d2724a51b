#include "filasofia/engine/contact/pin_reactions.h"

#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/body/nodal_volume.h"
#include "filasofia/engine/body/tissue.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

/// Adds the forces of the elements and springs of a body in double on its nodes, at the end of the step, with the
/// rotations at its start. They are correct only for nodes held by a hard pin.
void addOwnForces(const SoftModel& model, const PinnedParts& held, double dt, const SoftState& state,
                  std::vector<Vec3>& forces)
{
    const double beta = model.rayleigh.stiffness;
    const RelaxationStep relaxation = relaxationWithin(model, dt);
    const std::vector<double> changes = volumeChanges(model, state.x, held.volumes);
    const std::vector<double> rates = volumeRates(model, state, held.volumes);
    for (int e : held.elements) {
        const FemElement& element = model.elements[e];
        const Mat3 f = gradient(element, cornersOf(element.nodes, state.x));
        const Deformation at{f, toMat3(rotationOf(state.rotations, static_cast<std::size_t>(e)))};
        const Corners elastic =
            internalForces(element, tissueStress(model, state, relaxation, static_cast<std::size_t>(e), at));
        const Corners damping = stiffnessTimes(dampingTangent(model, static_cast<std::size_t>(e), at), element,
                                               cornersOf(element.nodes, state.v));
        for (int i = 0; i < 4; ++i) forces[element.nodes[i]] += -elastic[i] - beta * damping[i];
        if (changes.empty()) continue;
        const double tension = nodalTension(element, changes) + beta * nodalTension(element, rates);
        const Corners volume = volumeGradients(element, f);
        for (int i = 0; i < 4; ++i) forces[element.nodes[i]] -= tension * element.volume * volume[i];
    }
    for (int s : held.springs) {
        const Spring& spring = model.springs[s];
        const auto [a, b] = spring.nodes;
        const Vec3 xa = state.x[a], xb = state.x[b], va = state.v[a], vb = state.v[b];
        const Vec3 force = springForce(spring, xa, xb) + dashpotForce(spring, xa, xb, va, vb) -
                           beta * (springStiffness(spring, xa, xb) * (va - vb));
        forces[a] += force;
        forces[b] -= force;
    }
}

/// The same for the triangles of a shell.
void addShellForces(const SoftModel& model, const PinnedParts& held, const SoftState& state, std::vector<Vec3>& forces)
{
    const double beta = model.rayleigh.stiffness;
    const auto add = [&](const auto& nodes, const auto& elastic, const auto& damping) {
        for (std::size_t i = 0; i < nodes.size(); ++i) forces[nodes[i]] += elastic[i] - beta * damping[i];
    };
    for (int each : held.membranes) {
        const MembraneElement& element = model.shell.membranes[each];
        const TriangleCorners x = vectorsAt(element.nodes, state.x);
        add(element.nodes, membraneForces(element, x),
            stiffnessTimes(membraneTangent(element, x, 0.0), vectorsAt(element.nodes, state.v)));
    }
    for (int each : held.bends) {
        const BendingElement& element = model.shell.bends[each];
        const BendingCorners x = vectorsAt(element.nodes, state.x);
        add(element.nodes, bendingForces(element, x),
            stiffnessTimes(bendingTangent(element, x), vectorsAt(element.nodes, state.v)));
    }
}

/// Adds the forces of contacts and attachments on nodes that cannot move.
void addConstraintForces(std::size_t body, double dt, std::span<const Constraint> constraints,
                         std::vector<Vec3>& forces)
{
    for (const Constraint& constraint : constraints)
        for (std::size_t side = 0; side < 2; ++side) {
            const BodyPoint& point = constraint.sides[side];
            if (point.of != BodyPoint::Of::Soft || point.body != body) continue;
            const Vec3 impulse = inWorld(constraint.frame, constraint.impulse);
            for (std::size_t k = 0; k < static_cast<std::size_t>(point.count); ++k)
                forces[point.nodes[k]] += (side == 0 ? 1.0 : -1.0) / dt * point.weights[k] * impulse;
        }
}

/// [N] The reaction of hard pins is opposite to all forces on their nodes.
Vec3 hardReaction(const PinGroup& group, const Pins& pins, const std::vector<int>& holders,
                  const std::vector<Vec3>& forces)
{
    Vec3 sum;
    for (int node : group.nodes)
        if (pins.hard[node]) sum -= 1.0 / holders[node] * forces[node];
    return sum;
}

Vec3 springReaction(const PinGroup& group, const SoftModel& model, const SoftState& state)
{
    Vec3 sum;
    for (int node : group.nodes)
        sum += group.stiffness * (model.rest[node] - state.x[node] - model.rayleigh.stiffness * state.v[node]);
    return sum;
}

} // namespace

void addPinReactions(const StepContext& context, std::span<const Constraint> constraints, Scene& scene)
{
    for (std::size_t b = 0; b < scene.soft.size(); ++b) {
        const SoftModel& model = scene.soft[b].model;
        const SoftState& now = scene.soft[b].state;
        SoftSystem& system = scene.soft[b].system;
        if (!system.held.holders.empty()) {
            system.onPins = system.forces; // external forces, weight, pressure, springs
            if (system.matrixFree) {
                system.matrixFree->addHeldForces(context.dt, model, system.held, now.dv, context.pool, system.onPins);
            } else {
                addOwnForces(model, system.held, context.dt, now, system.onPins);
                addShellForces(model, system.held, now, system.onPins);
                addRodForces(model, now, model.pins.hard, system.onPins);
            }
            addConstraintForces(b, context.dt, constraints, system.onPins);
        }
        for (const PinGroup& group : model.pins.groups) {
            frame::Attachment& report = scene.attachmentReports.emplace_back();
            report.id = group.id;
            report.body = model.id;
            report.points = static_cast<int>(group.nodes.size());
            report.force = group.stiffness == physics::kHard
                               ? hardReaction(group, model.pins, system.held.holders, system.onPins)
                               : springReaction(group, model, now);
        }
    }
}

} // namespace filasofia::engine
