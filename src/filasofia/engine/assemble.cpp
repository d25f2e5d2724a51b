#include "filasofia/engine/integrate/euler.h"
#include "filasofia/engine/stages.h"
#include "filasofia/math/polar.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

RayleighDamping damping(const SoftModel& model) { return {model.rayleigh.mass, model.rayleigh.stiffness}; }

Corners gather(const std::vector<Vec3>& values, const std::array<int, 4>& nodes)
{
    return {values[nodes[0]], values[nodes[1]], values[nodes[2]], values[nodes[3]]};
}

void scatterAdd(const Corners& from, const std::array<int, 4>& nodes, std::vector<Vec3>& to)
{
    for (int i = 0; i < 4; ++i) to[nodes[i]] += from[i];
}

/// The forces that are there without any deformation: weight, what the user gave, pressure on the surface.
void addGivenForces(const SoftModel& model, Vec3 gravity, const SoftState& state, std::vector<Vec3>& forces)
{
    for (std::size_t i = 0; i < forces.size(); ++i)
        forces[i] = state.forces[i] + (model.gravity ? model.masses[i] * gravity : Vec3{});
    if (state.pressure == 0.0) return;
    for (const geometry::Triangle& t : model.surface) {
        const Vec3 area = 0.5 * cross(state.x[t[1]] - state.x[t[0]], state.x[t[2]] - state.x[t[0]]); // outwards
        for (int node : t) forces[node] -= state.pressure / 3.0 * area;
    }
}

void addElements(const SoftModel& model, ImplicitWeights weights, SoftState& state, SoftSystem& system)
{
    const bool implicit = system.solver != nullptr;
    for (std::size_t e = 0; e < model.elements.size(); ++e) {
        const FemElement& element = model.elements[e];
        const Mat3 f = gradient(element, gather(state.x, element.nodes));
        state.rotations[e] = polarRotation(f, state.rotations[e]);
        const Mat3 rotation = toMat3(state.rotations[e]);
        scatterAdd(corotationalForces(element, f, rotation), element.nodes, system.forces);
        scatterAdd(warpedStiffnessTimes(element, rotation, gather(state.v, element.nodes)), element.nodes,
                   system.stiffnessTimesVelocity);
        if (!implicit) continue;

        Corners rotated;
        for (int i = 0; i < 4; ++i) rotated[i] = rotation * element.gradients[i];
        const Lame material = lame(element.youngModulus, element.poissonRatio);
        const double scale = weights.stiffness * element.volume;
        const std::array<int, 16>& positions = system.elementBlocks[e];
        for (int i = 0; i < 4; ++i)
            for (int j = i; j < 4; ++j) {
                if (positions[4 * i + j] < 0) continue;
                const Mat3 block = warpedStiffnessBlock(rotated, material, scale, i, j);
                system.matrix.block(positions[4 * i + j]) += block;
                if (j != i) system.matrix.block(positions[4 * j + i]) += transpose(block);
            }
    }
}

void addSprings(const SoftModel& model, ImplicitWeights weights, const SoftState& state, SoftSystem& system)
{
    const bool implicit = system.solver != nullptr;
    for (std::size_t s = 0; s < model.springs.size(); ++s) {
        const Spring& spring = model.springs[s];
        const auto [a, b] = spring.nodes;
        const Vec3 xa = state.x[a], xb = state.x[b], va = state.v[a], vb = state.v[b];
        const Vec3 force = springForce(spring, xa, xb) + dashpotForce(spring, xa, xb, va, vb);
        system.forces[a] += force;
        system.forces[b] -= force;
        const Mat3 stiffness = springStiffness(spring, xa, xb);
        const Vec3 kv = stiffness * (va - vb);
        system.stiffnessTimesVelocity[a] += kv;
        system.stiffnessTimesVelocity[b] -= kv;
        if (!implicit) continue;

        const Mat3 block = weights.stiffness * stiffness + weights.damping * springDamping(spring, xa, xb);
        for (int k = 0; k < 4; ++k)
            if (const int p = system.springBlocks[s][k]; p >= 0)
                system.matrix.block(p) += k == 0 || k == 3 ? block : -1.0 * block;
    }
}

void addPins(const SoftModel& model, ImplicitWeights weights, const SoftState& state, SoftSystem& system)
{
    addPinForces(model.pins, state.x, system.forces);
    for (const PinSpring& pin : model.pins.springs) {
        system.stiffnessTimesVelocity[pin.node] += pin.stiffness * state.v[pin.node];
        if (system.solver && !model.pins.hard[pin.node])
            system.matrix.block(system.diagonalBlocks[pin.node]) +=
                weights.stiffness * pin.stiffness * Mat3::identity();
    }
}

void addMassesToMatrix(const SoftModel& model, ImplicitWeights weights, SoftSystem& system)
{
    // A held node's row is that of the identity: with nothing on its right-hand side it keeps its velocity of zero.
    for (std::size_t i = 0; i < model.masses.size(); ++i)
        system.matrix.block(system.diagonalBlocks[i]) +=
            (model.pins.hard[i] ? 1.0 : weights.mass * model.masses[i]) * Mat3::identity();
}

void assembleBody(const SoftModel& model, Vec3 gravity, double dt, SoftState& state, SoftSystem& system)
{
    const ImplicitWeights weights = implicitWeights(dt, damping(model));
    system.matrix.setZero();
    std::fill(system.stiffnessTimesVelocity.begin(), system.stiffnessTimesVelocity.end(), Vec3{});
    addGivenForces(model, gravity, state, system.forces);
    addElements(model, weights, state, system);
    addSprings(model, weights, state, system);
    addPins(model, weights, state, system);
    if (!system.solver) return;
    addMassesToMatrix(model, weights, system);
    implicitRightHandSide(dt, damping(model), model.masses, system.forces, system.stiffnessTimesVelocity, state.v,
                          model.pins.hard, system.rightHandSide);
}

} // namespace

void assemble(const Model& model, double dt, State& state, Systems& systems)
{
    if (dt == 0.0) return;
    for (std::size_t b = 0; b < model.softBodies.size(); ++b)
        assembleBody(model.softBodies[b], state.gravity, dt, state.softBodies[b], systems[b]);
}

} // namespace filasofia::engine
