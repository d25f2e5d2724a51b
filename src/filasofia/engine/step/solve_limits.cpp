#include "filasofia/engine/step/solve_limits.h"

#include "filasofia/engine/body/each_body.h"

#include <algorithm>

namespace filasofia::engine {

linalg::SolveLimits limitsOf(const SoftModel& model)
{
    const auto* cg = std::get_if<physics::ConjugateGradient>(&model.solver);
    if (!cg) return {};
    return {.tolerance = cg->tolerance, .maxIterations = cg->maxIterations, .minIterations = cg->minIterations};
}

namespace {

// Rigid bodies and direct solvers are exact, as far as nobody beside them is not.
constexpr double kExact = 1e-7;
constexpr int kRigidIterations = 1000;
// What bodies do to each other takes some iterations to be found. Cut short before, contacts throw bodies about:
// measured, a held polyp and a scope in a canal, every step cut short: with 4, 12 and 24 iterations hundreds of
// newtons, with 40 about as many as with enough.
constexpr int kCoupledIterations = 40;

/// The first to end ends them all; they share what iterations they have.
linalg::SolveLimits limitsOf(const Model& model, const Island& island)
{
    if (island.soft.empty())
        return {.tolerance = kExact, .maxIterations = kRigidIterations, .minIterations = kCoupledIterations};
    linalg::SolveLimits shared{.tolerance = 1.0, .maxIterations = 0};
    for (std::size_t b : island.soft) {
        const linalg::SolveLimits limits = limitsOf(model.softBodies[b]);
        if (std::holds_alternative<physics::ConjugateGradient>(model.softBodies[b].solver))
            shared.tolerance = std::min(shared.tolerance, limits.tolerance);
        shared.maxIterations = std::max(shared.maxIterations, limits.maxIterations);
        shared.minIterations = std::max(shared.minIterations, limits.minIterations);
    }
    if (shared.tolerance == 1.0) shared.tolerance = kExact;
    shared.minIterations = std::max(shared.minIterations, kCoupledIterations);
    return shared;
}

/// How much a solve computes, in elements of a soft body.
double sizeOf(const Model& model, const Island& island)
{
    double size = static_cast<double>(island.rigid.size() + island.links.size());
    for (std::size_t b : island.soft) size += static_cast<double>(sizeOf(model.softBodies[b]));
    return size;
}

/// When each solve must end [ns], by its share of all that is to be done before it and by it, in the order in which
/// advance() makes them: islands, then large bodies, then small ones side by side, a thread each.
class Deadlines {
public:
    Deadlines(const physics::StepBudget& budget, double total)
        : budget_(budget), start_(budget.now()),
          left_(static_cast<double>(std::max<std::int64_t>(0, budget.deadline - start_))), total_(total)
    {
    }
    std::function<bool()> after(double size)
    {
        done_ += size;
        const double share = total_ > 0.0 ? std::min(1.0, done_ / total_) : 1.0;
        return [&budget = budget_, end = start_ + static_cast<std::int64_t>(left_ * share)] {
            return budget.now() >= end;
        };
    }

private:
    const physics::StepBudget& budget_;
    std::int64_t start_;
    double left_, total_, done_ = 0.0;
};

void setDeadlines(const Model& model, std::span<const Island> islands, const physics::StepBudget& budget,
                  const WorkerPool& pool, StepLimits& limits)
{
    std::vector<bool> coupled(model.softBodies.size());
    double total = 0.0;
    for (const Island& island : islands) {
        total += sizeOf(model, island);
        for (std::size_t b : island.soft) coupled[b] = true;
    }
    const std::size_t limit = sharedBeyond(model, pool);
    const auto size = [&](std::size_t b) {
        const std::size_t count = sizeOf(model.softBodies[b]);
        return static_cast<double>(count) / (count > limit ? 1.0 : pool.threads());
    };
    for (std::size_t b = 0; b < coupled.size(); ++b) total += coupled[b] ? 0.0 : size(b);

    Deadlines deadlines(budget, total);
    for (std::size_t i = 0; i < islands.size(); ++i)
        limits.islands[i].outOfTime = deadlines.after(sizeOf(model, islands[i]));
    for (const bool large : {true, false}) // in the order of forEachBody
        for (std::size_t b = 0; b < coupled.size(); ++b)
            if (!coupled[b] && (sizeOf(model.softBodies[b]) > limit) == large)
                limits.bodies[b].outOfTime = deadlines.after(size(b));
}

/// Everyone stops where it stopped then: soft bodies by their places, then the islands without one by theirs.
void setIterations(std::span<const Island> islands, std::span<const int> iterations, StepLimits& limits)
{
    for (std::size_t b = 0; b < limits.bodies.size(); ++b) limits.bodies[b].stopAt = iterations[b];
    std::size_t next = limits.bodies.size();
    for (std::size_t i = 0; i < islands.size(); ++i) {
        if (!islands[i].soft.empty())
            limits.islands[i].stopAt = iterations[islands[i].soft.front()]; // all of an island made the same
        else if (next < iterations.size())
            limits.islands[i].stopAt = iterations[next++];
    }
}

} // namespace

StepLimits limitsOf(const Model& model, std::span<const Island> islands, const physics::StepBudget* budget,
                    const WorkerPool& pool)
{
    StepLimits limits;
    for (const Island& island : islands) limits.islands.push_back(limitsOf(model, island));
    for (const SoftModel& body : model.softBodies) limits.bodies.push_back(limitsOf(body));
    if (!budget) return limits;
    if (!budget->iterations.empty() && budget->iterations.size() >= limits.bodies.size())
        setIterations(islands, budget->iterations, limits);
    else if (budget->now && budget->deadline != physics::StepBudget{}.deadline)
        setDeadlines(model, islands, *budget, pool, limits);
    return limits;
}

} // namespace filasofia::engine
