#include "filasofia/engine/step/advance.h"

#include "filasofia/engine/body/usable.h"
#include "filasofia/engine/contact/find_contacts.h"
#include "filasofia/engine/contact/fragment_solves.h"
#include "filasofia/engine/contact/keep_shells_apart.h"
#include "filasofia/engine/contact/rigid_passes.h"
#include "filasofia/engine/contact/solve_island.h"
#include "filasofia/engine/contact/turning_attachments.h"
#include "filasofia/engine/piercing/channels.h"
#include "filasofia/engine/scene/each_body.h"
#include "filasofia/engine/step/assemble.h"
#include "filasofia/engine/step/solve_limits.h"
#include "filasofia/engine/topology/loose_pieces.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <span>
#include <tuple>
#include <utility>

namespace filasofia::engine {
namespace {

using physics::StepFlag;

// [-] If a step blows up, it is repeated from rest with the masses multiplied by this: the body creeps towards
// equilibrium and cannot gain speed.
constexpr double kCreep = 100.0;

// [rad] Largest rotation of a loose piece in a step: a first-order step cannot follow faster ones.
constexpr double kMaxTurn = 0.25;

/// Computes the change of the velocities.
linalg::NodeSolveReport solveBody(double dt, double inertia, const linalg::SolveLimits& limits, SoftBody& body,
                                  WorkerPool& pool)
{
    SoftSystem& system = body.system;
    if (system.rod) {
        system.rod->solve(system.dv);
        return {};
    }
    if (system.assembled) return {solve(body.model, dt, inertia, body.state.v, *system.assembled, system.dv)};
    if (std::holds_alternative<physics::ImplicitEuler>(body.model.integrator))
        return system.matrixFree->solve(limits, body.state.iterations, system.dv, system.residual, pool);
    system.matrixFree->solveExplicit(system.dv);
    return {};
}

/// Computes the new state from the change of the velocities; false if the new state is not usable.
bool moveBody(double dt, SoftBody& body, WorkerPool& pool)
{
    const SoftState& state = body.state;
    SoftSystem& system = body.system;
    const auto* explicitEuler = std::get_if<physics::ExplicitEuler>(&body.model.integrator);
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
            !std::ranges::all_of(nodes(system.residual), [](Vec3 l) { return isFinite(l); }))
            good = false;
    });
    return good && (!system.rod || system.rod->move(dt, body.model, state, system.x, system.v));
}

/// Clears the warm start of the constraints on a body that was rolled back.
void clearWarmStart(std::size_t body, std::vector<Constraint>& constraints)
{
    for (Constraint& each : constraints)
        for (const BodyPoint& point : each.sides)
            if ((point.of == BodyPoint::Of::Soft || point.of == BodyPoint::Of::RodEdge) && point.body == body)
                each.multiplier = {};
}

/// How the solve of a body ended.
struct BodyOutcome {
    physics::BodySolve solve;
    std::uint32_t flags = 0;
    void set(StepFlag flag) { flags |= static_cast<std::uint32_t>(flag); }
    [[nodiscard]] bool has(StepFlag flag) const { return (flags & static_cast<std::uint32_t>(flag)) != 0; }
};

/// Moves a body by the solved change of velocities. If the new state is not usable, the body is rolled back and its
/// step is repeated with kCreep times its mass.
void settleBody(const StepContext& context, const Scene& scene, SoftBody& body, BodyOutcome& outcome)
{
    const double dt = context.dt;
    SoftState& state = body.state;
    SoftSystem& system = body.system;
    bool good = moveBody(dt, body, context.pool);
    if (!good) { // roll back, clear velocities, and creep
        for (auto* list : {&state.v, &state.dv, &state.residual}) std::fill(list->begin(), list->end(), Vec3{});
        for (auto* list : {&state.rod.spins, &state.rod.tensions}) std::ranges::fill(*list, 0.0);
        assembleBody({scene.gravity, dt, kCreep, reducedForces(dt, body, scene)}, body, context.pool);
        system.dv = state.dv;
        solveBody(dt, kCreep, limitsOf(body.model), body, context.pool);
        // The residual of the heavier body must not be handed on to the real one.
        std::fill(system.residual.begin(), system.residual.end(), Vec3{});
        good = moveBody(dt, body, context.pool);
        outcome.set(StepFlag::Undone);
        if (good) outcome.set(StepFlag::Damped);
    }
    if (good) {
        std::swap(system.x, state.x);
        std::swap(system.v, state.v);
        std::swap(system.dv, state.dv);
        std::swap(system.residual, state.residual);
        if (system.rod) std::swap(system.rod->moved(), state.rod);
        state.unrelaxed = dt;
        state.iterations = outcome.solve.iterations;
        limitSpin(body.model, kMaxTurn, dt, state);
    }
}

/// `together`: the first of the bodies that were solved together.
BodyOutcome outcomeOf(BodyId id, BodyId together, const linalg::NodeSolveReport& solve)
{
    BodyOutcome outcome;
    outcome.solve = {id, solve.iterations, solve.residual, together};
    if (solve.outOfTime) outcome.set(StepFlag::OutOfTime);
    if (!solve.converged && !solve.outOfTime) outcome.set(StepFlag::NotConverged);
    return outcome;
}

// Solves of a step that are repeated because rods would pass through something. If lines still would, their rods end
// the step with half of their velocity, again and again, and at last with none.
constexpr int kRepeats = 40;
constexpr std::size_t kSlower = 12;
// Solves that are repeated because a rigid body turns otherwise than foreseen, each but the first one with half of the
// difference: a needle of some milligrams turned by 1.5 rad, 0.1, 1.3 and 0.1 in turns, and left its thread behind.
constexpr int kTurns = 8;
constexpr double kTurnShare = 0.5;

/// Solves the bodies of the scene, coupled ones island by island, and moves the soft bodies.
class Advance {
public:
    Advance(const StepContext& context, Scene& scene, Coupling& coupling)
        : context_(context), scene_(scene), coupling_(coupling), outcomes_(scene.soft.size()),
          coupled_(scene.soft.size())
    {
    }

    void solve()
    {
        const bool mayPass = std::ranges::any_of(
            scene_.soft, [](const SoftBody& body) { return isRod(body.model) && !body.model.collision.empty(); });
        if (mayPass || coupling_.weldCount > 0) keepStart();
        solveAll(context_);
        followTurns();
        if (mayPass) keepLinesApart();
        if (inTime())
            for (std::size_t held : heldElsewhere(context_.dt, coupling_)) outcomes_[held].set(StepFlag::NotConverged);
        for (std::size_t held : keepShellsApart(context_, scene_, coupling_))
            outcomes_[held].set(StepFlag::NotConverged);
    }

    void settle()
    {
        forEachBody(scene_, context_.pool,
                    [&](SoftBody& body, std::size_t b) { settleBody(context_, scene_, body, outcomes_[b]); });
        for (std::size_t b = 0; b < outcomes_.size(); ++b)
            if (outcomes_[b].has(StepFlag::Undone)) clearWarmStart(b, coupling_.constraints);
    }

    void reportSolves() const
    {
        for (const auto* list : {&outcomes_, &rigidOutcomes_})
            for (const BodyOutcome& outcome : *list) {
                context_.report.solves.push_back(outcome.solve);
                context_.report.flags |= outcome.flags;
                if (outcome.has(StepFlag::Undone)) context_.report.setUndone(outcome.solve.body);
            }
    }

private:
    /// What a solve changes, and a new one begins with.
    void keepStart()
    {
        plan_ = {coupling_.rigid, coupling_.articulations};
        for (const SoftBody& body : scene_.soft)
            if (body.system.matrixFree) body.system.matrixFree->keepImpulses();
    }

    void solveAll(const StepContext& context)
    {
        fragments_ = findFragmentSolves(scene_, coupling_.rigid, coupling_.constraints);
        const std::vector<Island> islands =
            findIslands(scene_.soft.size(), coupling_.rigid, coupling_.constraints, fragments_.apart);
        const StepLimits limits = limitsOf(context, scene_, islands);
        if (repeats_ > 0) context_.report.contacts.mismatch = 0.0;
        for (std::size_t i = 0; i < islands.size(); ++i) solveIsland(islands[i], limits.islands[i]);
        solveOthers(limits);
        for (const FragmentSolve& each : fragments_.list) solveFragment(each);
    }

    /// Sets the first guess of a body's solve, and sets its fragments aside.
    void prepareBody(std::size_t b)
    {
        SoftBody& body = scene_.soft[b];
        body.system.dv = body.state.dv;
        std::ranges::fill(body.system.residual, Vec3{}); // only the default solver writes residuals
        setFragmentsAside(b);
    }

    void setFragmentsAside(std::size_t b)
    {
        SoftBody& body = scene_.soft[b];
        if (repeats_ > 0 && body.system.matrixFree) body.system.matrixFree->restoreImpulses();
        for (FragmentSolve& each : fragments_.list)
            if (each.body == b) setAside(each, body);
    }

    void solveOthers(const StepLimits& limits)
    {
        forEachBody(scene_, context_.pool, [&](SoftBody& body, std::size_t b) {
            if (coupled_[b]) return;
            if (repeats_ > 0) return setFragmentsAside(b); // the rest of it is solved already
            prepareBody(b);
            const linalg::NodeSolveReport solve = solveBody(context_.dt, 1.0, limits.bodies[b], body, context_.pool);
            outcomes_[b] = outcomeOf(body.model.id, body.model.id, solve);
        });
    }

    void solveFragment(const FragmentSolve& fragment)
    {
        SoftBody& body = scene_.soft[fragment.body];
        const Island alone{.soft = {fragment.body}, .rigid = {}, .constraints = {}};
        const CoupledReport solve =
            engine::solveFragment(context_.dt, coupledLimitsOf(context_, scene_, alone, limitsOf(body.model)), fragment,
                                  body, coupling_.constraints, coupling_.scratch.solver);
        if (!solve.converged) outcomes_[fragment.body].set(StepFlag::NotConverged);
        if (!fragment.constraints.empty()) noteContacts(solve);
    }

    void solveIsland(const Island& island, const linalg::SolveLimits& limits)
    {
        for (std::size_t b : island.soft) {
            prepareBody(b);
            coupled_[b] = true;
        }
        const CoupledReport solve =
            engine::solveIsland(context_, island, coupledLimitsOf(context_, scene_, island, limits), scene_, coupling_);
        const auto coupledOutcome = [&solve](BodyId id, BodyId together) {
            BodyOutcome outcome = outcomeOf(id, together, solve);
            if (solve.apart && !solve.outOfTime) outcome.set(StepFlag::NotConverged);
            return outcome;
        };
        for (std::size_t b : island.soft) {
            const int before = repeats_ > 0 ? outcomes_[b].solve.iterations : 0;
            outcomes_[b] = coupledOutcome(scene_.soft[b].model.id, scene_.soft[island.soft.front()].model.id);
            outcomes_[b].solve.iterations += before;
        }
        if (island.soft.empty() && repeats_ == 0) {
            const BodyId first = scene_.rigid[coupling_.rigid[island.rigid[0]].body].model.id;
            rigidOutcomes_.push_back(coupledOutcome(first, first));
        }
        noteContacts(solve);
    }

    void noteContacts(const CoupledReport& solve)
    {
        physics::ContactReport& contacts = context_.report.contacts;
        contacts.rounds = std::max(contacts.rounds, solve.rounds);
        contacts.mismatch = std::max(contacts.mismatch, solve.mismatch);
    }

    [[nodiscard]] bool inTime() const
    {
        return std::ranges::none_of(outcomes_, [](const BodyOutcome& each) { return each.has(StepFlag::OutOfTime); });
    }

    void solveAgain()
    {
        // Without a deadline: a replay makes as many iterations, and a step that ran out of time has none left.
        const StepContext unhurried{context_.dt, nullptr, context_.method, context_.pool, context_.report};
        std::tie(coupling_.rigid, coupling_.articulations) = plan_;
        // A spring's force is that of its length alone. From the last solve's it would grow with every new one.
        for (Constraint& each : coupling_.constraints)
            if (each.softness != 0.0) each.impulse = {};
        solveAll(unhurried);
    }

    /// A light body that is jerked about by what it holds turns otherwise than foreseen.
    void followTurns()
    {
        const auto otherwise = [&](int i) { return foreseeTurns(context_.dt, i == 0 ? 1.0 : kTurnShare, coupling_); };
        for (int i = 0; i < kTurns && inTime() && otherwise(i); ++i) {
            ++repeats_;
            solveAgain();
        }
    }

    /// If rods would pass through something, adds contacts that hinder them, and solves again.
    void keepLinesApart()
    {
        const auto missed = [&] {
            std::vector<MissedContact> all = findLinePasses(context_.dt, scene_, coupling_);
            std::ranges::move(findUnforeseen(context_, scene_, coupling_), std::back_inserter(all));
            std::ranges::move(findRigidPasses(context_, scene_, coupling_), std::back_inserter(all));
            return all;
        };
        std::vector<MissedContact> found = missed();
        for (; !found.empty() && inTime() && ++repeats_ <= kRepeats; found = missed()) {
            const std::size_t before = coupling_.contactCount;
            addMissed(context_, found, scene_, coupling_);
            leaveToChannels(context_.dt, scene_, coupling_, before);
            if (coupling_.contactCount == before) break; // all were of threads along their channels: nothing to solve
            solveAgain();
            followTurns();
        }
        if (found.empty()) return;
        std::vector<MissedContact> passes = findLinePasses(context_.dt, scene_, coupling_);
        std::vector<MissedContact> throughRigid = findRigidPasses(context_, scene_, coupling_);
        // They go as far as they can. What stands still passes through nothing that stands still, so this ends.
        const std::size_t most = kSlower + scene_.soft.size();
        for (std::size_t i = 0; !(passes.empty() && throughRigid.empty()) && i < most; ++i) {
            carryAlong(context_.dt, throughRigid, coupling_, scene_);
            for (const MissedContact& pass : throughRigid) outcomes_[pass.bodies[0]].set(StepFlag::NotConverged);
            std::vector<char> slow(scene_.soft.size());
            for (const MissedContact& pass : passes)
                for (std::size_t b : pass.bodies) slow[b] = 1;
            for (std::size_t b = 0; b < slow.size(); ++b) {
                if (slow[b] == 0) continue;
                SoftBody& body = scene_.soft[b];
                body.system.rod->slow(i < kSlower ? 0.5 : 0.0, body.state, body.system.dv);
                outcomes_[b].set(StepFlag::NotConverged);
            }
            passes = findLinePasses(context_.dt, scene_, coupling_);
            throughRigid = findRigidPasses(context_, scene_, coupling_);
        }
    }

    const StepContext& context_;
    Scene& scene_;
    Coupling& coupling_;
    std::pair<RigidPlan, ArticulationPlans> plan_; ///< before the solve, which changes it
    int repeats_ = 0;
    FragmentSolves fragments_;               ///< those of the present solve
    std::vector<BodyOutcome> outcomes_;      ///< per soft body
    std::vector<BodyOutcome> rigidOutcomes_; ///< per island without a soft body
    std::vector<char> coupled_;              ///< per soft body: 1 if it is in an island
};

} // namespace

void advance(const StepContext& context, Scene& scene, Coupling& coupling)
{
    if (context.dt > 0.0) {
        Advance stage(context, scene, coupling);
        stage.solve();
        stage.settle();
        stage.reportSolves();
        scene.time += context.dt;
        ++scene.step;
    }
    moveRigid(context, coupling.rigid, scene);
    moveArticulations(context, coupling.articulations, coupling.rigid, scene);
    context.report.step = scene.step;
    context.report.time = scene.time;
}

} // namespace filasofia::engine
