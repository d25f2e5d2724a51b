#include "filasofia/engine/each_body.h"
#include "filasofia/engine/stages.h"

#include <algorithm>
#include <atomic>
#include <span>

namespace filasofia::engine {
namespace {

using physics::StepFlag;

// A step that blew up is made again from rest, as if the body were so many times as heavy: it creeps towards where
// the forces pull, and cannot gather speed.
constexpr double kCreep = 100.0;

linalg::SolveLimits limitsOf(const SoftModel& model)
{
    const auto* cg = std::get_if<physics::ConjugateGradient>(&model.solver);
    if (!cg) return {};
    return {.tolerance = cg->tolerance, .maxIterations = cg->maxIterations, .minIterations = cg->minIterations};
}

/// When each body's solver must end [ns], so that the bodies that come first leave time for those that come last: by
/// its share of all that is to be done before it and by it.
std::vector<std::int64_t> deadlines(const Model& model, const physics::StepBudget& budget, const WorkerPool& pool)
{
    const std::int64_t start = budget.now();
    const auto left = static_cast<double>(std::max<std::int64_t>(0, budget.deadline - start));
    const std::size_t limit = sharedBeyond(model, pool);
    double total = 0.0, done = 0.0; // side by side, small bodies take a thread each
    const auto weight = [&](const SoftModel& body) {
        return static_cast<double>(sizeOf(body)) / (sizeOf(body) > limit ? 1.0 : pool.threads());
    };
    for (const SoftModel& body : model.softBodies) total += weight(body);
    std::vector<std::int64_t> ends(model.softBodies.size());
    for (const bool large : {true, false}) // in the order of forEachBody
        for (std::size_t b = 0; b < ends.size(); ++b) {
            if ((sizeOf(model.softBodies[b]) > limit) != large) continue;
            done += weight(model.softBodies[b]);
            ends[b] = start + static_cast<std::int64_t>(left * (total > 0.0 ? std::min(1.0, done / total) : 1.0));
        }
    return ends;
}

/// The limits of every body's solver under a budget: a deadline, or the iterations made when the step was made first.
std::vector<linalg::SolveLimits> limitsOf(const Model& model, const physics::StepBudget* budget, const WorkerPool& pool)
{
    std::vector<linalg::SolveLimits> limits;
    for (const SoftModel& body : model.softBodies) limits.push_back(limitsOf(body));
    if (!budget) return limits;
    const bool again = budget->iterations.size() == limits.size();
    const bool hurried = !again && budget->now && budget->deadline != physics::StepBudget{}.deadline;
    const std::vector<std::int64_t> ends = hurried ? deadlines(model, *budget, pool) : std::vector<std::int64_t>();
    for (std::size_t b = 0; b < limits.size(); ++b) {
        if (again) limits[b].stopAt = budget->iterations[b];
        if (hurried) limits[b].outOfTime = [budget, end = ends[b]] { return budget->now() >= end; };
    }
    return limits;
}

/// What the velocities change by.
linalg::NodeSolveReport solveBody(const SoftModel& model, double dt, double inertia, const linalg::SolveLimits& limits,
                                  std::span<const Vec3> v, SoftSystem& system, WorkerPool& pool)
{
    if (system.assembled) return {solve(model, dt, inertia, v, *system.assembled, system.dv)};
    if (std::holds_alternative<physics::ImplicitEuler>(model.integrator))
        return system.matrixFree->solve(limits, system.dv, system.leftover, pool);
    system.matrixFree->solveExplicit(system.dv);
    return {};
}

/// The new state from the change of the velocities; false where it is not one to go on with.
bool moveBody(const SoftModel& model, double dt, const SoftState& state, SoftSystem& system, WorkerPool& pool)
{
    const auto* explicitEuler = std::get_if<physics::ExplicitEuler>(&model.integrator);
    const bool withOld = explicitEuler && !explicitEuler->symplectic;
    const linalg::Parts parts{static_cast<int>(state.x.size()), 512};
    std::atomic<bool> good = true;
    pool.run(parts.count(), [&](int part) {
        const auto first = static_cast<std::size_t>(parts[part].begin), end = static_cast<std::size_t>(parts[part].end);
        const auto nodes = [&](auto& list) { return std::span(list).subspan(first, end - first); };
        const std::span<Vec3> x = nodes(system.x), v = nodes(system.v);
        std::ranges::copy(nodes(state.x), x.begin());
        std::ranges::copy(nodes(state.v), v.begin());
        move(dt, withOld, nodes(system.dv), x, v);
        if (!usable(x) || !usable(v) ||
            !std::ranges::all_of(nodes(system.leftover), [](Vec3 l) { return isFinite(l); }))
            good = false;
    });
    return good;
}

struct BodyOutcome {
    physics::BodySolve solve;
    std::uint32_t flags = 0;
    void set(StepFlag flag) { flags |= static_cast<std::uint32_t>(flag); }
};

BodyOutcome advanceBody(const SoftModel& model, Vec3 gravity, double dt, const linalg::SolveLimits& limits,
                        SoftSystem& system, SoftState& state, WorkerPool& pool)
{
    BodyOutcome outcome;
    system.dv = state.dv;
    std::fill(system.leftover.begin(), system.leftover.end(), Vec3{}); // only the default solver leaves something
    const linalg::NodeSolveReport solve = solveBody(model, dt, 1.0, limits, state.v, system, pool);
    outcome.solve = {model.id, solve.iterations, solve.residual};
    if (solve.outOfTime) outcome.set(StepFlag::OutOfTime);
    if (!solve.converged && !solve.outOfTime) outcome.set(StepFlag::NotConverged);

    bool good = moveBody(model, dt, state, system, pool);
    if (!good) { // stay where it was, forget the motion that led here, and creep
        for (auto* list : {&state.v, &state.dv, &state.leftover}) std::fill(list->begin(), list->end(), Vec3{});
        assembleBody(model, gravity, dt, kCreep, state, system, pool);
        system.dv = state.dv;
        solveBody(model, dt, kCreep, limitsOf(model), state.v, system, pool);
        std::fill(system.leftover.begin(), system.leftover.end(), Vec3{}); // a heavier body's: nothing to make up for
        good = moveBody(model, dt, state, system, pool);
        outcome.set(StepFlag::Undone);
        if (good) outcome.set(StepFlag::Damped);
    }
    if (good) {
        std::swap(system.x, state.x);
        std::swap(system.v, state.v);
        std::swap(system.dv, state.dv);
        std::swap(system.leftover, state.leftover);
    }
    return outcome;
}

} // namespace

void advance(const Model& model, double dt, const physics::StepBudget* budget, Systems& systems, State& state,
             WorkerPool& pool, physics::StepReport& report)
{
    if (dt > 0.0) {
        std::vector<BodyOutcome> outcomes(model.softBodies.size());
        const std::vector<linalg::SolveLimits> limits = limitsOf(model, budget, pool);
        forEachBody(model, pool, [&](std::size_t b) {
            outcomes[b] =
                advanceBody(model.softBodies[b], state.gravity, dt, limits[b], systems[b], state.softBodies[b], pool);
        });
        for (const BodyOutcome& outcome : outcomes) {
            report.solves.push_back(outcome.solve);
            report.flags |= outcome.flags;
        }
        state.time += dt;
        ++state.step;
    }
    report.step = state.step;
    report.time = state.time;
}

} // namespace filasofia::engine
