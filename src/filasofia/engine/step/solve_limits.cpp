#include "filasofia/engine/step/solve_limits.h"

#include "filasofia/engine/scene/each_body.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {

linalg::SolveLimits limitsOf(const SoftModel& model)
{
    const auto* cg = std::get_if<physics::ConjugateGradient>(&model.solver);
    if (!cg) return {};
    return {.tolerance = cg->tolerance, .maxIterations = cg->maxIterations, .minIterations = cg->minIterations};
}

namespace {

// [-] Tolerance for rigid bodies and direct solvers, if no iterative solver in their island asks for less. Where rods
// touch, friction converges by a factor of two to three per iteration, so they have one of their own: a needle with its
// thread, held by jaws, takes 6 iterations in place of 12.
constexpr double kExact = 1e-7, kRods = 1e-4;
// [m/s^2] Accelerations that do not matter: errors are relative to at least the energy of the velocities that they give
// in a step. At rest, the change of velocities is rounding noise: at 1 kHz, a block of 50 kPa took 12 iterations a step
// to solve for 0.2 um/s; with this it takes 2. Times the default tolerance, it is a twenty-thousandth of a body's
// weight, and a two-thousandth in contact, where what pushes converges apart.
constexpr double kSmallAlone = 0.1, kSmallTogether = 1.0;
constexpr int kRigidIterations = 1000;
// The contact impulses take some iterations to converge. If a solve is cut short before, contacts throw bodies about.
// Measured with an attached polyp and a scope in a canal, every step cut short: hundreds of newtons with 4, 12 and 24
// iterations; with 40 iterations about the same force as when converged.
constexpr int kCoupledIterations = 40;

/// Whether all soft bodies of an island are rods, and there is one.
bool onlyRods(const Scene& scene, const Island& island)
{
    const auto rod = [&](std::size_t b) { return isRod(scene.soft[b].model); };
    return !island.soft.empty() && std::ranges::all_of(island.soft, rod);
}

/// The limits of a solve that several bodies share: the smallest tolerance and the largest numbers of iterations.
linalg::SolveLimits limitsOf(const Scene& scene, const Island& island)
{
    if (island.soft.empty())
        return {.tolerance = kExact, .maxIterations = kRigidIterations, .minIterations = kCoupledIterations};
    linalg::SolveLimits shared{.tolerance = 1.0, .maxIterations = 0};
    for (std::size_t b : island.soft) {
        const linalg::SolveLimits limits = limitsOf(scene.soft[b].model);
        if (std::holds_alternative<physics::ConjugateGradient>(scene.soft[b].model.solver))
            shared.tolerance = std::min(shared.tolerance, limits.tolerance);
        shared.maxIterations = std::max(shared.maxIterations, limits.maxIterations);
        shared.minIterations = std::max(shared.minIterations, limits.minIterations);
    }
    if (shared.tolerance == 1.0) shared.tolerance = onlyRods(scene, island) ? kRods : kExact;
    shared.minIterations = std::max(shared.minIterations, kCoupledIterations);
    return shared;
}

/// The cost of a solve, in elements of a soft body.
double sizeOf(const Scene& scene, const Island& island)
{
    double size = static_cast<double>(island.rigid.size() + island.constraints.size());
    for (std::size_t b : island.soft) size += static_cast<double>(sizeOf(scene.soft[b].model));
    return size;
}

/// When each solve must end [ns]: the time left for the step times the fraction of the total size that is done when it
/// ends. Solves follow in the order of advance(): islands, then large bodies, then small ones in parallel, one thread
/// each.
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

void setDeadlines(const Scene& scene, std::span<const Island> islands, const physics::StepBudget& budget,
                  const WorkerPool& pool, StepLimits& limits)
{
    std::vector<bool> coupled(scene.soft.size());
    double total = 0.0;
    for (const Island& island : islands) {
        total += sizeOf(scene, island);
        for (std::size_t b : island.soft) coupled[b] = true;
    }
    const std::size_t limit = sharedBeyond(scene, pool);
    const auto size = [&](std::size_t b) {
        const std::size_t count = sizeOf(scene.soft[b].model);
        return static_cast<double>(count) / (count > limit ? 1.0 : pool.threads());
    };
    for (std::size_t b = 0; b < coupled.size(); ++b) total += coupled[b] ? 0.0 : size(b);

    Deadlines deadlines(budget, total);
    for (std::size_t i = 0; i < islands.size(); ++i)
        limits.islands[i].outOfTime = deadlines.after(sizeOf(scene, islands[i]));
    for (const bool large : {true, false}) // in the order of forEachBody()
        for (std::size_t b = 0; b < coupled.size(); ++b)
            if (!coupled[b] && (sizeOf(scene.soft[b].model) > limit) == large)
                limits.bodies[b].outOfTime = deadlines.after(size(b));
}

/// Every solve ends after the recorded number of iterations. `iterations`: per soft body, then per island without a
/// soft body.
void setIterations(std::span<const Island> islands, std::span<const int> iterations, StepLimits& limits)
{
    for (std::size_t b = 0; b < limits.bodies.size(); ++b) limits.bodies[b].stopAt = iterations[b];
    std::size_t next = limits.bodies.size();
    for (std::size_t i = 0; i < islands.size(); ++i) {
        if (!islands[i].soft.empty())
            limits.islands[i].stopAt = iterations[islands[i].soft.front()]; // the same for all bodies of an island
        else if (next < iterations.size())
            limits.islands[i].stopAt = iterations[next++];
    }
}

/// [-] The penalty factor kappa for islands without rigid bodies. Soft bodies correct their contact errors over the
/// next steps, and stiffer contacts only cost iterations: measured with 110 contacts on 30000 elements, 18 iterations
/// for kappa = 3, 22 for 5 and 35 for 10. But the contact nodes must bear all of the mass that moves with them. The
/// finer the mesh, the lighter they are beside that mass: the factor grows with the cube root of the number of nodes,
/// as the share of nodes on the surface falls with it. A plate drawn slowly over 6500 nodes began to oscillate
/// below 3.7.
double softStiffening(const Scene& scene, const Island& island)
{
    constexpr double perNodes = 0.27, lowest = 3.0, highest = 10.0;
    std::size_t nodes = 0;
    for (std::size_t b : island.soft) nodes = std::max(nodes, scene.soft[b].model.rest.size());
    return std::clamp(perNodes * std::cbrt(static_cast<double>(nodes)), lowest, highest);
}

} // namespace

CoupledLimits coupledLimitsOf(const StepContext& context, const Scene& scene, const Island& island,
                              const linalg::SolveLimits& limits)
{
    // Rigid bodies in a tower sway as one body with more inertia than each has by itself: their penalties must be
    // larger than that. They may be, as the filter of all constraints together makes no iterations of them.
    constexpr double rigidHolding = 1000.0; // friction does not bear more
    // If a heavy body rests on a light one, the compliance of the contact is that of the light body, but the mass that
    // sways is that of the heavy one: the penalty is at least this times the heaviest mass.
    constexpr double rigidBearing = 1.0;
    // With rods the filter is exact, too, between them and rigid bodies. Measured on a thread that is drawn over a
    // cylinder: 10 leaves steps in which friction does not converge, from 100 on the corners of the cylinder's polygon
    // are felt. A thread in tissue that is tied to a needle: 147 iterations if the knot is held with 10, 24 with 1000.
    constexpr double rodStiffening = 30.0;
    constexpr int perRound = 40, rigidUpdates = 10;
    constexpr double rigidTolerance = 0.01;

    CoupledLimits how{.linear = limits, .exactKappa = {rodStiffening, rigidHolding}};
    how.linear.smallAnswer = kSmallTogether * context.dt;
    if (const auto* exact = std::get_if<physics::ExactContact>(&context.method)) {
        how.nonlinear = perRound * exact->rounds;
        how.tolerance = exact->tolerance;
    }
    if (onlyRods(scene, island)) {
        how.multiplierUpdates = rigidUpdates;
    } else if (island.rigid.empty()) {
        how.kappa.contact = softStiffening(scene, island);
    }
    if (island.soft.empty()) {
        how.exactKappa.contact = kRigidKappa;
        how.bearing = rigidBearing;
        how.multiplierUpdates = rigidUpdates;
        how.tolerance *= rigidTolerance;
        how.sweeps = true;
    }
    return how;
}

StepLimits limitsOf(const StepContext& context, const Scene& scene, std::span<const Island> islands)
{
    StepLimits limits;
    for (const Island& island : islands) limits.islands.push_back(limitsOf(scene, island));
    for (const SoftBody& body : scene.soft) {
        limits.bodies.push_back(limitsOf(body.model));
        limits.bodies.back().smallAnswer = kSmallAlone * context.dt;
    }
    const physics::StepBudget* budget = context.budget;
    if (!budget) return limits;
    if (!budget->iterations.empty() && budget->iterations.size() >= limits.bodies.size())
        setIterations(islands, budget->iterations, limits);
    else if (budget->now && budget->deadline != physics::StepBudget{}.deadline)
        setDeadlines(scene, islands, *budget, context.pool, limits);
    return limits;
}

} // namespace filasofia::engine
