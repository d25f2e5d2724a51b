#include "filasofia/engine/soft/rod_system.h"

#include "filasofia/engine/integration/euler.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

std::size_t unknownOf(std::size_t node) { return 4 * node; }

void add(Vec3 v, std::size_t node, std::vector<double>& to)
{
    for (int i = 0; i < 3; ++i) to[unknownOf(node) + static_cast<std::size_t>(i)] += v[i];
}

/// The velocities of the unknowns around joint j.
RodVector velocitiesAt(const SoftState& state, std::size_t joint)
{
    RodVector out{};
    for (std::size_t k = 0; k < 3; ++k)
        for (int i = 0; i < 3; ++i)
            out[4 * k + static_cast<std::size_t>(i)] = state.v[wrapped(joint + k, state.v.size())][i];
    for (std::size_t k = 0; k < 2; ++k) out[4 * k + 3] = state.rod.spins[wrapped(joint + k, state.rod.spins.size())];
    return out;
}

double times(const RodVector& a, const RodVector& b)
{
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}

Vec3 directionOf(std::span<const Vec3> x, std::size_t edge)
{
    return normalized(x[wrapped(edge + 1, x.size())] - x[edge]);
}

} // namespace

RodSystem::RodSystem(const SoftModel& model)
    : joints_(stiffJoints(model.rod, model.pins.hard)), fixed_(4 * model.rest.size()),
      matrix_(fixed_.size(), isRing(model.rod)), forces_(fixed_.size()), stiffnessTimesVelocity_(fixed_.size()),
      rightHandSide_(fixed_.size()), spinChanges_(model.rod.edges.size()), moved_(stateAtStart(model.rod))
{
    for (std::size_t i = 0; i < model.rest.size(); ++i) {
        const bool last = i == model.rod.edges.size();
        for (std::size_t k = 0; k < 3; ++k) fixed_[unknownOf(i) + k] = model.pins.hard[i];
        fixed_[unknownOf(i) + 3] = last || clamped(model.pins.hard, i);
    }
}

void RodSystem::assemble(const SoftModel& model, std::span<const Vec3> given, double dt, double inertia,
                         const SoftState& state)
{
    const RayleighDamping damping{model.rayleigh.mass, model.rayleigh.stiffness};
    const ImplicitWeights weights = implicitWeights(dt, damping);
    directors_ = state.rod.directors;
    straighten(state.x, directors_);
    matrix_.setZero();
    std::ranges::fill(forces_, 0.0);
    std::ranges::fill(stiffnessTimesVelocity_, 0.0);
    for (std::size_t i = 0; i < given.size(); ++i) add(given[i], i, forces_);
    addEdges(model, weights.stiffness, weights.turning, state);
    addJoints(model, weights.stiffness, state);
    for (const PinSpring& pin : model.pins.springs) {
        add(pin.stiffness * state.v[static_cast<std::size_t>(pin.node)], static_cast<std::size_t>(pin.node),
            stiffnessTimesVelocity_);
        for (std::size_t k = 0; k < 3; ++k)
            matrix_.column(unknownOf(static_cast<std::size_t>(pin.node)) + k)[0] += weights.stiffness * pin.stiffness;
    }
    addMasses(model, inertia * weights.mass, state);

    for (std::size_t u = 0; u < fixed_.size(); ++u) {
        const std::size_t i = u / 4;
        const double velocity = u % 4 < 3                 ? state.v[i][static_cast<int>(u % 4)]
                                : i < spinChanges_.size() ? state.rod.spins[i]
                                                          : 0.0;
        const double mass = u % 4 < 3 ? model.masses[i] : i < spinChanges_.size() ? model.rod.inertias[i] : 0.0;
        rightHandSide_[u] = fixed_[u] ? 0.0
                                      : dt * (forces_[u] - damping.mass * mass * velocity) -
                                            weights.stiffness * stiffnessTimesVelocity_[u];
    }
    // A fixed unknown keeps its place on the diagonal only, so that all of those are of one size.
    for (std::size_t u = 0; u < fixed_.size(); ++u)
        for (std::size_t k = 1; k <= linalg::BandMatrix::kWidth && u + k < fixed_.size(); ++k)
            if (fixed_[u] || fixed_[u + k]) matrix_.column(u)[k] = 0.0;
    constexpr std::size_t corner = linalg::BandMatrix::kCorner;
    for (std::size_t r = 0; matrix_.cyclic() && r < corner; ++r)
        for (std::size_t c = 0; c < corner; ++c)
            if (fixed_[fixed_.size() - corner + r] || fixed_[c]) matrix_.corner(r, c) = 0.0;
    if (factor_.factorise(matrix_)) return;
    // Numbers beyond all bounds: the masses alone do, and the step is undone if its solution is not usable.
    matrix_.setZero();
    addMasses(model, inertia * weights.mass, state);
    factor_.factorise(matrix_);
}

void RodSystem::addEdges(const SoftModel& model, double stiffness, double turning, const SoftState& state)
{
    for (std::size_t e = 0; e < model.rod.edges.size(); ++e) {
        if (isCut(model.rod, e)) continue;
        const Spring& edge = model.rod.edges[e];
        const auto next = static_cast<std::size_t>(edge.nodes[1]);
        const Vec3 force = springForce(edge, state.x[e], state.x[next]);
        const Vec3 direction = directionOf(state.x, e);
        const Mat3 along = outer(direction, direction);
        // Tension resists turning without damping it: a taut thread swings freely. Compression is left out, so that the
        // tangent is positive semi-definite.
        const double across =
            std::max(0.0, state.rod.tensions[e]) / std::max(distance(state.x[e], state.x[next]), 1e-12);
        const Mat3 k = edge.stiffness * along + turning * across * (Mat3::identity() - along);
        const Vec3 kv = k * (state.v[e] - state.v[next]);
        add(force, e, forces_);
        add(-force, next, forces_);
        add(kv, e, stiffnessTimesVelocity_);
        add(-kv, next, stiffnessTimesVelocity_);
        const std::size_t first = unknownOf(e), second = unknownOf(next);
        for (int c = 0; c < 3; ++c)
            for (int r = 0; r < 3; ++r) {
                const double value = stiffness * k[r][c];
                const auto row = static_cast<std::size_t>(r), column = static_cast<std::size_t>(c);
                matrix_.add(second + row, first + column, -value);
                if (r < c) continue;
                matrix_.at(first + row, first + column) += value;
                matrix_.at(second + row, second + column) += value;
            }
    }
}

void RodSystem::addAroundSeam(std::size_t node, double factor, const RodVector& gradient)
{
    const std::size_t rows = fixed_.size();
    for (std::size_t c = 0; c < 11; ++c)
        for (std::size_t r = c; r < 11; ++r)
            matrix_.add(wrapped(unknownOf(node) + r, rows), wrapped(unknownOf(node) + c, rows),
                        factor * gradient[c] * gradient[r]);
}

void RodSystem::addJoints(const SoftModel& model, double stiffness, const SoftState& state)
{
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        RodPlace at = placeAt(state.rod, state.x, j);
        at.directors = {directors_[j], directors_[wrapped(j + 1, directors_.size())]};
        const auto unknown = [&](std::size_t i) { return wrapped(unknownOf(j) + i, fixed_.size()); };
        const RodJoint joint = jointNow(model.rod, joints_[j], state.rod, j);
        const RodResponse response = rodResponse(joint, at);
        const RodVector v = velocitiesAt(state, j);
        for (std::size_t i = 0; i < 11; ++i) forces_[unknown(i)] += response.forces[i];
        std::array<linalg::OuterProduct, std::tuple_size_v<RodTangent>> products;
        std::size_t count = 0;
        for (const RodTerm& term : response.tangent) {
            if (term.stiffness == 0.0) continue;
            const double rate = term.stiffness * times(term.gradient, v);
            for (std::size_t i = 0; i < 11; ++i) stiffnessTimesVelocity_[unknown(i)] += rate * term.gradient[i];
            if (unknownOf(j) + 11 > fixed_.size())
                addAroundSeam(j, stiffness * term.stiffness, term.gradient);
            else
                products[count++] = {stiffness * term.stiffness, term.gradient.data()};
        }
        // Twelve rows are within the band except for the last one against the first, which is unused.
        linalg::addOuterProducts(std::span(products).first(count), matrix_.column(unknownOf(j)));
    }
}

void RodSystem::addMasses(const SoftModel& model, double weight, const SoftState& state)
{
    for (std::size_t i = 0; i < state.x.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) matrix_.column(unknownOf(i) + k)[0] += weight * model.masses[i];
    for (std::size_t e = 0; e < model.rod.edges.size(); ++e)
        matrix_.column(unknownOf(e) + 3)[0] += weight * model.rod.inertias[e];
    if (isRing(model.rod)) return;
    const std::size_t last = fixed_.size() - 1; // the unknown without an edge is as large as that before it
    matrix_.column(last)[0] = matrix_.column(last - 4)[0];
}

void RodSystem::solve(std::span<Vec3> dv)
{
    std::vector<double> x(rightHandSide_);
    factor_.solve(x);
    take(x, dv);
}

void RodSystem::take(std::span<const double> solution, std::span<Vec3> dv)
{
    for (std::size_t i = 0; i < dv.size(); ++i)
        dv[i] = {solution[unknownOf(i)], solution[unknownOf(i) + 1], solution[unknownOf(i) + 2]};
    for (std::size_t e = 0; e < spinChanges_.size(); ++e) spinChanges_[e] = solution[unknownOf(e) + 3];
}

void RodSystem::slow(double share, const SoftState& state, std::span<Vec3> dv)
{
    for (std::size_t i = 0; i < dv.size(); ++i) dv[i] = share * (state.v[i] + dv[i]) - state.v[i];
    for (std::size_t e = 0; e < spinChanges_.size(); ++e)
        spinChanges_[e] = share * (state.rod.spins[e] + spinChanges_[e]) - state.rod.spins[e];
}

bool RodSystem::move(double dt, const SoftModel& model, const SoftState& state, std::span<const Vec3> x,
                     std::span<const Vec3> v)
{
    moved_ = state.rod;
    moved_.directors = directors_;
    for (std::size_t e = 0; e < spinChanges_.size(); ++e) {
        moved_.spins[e] += spinChanges_[e];
        if (isCut(model.rod, e)) continue;
        const Spring& edge = model.rod.edges[e];
        const auto next = static_cast<std::size_t>(edge.nodes[1]);
        const double longer = distance(state.x[e], state.x[next]) - edge.restLength;
        const double rate = dot(directionOf(state.x, e), v[next] - v[e]);
        moved_.tensions[e] = edge.stiffness * (longer + (dt + model.rayleigh.stiffness) * rate);
    }
    moveRod(dt, state.x, x, model.rod.seam, moved_, moved_);
    const auto finite = [](double each) { return std::isfinite(each); };
    return std::ranges::all_of(moved_.spins, finite) && std::ranges::all_of(moved_.tensions, finite) &&
           std::ranges::all_of(moved_.directors, [](Vec3 each) { return isFinite(each); });
}

void addRodForces(const SoftModel& model, const SoftState& state, const std::vector<bool>& wanted,
                  std::vector<Vec3>& forces)
{
    const double beta = model.rayleigh.stiffness;
    const Rod& rod = model.rod;
    for (std::size_t e = 0; e < rod.edges.size(); ++e) {
        const Spring& edge = rod.edges[e];
        const auto next = static_cast<std::size_t>(edge.nodes[1]);
        if (!(wanted[e] || wanted[next]) || isCut(rod, e)) continue;
        const Vec3 direction = directionOf(state.x, e);
        const Vec3 force = springForce(edge, state.x[e], state.x[next]) +
                           beta * edge.stiffness * dot(direction, state.v[next] - state.v[e]) * direction;
        forces[e] += force;
        forces[next] -= force;
    }
    for (std::size_t j = 0; j < rod.joints.size(); ++j) {
        const std::array<std::size_t, 3> nodes{j, wrapped(j + 1, forces.size()), wrapped(j + 2, forces.size())};
        if (std::ranges::none_of(nodes, [&](std::size_t node) { return wanted[node]; })) continue;
        const RodPlace at = placeAt(state.rod, state.x, j);
        RodResponse response = rodResponse(jointNow(rod, stiffJoint(rod, model.pins.hard, j), state.rod, j), at);
        RodVector& sum = response.forces;
        const RodVector v = velocitiesAt(state, j);
        for (const RodTerm& term : response.tangent) {
            const double rate = beta * term.stiffness * times(term.gradient, v);
            for (std::size_t i = 0; i < sum.size(); ++i) sum[i] -= rate * term.gradient[i];
        }
        for (std::size_t k = 0; k < 3; ++k) forces[nodes[k]] += Vec3{sum[4 * k], sum[4 * k + 1], sum[4 * k + 2]};
    }
}

} // namespace filasofia::engine
