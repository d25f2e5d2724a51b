#include "filasofia/engine/body/each_body.h"
#include "filasofia/engine/topology/loose_pieces.h"
#include "filasofia/engine/step/solve_limits.h"
#include "filasofia/engine/step/stages.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <span>
#include <utility>

namespace filasofia::engine {
namespace {

using physics::StepFlag;

// A step that blew up is made again from rest, as if the body were so many times as heavy: it creeps towards where
// the forces pull, and cannot gather speed.
constexpr double kCreep = 100.0;

constexpr double kMostTurn = 0.25; // [rad] of a loose piece in a step, as much as one of first order follows

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

/// Per node, whether it takes part in a contact or an attachment.
std::vector<char> linkedNodes(std::size_t body, std::size_t nodes, const std::vector<Link>& links)
{
    std::vector<char> linked(nodes);
    for (const Link& link : links)
        for (const BodyPoint& point : link.sides)
            if (point.of == BodyPoint::Of::Soft && point.body == body)
                for (int k = 0; k < point.count; ++k) linked[static_cast<std::size_t>(point.nodes[k])] = 1;
    return linked;
}

/// What a solve left undone of crumbs is done, where it is known. Those that touch something were solved with it.
void finishPieces(const SoftModel& model, std::size_t body, double dt, const std::vector<Link>& links,
                  const SoftState& state, SoftSystem& system)
{
    const auto isCrumb = [](const BodyPiece& piece) { return !piece.elements.empty(); };
    if (std::ranges::none_of(model.pieces, isCrumb) || !system.matrixFree || model.elements.empty() ||
        !std::holds_alternative<physics::ImplicitEuler>(model.integrator))
        return;
    const ImplicitWeights weights = implicitWeights(dt, {model.rayleigh.mass, model.rayleigh.stiffness});
    const auto solved = [&](int node) {
        return NodeSolve{system.matrixFree->solved(node), system.matrixFree->undone(node)};
    };
    finishCrumbs(model, weights, state, linkedNodes(body, model.rest.size(), links), solved, system.dv,
                 system.leftover);
}

/// The impulses that a body was put back for are not where its next step is to start.
void forget(std::size_t body, std::vector<Link>& links)
{
    for (Link& link : links)
        for (const BodyPoint& point : link.sides)
            if (point.of == BodyPoint::Of::Soft && point.body == body) link.next = {};
}

struct BodyOutcome {
    physics::BodySolve solve;
    std::uint32_t flags = 0;
    void set(StepFlag flag) { flags |= static_cast<std::uint32_t>(flag); }
    [[nodiscard]] bool has(StepFlag flag) const { return (flags & static_cast<std::uint32_t>(flag)) != 0; }
};

/// Moves a body by what was solved; where that is no state to go on with it is put back, and creeps.
void settleBody(const SoftModel& model, Vec3 gravity, double dt, SoftSystem& system, SoftState& state, WorkerPool& pool,
                BodyOutcome& outcome)
{
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
        slowSpin(model, kMostTurn, dt, state);
    }
}

BodyOutcome outcomeOf(BodyId id, const linalg::NodeSolveReport& solve)
{
    BodyOutcome outcome;
    outcome.solve = {id, solve.iterations, solve.residual};
    if (solve.outOfTime) outcome.set(StepFlag::OutOfTime);
    if (!solve.converged && !solve.outOfTime) outcome.set(StepFlag::NotConverged);
    return outcome;
}

/// Where the body's solve starts from.
void prepareBody(const SoftState& state, SoftSystem& system)
{
    system.dv = state.dv;
    std::fill(system.leftover.begin(), system.leftover.end(), Vec3{}); // only the default solver leaves something
}

/// Soft bodies follow from step to step what they lack, and stiffer contacts only cost iterations: measured, 18 for 3,
/// 22 for 5 and 35 for 10 where 110 stand on 30000 elements. But their nodes must hold all that moves with them:
/// against its mass they are the lighter the finer the mesh is, by the root of the third order of the number of nodes
/// (there are fewer of them by that). A plate drawn slowly over 6500 nodes began to swing below 3.7.
double softStiffening(const Model& model, const Island& island)
{
    constexpr double perNodes = 0.27, least = 3.0, most = 10.0;
    std::size_t nodes = 0;
    for (std::size_t b : island.soft) nodes = std::max(nodes, model.softBodies[b].rest.size());
    return std::clamp(perNodes * std::cbrt(static_cast<double>(nodes)), least, most);
}

CoupledLimits limitsOf(const Model& model, const Island& island, const physics::ContactMethod& method, double dt,
                       const linalg::SolveLimits& limits)
{
    // Rigid bodies in a tower sway as one, with more inertia than each has by itself. And for so few unknowns it costs
    // nothing to be exact.
    constexpr double rigidStiffening = 100.0, rigidHolding = 1000.0; // friction does not bear more
    // Where a heavy body rests on a light one, what pushes gives as the light one does, and what sways weighs as the
    // heavy one.
    constexpr double rigidBearing = 1.0;
    constexpr int perRound = 40, rigidRaises = 10;
    constexpr double rigidTolerance = 0.01;
    constexpr double smallAcceleration = 1.0; // [m/s^2] what nothing in particular does to a body, for a scale

    CoupledLimits how{.linear = limits, .smallChange = smallAcceleration * dt};
    if (const auto* exact = std::get_if<physics::ExactContact>(&method)) {
        how.following = perRound * exact->rounds;
        how.tolerance = exact->tolerance;
    }
    if (island.rigid.empty()) how.stiffening = softStiffening(model, island);
    if (island.soft.empty()) {
        how.stiffening = rigidStiffening;
        how.holding = rigidHolding;
        how.bearing = rigidBearing;
        how.raises = rigidRaises;
        how.tolerance *= rigidTolerance;
    }
    return how;
}

} // namespace

void advance(const Model& model, double dt, const physics::StepBudget* budget, const physics::ContactMethod& method,
             Systems& systems, Coupling& coupling, State& state, WorkerPool& pool, physics::StepReport& report)
{
    if (dt > 0.0) {
        std::vector<BodyOutcome> outcomes(model.softBodies.size());
        std::vector<bool> coupled(model.softBodies.size());
        std::vector<BodyOutcome> rigidOutcomes; // of islands without a soft body
        const std::vector<Island> islands = findIslands(model, coupling.rigid, coupling.links);
        const StepLimits limits = limitsOf(model, islands, budget, pool);
        const auto settle = [&](std::size_t b) {
            finishPieces(model.softBodies[b], b, dt, coupling.links, state.softBodies[b], systems[b]);
            settleBody(model.softBodies[b], state.gravity, dt, systems[b], state.softBodies[b], pool, outcomes[b]);
        };

        for (std::size_t i = 0; i < islands.size(); ++i) {
            const Island& island = islands[i];
            for (std::size_t b : island.soft) {
                prepareBody(state.softBodies[b], systems[b]);
                coupled[b] = true;
            }
            const CoupledLimits how = limitsOf(model, island, method, dt, limits.islands[i]);
            const CoupledReport solve = solveIsland(model, state, dt, island, how, systems, coupling.rigid,
                                                    coupling.articulations, coupling.links, coupling.scratch, pool);
            for (std::size_t b : island.soft) {
                outcomes[b] = outcomeOf(model.softBodies[b].id, solve);
                settle(b);
                if (outcomes[b].has(StepFlag::Undone)) forget(b, coupling.links);
            }
            if (island.soft.empty())
                rigidOutcomes.push_back(outcomeOf(model.rigidBodies[coupling.rigid[island.rigid[0]].body].id, solve));
            report.contacts.rounds = std::max(report.contacts.rounds, solve.rounds);
            report.contacts.mismatch = std::max(report.contacts.mismatch, solve.mismatch);
        }
        forEachBody(model, pool, [&](std::size_t b) { // each of the others by itself
            if (coupled[b]) return;
            const SoftModel& body = model.softBodies[b];
            prepareBody(state.softBodies[b], systems[b]);
            const linalg::NodeSolveReport solve =
                solveBody(body, dt, 1.0, limits.bodies[b], state.softBodies[b].v, systems[b], pool);
            outcomes[b] = outcomeOf(body.id, solve);
            settle(b);
        });
        outcomes.insert(outcomes.end(), rigidOutcomes.begin(), rigidOutcomes.end());
        for (const BodyOutcome& outcome : outcomes) {
            report.solves.push_back(outcome.solve);
            report.flags |= outcome.flags;
        }
        state.time += dt;
        ++state.step;
    }
    moveRigid(model, dt, coupling.rigid, state, report);
    moveArticulations(model, dt, coupling.articulations, coupling.rigid, state, report);
    report.step = state.step;
    report.time = state.time;
}

} // namespace filasofia::engine
