#include "filasofia/core/validate.h"
#include "filasofia/engine/soft_system.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

void checkSize(const std::string& object, const char* list, std::size_t size, std::size_t expected)
{
    if (size != expected) fail(object, ": ", list, " must have ", expected, " entries, got ", size);
}

void checkFinite(const std::string& object, const char* list, const std::vector<Vec3>& values)
{
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!isFinite(values[i])) fail(object, ": ", list, "[", i, "] must be finite");
}

template <class Nodes> void checkNodes(const std::string& object, const Nodes& nodes, std::size_t count)
{
    for (int node : nodes)
        if (node < 0 || static_cast<std::size_t>(node) >= count)
            fail(object, ": node must be in [0, ", count, "), got ", node);
}

void checkElements(const SoftModel& model, const std::string& object)
{
    for (std::size_t e = 0; e < model.elements.size(); ++e) {
        const FemElement& element = model.elements[e];
        const std::string name = text(object, ": elements[", e, "]");
        checkNodes(name, element.nodes, model.rest.size());
        if (!positive().contains(element.volume)) fail(name, ".volume must be > 0 m^3, got ", element.volume);
        validate(physics::FemMaterial{element.youngModulus, element.poissonRatio}, name);
        for (const Vec3& g : element.gradients)
            if (!isFinite(g)) fail(name, ".gradients must be finite");
    }
}

void checkSprings(const SoftModel& model, const std::string& object)
{
    for (std::size_t s = 0; s < model.springs.size(); ++s) {
        const Spring& spring = model.springs[s];
        const std::string name = text(object, ": springs[", s, "]");
        checkNodes(name, spring.nodes, model.rest.size());
        if (!nonNegative().contains(spring.restLength))
            fail(name, ".restLength must be >= 0 m, got ", spring.restLength);
        validate(physics::MassSpringMaterial{spring.stiffness, spring.damping}, name);
    }
}

void checkPins(const SoftModel& model, const std::string& object)
{
    checkSize(object, "pins.hard", model.pins.hard.size(), model.rest.size());
    for (const PinSpring& pin : model.pins.springs) {
        checkNodes(object, std::array{pin.node}, model.rest.size());
        if (!positive().contains(pin.stiffness))
            fail(object, ": a pin's stiffness must be > 0 N/m, got ", pin.stiffness);
        if (!isFinite(pin.anchor)) fail(object, ": a pin's anchor must be finite");
    }
}

/// The blocks of every row: a node's own and those of the nodes it shares an element or a spring with.
std::vector<std::vector<int>> blockColumns(const SoftModel& model)
{
    std::vector<std::vector<int>> columns(model.rest.size());
    const auto connect = [&](const auto& nodes) {
        for (int a : nodes) columns[a].insert(columns[a].end(), nodes.begin(), nodes.end());
    };
    for (std::size_t i = 0; i < columns.size(); ++i) columns[i].push_back(static_cast<int>(i));
    for (const FemElement& element : model.elements) connect(element.nodes);
    for (const Spring& spring : model.springs) connect(spring.nodes);
    for (auto& row : columns) {
        std::sort(row.begin(), row.end());
        row.erase(std::unique(row.begin(), row.end()), row.end());
    }
    return columns;
}

/// Where the blocks of one element go. Rows and columns of held nodes are left out: they stay those of the identity.
template <std::size_t n> std::array<int, n * n>
blockPositions(const linalg::BlockSparseMatrix& matrix, const std::vector<bool>& held, const std::array<int, n>& nodes)
{
    std::array<int, n * n> positions;
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j)
            positions[n * i + j] = held[nodes[i]] || held[nodes[j]] ? -1 : matrix.find(nodes[i], nodes[j]);
    return positions;
}

std::unique_ptr<linalg::LinearSolver> makeSolver(const physics::Solver& solver)
{
    if (const auto* cg = std::get_if<physics::ConjugateGradient>(&solver))
        return linalg::makeConjugateGradient(cg->maxIterations, cg->tolerance);
    return linalg::makeCholesky();
}

} // namespace

SoftState stateAtRest(const SoftModel& model)
{
    SoftState state;
    state.x = model.rest;
    state.v.resize(model.rest.size());
    state.dv.resize(model.rest.size());
    state.forces.resize(model.rest.size());
    state.rotations.resize(model.elements.size());
    return state;
}

bool usable(const std::vector<Vec3>& values)
{
    constexpr double far = physics::kFarthest;
    for (const Vec3& v : values)
        if (!(std::abs(v.x) < far && std::abs(v.y) < far && std::abs(v.z) < far)) return false;
    return true;
}

void check(const SoftModel& model, const SoftState& state)
{
    const std::string object = text("soft body '", model.name, "'");
    const std::size_t n = model.rest.size();
    if (n == 0) fail(object, ": must have at least one node");
    checkSize(object, "masses", model.masses.size(), n);
    for (double mass : model.masses)
        if (!positive().contains(mass)) fail(object, ": masses must be > 0 kg, got ", mass);
    checkElements(model, object);
    checkSprings(model, object);
    checkPins(model, object);
    for (const geometry::Triangle& triangle : model.surface) checkNodes(object, triangle, n);
    validate(model.rayleigh, object + ": rayleigh");
    std::visit([&](const auto& each) { validate(each, object + ": integrator"); }, model.integrator);
    std::visit([&](const auto& each) { validate(each, object + ": solver"); }, model.solver);

    for (const auto& [list, values] : {std::pair{"x", &state.x},
                                       {"v", &state.v},
                                       {"dv", &state.dv},
                                       {"forces", &state.forces},
                                       {"rest", &model.rest}}) {
        checkSize(object, list, values->size(), n);
        checkFinite(object, list, *values);
    }
    if (!usable(state.x) || !usable(state.v) || !usable(model.rest))
        fail(object, ": nodes must lie within ", physics::kFarthest,
             " m of the origin, and be slower than as many m/s");
    for (std::size_t i = 0; i < n; ++i)
        if (model.pins.hard[i] && !(state.v[i] == Vec3{} && state.dv[i] == Vec3{}))
            fail(object, ": v[", i, "] and dv[", i, "] must be 0 m/s: the node is held");
    checkSize(object, "rotations", state.rotations.size(), model.elements.size());
    for (const Quat& q : state.rotations)
        if (!(std::abs(dot(q, q) - 1.0) < 1e-6)) fail(object, ": rotations must be unit quaternions");
    if (!std::isfinite(state.pressure)) fail(object, ": pressure must be finite, got ", state.pressure);
}

void check(const RigidModel& model, const RigidState& state)
{
    const std::string object = text("rigid body '", model.name, "'");
    if (model.rest.empty()) fail(object, ": elements must have at least one entry");
    checkSize(object, "poses", state.poses.size(), model.rest.size());
    for (const std::vector<Pose>* poses : {&model.rest, &state.poses})
        for (const Pose& pose : *poses) {
            if (!isFinite(pose)) fail(object, ": poses must be finite");
            if (std::abs(dot(pose.orientation, pose.orientation) - 1.0) > 1e-6)
                fail(object, ": orientation must be a unit quaternion");
        }
}

SoftSystem makeSystem(const SoftModel& model)
{
    SoftSystem system;
    if (std::holds_alternative<physics::ImplicitEuler>(model.integrator)) {
        system.matrix = linalg::BlockSparseMatrix(blockColumns(model));
        for (const FemElement& element : model.elements)
            system.elementBlocks.push_back(blockPositions(system.matrix, model.pins.hard, element.nodes));
        for (const Spring& spring : model.springs)
            system.springBlocks.push_back(blockPositions(system.matrix, model.pins.hard, spring.nodes));
        for (int i = 0; i < system.matrix.rows(); ++i) system.diagonalBlocks.push_back(system.matrix.find(i, i));
        system.solver = makeSolver(model.solver);
    }
    for (auto* buffer :
         {&system.forces, &system.stiffnessTimesVelocity, &system.rightHandSide, &system.x, &system.v, &system.dv})
        buffer->resize(model.rest.size());
    return system;
}

} // namespace filasofia::engine
