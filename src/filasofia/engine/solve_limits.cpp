#include "filasofia/engine/solve_limits.h"

#include "filasofia/engine/each_body.h"

#include <algorithm>

namespace filasofia::engine {

linalg::SolveLimits limitsOf(const SoftModel& model)
{
    const auto* cg = std::get_if<physics::ConjugateGradient>(&model.solver);
    if (!cg) return {};
    return {.tolerance = cg->tolerance, .maxIterations = cg->maxIterations, .minIterations = cg->minIterations};
}

namespace {

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

} // namespace

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

} // namespace filasofia::engine
