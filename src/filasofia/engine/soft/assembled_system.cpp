#include "filasofia/engine/soft/assembled_system.h"

#include "filasofia/core/sorted.h"
#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/body/nodal_volume.h"
#include "filasofia/engine/body/tissue.h"
#include "filasofia/engine/soft/assembled_shell.h"
#include "filasofia/math/polar.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

RayleighDamping damping(const SoftModel& model) { return {model.rayleigh.mass, model.rayleigh.stiffness}; }

void scatterAdd(double factor, const Corners& from, const std::array<int, 4>& nodes, std::vector<Vec3>& to)
{
    for (int i = 0; i < 4; ++i) to[nodes[i]] += factor * from[i];
}

void addElements(const SoftModel& model, ImplicitWeights weights, const RelaxationStep& relaxation, SoftState& state,
                 AssembledSystem& system)
{
    const bool implicit = system.solver != nullptr;
    for (std::size_t e = 0; e < model.elements.size(); ++e) {
        const FemElement& element = model.elements[e];
        const Mat3 f = gradient(element, cornersOf(element.nodes, state.x));
        const Quat turned = polarRotation(f, rotationOf(state.rotations, e));
        setRotation(state.rotations, e, turned);
        const Deformation at{f, toMat3(turned)};
        const TissueTangent tangent = implicit ? stepTangent(model, e, at, weights) : dampingTangent(model, e, at);
        scatterAdd(-1.0, internalForces(element, startStress(model, relaxation, e, at, state)), element.nodes,
                   system.forces);
        scatterAdd(1.0, stiffnessTimes(tangent, element, cornersOf(element.nodes, state.v)), element.nodes,
                   system.stiffnessTimesVelocity);
        if (!implicit) continue;

        const double scale = weights.stiffness * element.volume;
        const std::array<int, 16>& positions = system.elementBlocks[e];
        for (int i = 0; i < 4; ++i)
            for (int j = i; j < 4; ++j) {
                if (positions[4 * i + j] < 0) continue;
                const Mat3 block = scale * stiffnessBlock(tangent, element.gradients[i], element.gradients[j]);
                system.matrix.block(positions[4 * i + j]) += block;
                if (j != i) system.matrix.block(positions[4 * j + i]) += transpose(block);
            }
    }
}

/// How the volume of a node depends on the nodes around it: k_n d(theta_n)/dx of each.
struct VolumeRow {
    std::vector<int> nodes;
    std::vector<Vec3> gradients;

    void add(int node, Vec3 gradient)
    {
        const auto known = std::ranges::find(nodes, node);
        if (known != nodes.end()) {
            gradients[static_cast<std::size_t>(known - nodes.begin())] += gradient;
            return;
        }
        nodes.push_back(node);
        gradients.push_back(gradient);
    }
};

/// The volumes of nodes (nodal_volume.h). Their tangent leaves out what pressure adds to it, so it is positive.
void addVolumes(const SoftModel& model, ImplicitWeights weights, const SoftState& state, AssembledSystem& system)
{
    if (!model.nodalVolumes) return;
    std::vector<VolumeRow> rows(model.rest.size());
    std::vector<double> stiffness(model.rest.size());
    const std::vector<double> changes = volumeChanges(model, state.x);
    for (const FemElement& element : model.elements) {
        const double share = nodalShare(element);
        if (share == 0.0) continue;
        const Corners gradients = volumeGradients(element, gradient(element, cornersOf(element.nodes, state.x)));
        for (int node : element.nodes) {
            stiffness[node] += share;
            for (int i = 0; i < 4; ++i) rows[node].add(element.nodes[i], share * gradients[i]);
        }
    }
    for (std::size_t n = 0; n < rows.size(); ++n) {
        const auto& [nodes, gradients] = rows[n];
        double rate = 0.0;
        for (std::size_t i = 0; i < nodes.size(); ++i) rate += dot(gradients[i], state.v[nodes[i]]) / stiffness[n];
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            system.forces[nodes[i]] -= changes[n] * gradients[i];
            system.stiffnessTimesVelocity[nodes[i]] += rate * gradients[i];
            for (std::size_t j = 0; system.solver && j < nodes.size(); ++j)
                if (!model.pins.hard[nodes[i]] && !model.pins.hard[nodes[j]])
                    system.matrix.block(system.matrix.find(nodes[i], nodes[j])) +=
                        weights.stiffness / stiffness[n] * outer(gradients[i], gradients[j]);
        }
    }
}

void addSprings(const SoftModel& model, ImplicitWeights weights, const SoftState& state, AssembledSystem& system)
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

void addPins(const SoftModel& model, ImplicitWeights weights, const SoftState& state, AssembledSystem& system)
{
    for (const PinSpring& pin : model.pins.springs) {
        system.stiffnessTimesVelocity[pin.node] += pin.stiffness * state.v[pin.node];
        if (system.solver && !model.pins.hard[pin.node])
            system.matrix.block(system.diagonalBlocks[pin.node]) +=
                weights.stiffness * pin.stiffness * Mat3::identity();
    }
}

void addMassesToMatrix(const SoftModel& model, double weight, AssembledSystem& system)
{
    // A pinned node's row is that of the identity. Its right-hand side is zero, so it keeps its velocity of zero.
    for (std::size_t i = 0; i < model.masses.size(); ++i)
        system.matrix.block(system.diagonalBlocks[i]) +=
            (model.pins.hard[i] ? 1.0 : weight * model.masses[i]) * Mat3::identity();
}

/// The columns of every row: the node itself and the nodes that share an element, a spring or a node's volume with it.
std::vector<std::vector<int>> blockColumns(const SoftModel& model)
{
    std::vector<std::vector<int>> columns(model.rest.size());
    const auto connect = [&](const auto& nodes) {
        for (int a : nodes) columns[a].insert(columns[a].end(), nodes.begin(), nodes.end());
    };
    for (std::size_t i = 0; i < columns.size(); ++i) columns[i].push_back(static_cast<int>(i));
    for (const FemElement& element : model.elements) connect(element.nodes);
    if (model.nodalVolumes) { // a node's volume connects all nodes around it
        std::vector<std::vector<int>> around(model.rest.size());
        for (const FemElement& element : model.elements)
            if (nodalBulk(element) > 0.0)
                for (int node : element.nodes)
                    around[node].insert(around[node].end(), element.nodes.begin(), element.nodes.end());
        for (std::vector<int>& nodes : around) {
            sortUnique(nodes);
            connect(nodes);
        }
    }
    for (const Spring& spring : model.springs) connect(spring.nodes);
    for (const MembraneElement& each : model.shell.membranes) connect(each.nodes);
    for (const BendingElement& each : model.shell.bends) connect(each.nodes);
    for (auto& row : columns) {
        sortUnique(row);
    }
    return columns;
}

/// The places of one element's blocks in the matrix. Rows and columns of pinned nodes are left out: they stay those of
/// the identity.
template <std::size_t n> std::array<int, n * n>
blockPositions(const linalg::BlockSparseMatrix& matrix, const std::vector<bool>& held, const std::array<int, n>& nodes)
{
    std::array<int, n * n> positions;
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j)
            positions[n * i + j] = held[nodes[i]] || held[nodes[j]] ? -1 : matrix.find(nodes[i], nodes[j]);
    return positions;
}

std::unique_ptr<linalg::LinearSolver> makeSolver(const SoftModel& model)
{
    const auto* cg = std::get_if<physics::ConjugateGradient>(&model.solver);
    if (!cg) return linalg::makeCholesky();
    if (cg->assembled) return linalg::makeConjugateGradient(cg->maxIterations, cg->tolerance);
    // The default solver was asked for, but float cannot represent the model. On a nearly incompressible body conjugate
    // gradients reach their maximum of iterations far from the solution, also in double: bunnies with a Poisson ratio
    // of 0.5 - 1e-8 blew up.
    if (nearlyIncompressible(model)) return linalg::makeCholesky();
    // The default solver's tolerance is on the energy; 1e-4 on the residual gives the same quality.
    return linalg::makeConjugateGradient(cg->maxIterations, std::min(cg->tolerance, 1e-4));
}

} // namespace

bool nearlyIncompressible(const SoftModel& model)
{
    return std::any_of(model.elements.begin(), model.elements.end(), [](const FemElement& e) {
        const auto [mu, lambda] = lame(e.youngModulus, e.poissonRatio);
        return lambda > kMaxLameRatio * mu;
    });
}

AssembledSystem::AssembledSystem(const SoftModel& model)
    : forces(model.rest.size()), stiffnessTimesVelocity(model.rest.size()), rightHandSide(model.rest.size())
{
    if (!std::holds_alternative<physics::ImplicitEuler>(model.integrator)) return;
    matrix = linalg::BlockSparseMatrix(blockColumns(model));
    for (const FemElement& element : model.elements) {
        elementBlocks.push_back(blockPositions(matrix, model.pins.hard, element.nodes));
        sharing.push_back(nodalBulk(element) > 0.0);
    }
    for (const Spring& spring : model.springs)
        springBlocks.push_back(blockPositions(matrix, model.pins.hard, spring.nodes));
    for (int i = 0; i < matrix.rows(); ++i) diagonalBlocks.push_back(matrix.find(i, i));
    solver = makeSolver(model);
}

bool AssembledSystem::holds(const SoftModel& model, const std::vector<int>& elements) const
{
    return !solver ||
           std::ranges::all_of(elements, [&](int e) { return sharing[e] || nodalBulk(model.elements[e]) == 0.0; });
}

void assembleMatrix(const SoftModel& model, std::span<const Vec3> given, double dt, double inertia, SoftState& state,
                    AssembledSystem& system)
{
    const RelaxationStep relaxation = nextRelaxation(model, dt, state);
    const ImplicitWeights weights = implicitWeights(dt, damping(model), relaxation.tangent);
    system.matrix.setZero();
    system.forces.assign(given.begin(), given.end());
    std::fill(system.stiffnessTimesVelocity.begin(), system.stiffnessTimesVelocity.end(), Vec3{});
    addElements(model, weights, relaxation, state, system);
    addVolumes(model, weights, state, system);
    addSprings(model, weights, state, system);
    addShell(model, weights, state, system);
    addPins(model, weights, state, system);
    if (!system.solver) return;
    addMassesToMatrix(model, inertia * weights.mass, system);
    const NodeState nodes{model.masses, system.forces, system.stiffnessTimesVelocity, state.v, model.pins.hard};
    implicitRightHandSide(dt, damping(model), nodes, system.rightHandSide);
}

linalg::SolveReport solve(const SoftModel& model, double dt, double inertia, std::span<const Vec3> v,
                          AssembledSystem& system, std::span<Vec3> dv)
{
    if (system.solver) return system.solver->solve(system.matrix, system.rightHandSide, dv);
    const NodeState nodes{model.masses, system.forces, system.stiffnessTimesVelocity, v, model.pins.hard};
    explicitChange(dt, damping(model), inertia, nodes, dv);
    return {};
}

} // namespace filasofia::engine
