#include "filasofia/engine/soft/matrix_free_system.h"

#include "filasofia/core/worker_pool.h"
#include "filasofia/engine/body/law_range.h"
#include "filasofia/engine/body/tissue.h"
#include "filasofia/engine/elastic/stress_bound.h"
#include "filasofia/linalg/node_parts.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

using linalg::NodeArray;
using linalg::Parts;

// [-] The part of the residual impulse that is handed on to the next step. Without any, a loosely converged solve loses
// a little in every step, always in the same direction, and the errors add up. If the whole residual is handed on,
// impulses so rough that they hardly move the body accumulate and cost iterations. So what the coarse nodes can carry
// is handed on, and kRough of the rest; without coarse nodes, half of the residual. Measured on bunnies of 3000 to
// 30000 elements at 5 ms: what the coarse nodes can carry costs no iteration. A quarter of the rest costs 0.1 to 0.4 (1
// at 30000 elements) and mostly lowers the error by a fifth to a half; half of it costs 0.5 to 1.6. After cuts, light
// nodes are coarse nodes too and carry rough impulses: in contact, all of them cost 0.2 of 3.5 iterations more than
// half of them, and shook a block of 1 GPa on a floor. Where the answer is too small to be solved for, as a body comes
// to rest, kRoughAtRest of the rest is handed on: else the body settled elsewhere, by 1.7e-4 of its displacement in
// place of 0.7e-4, for 6 to 11 % fewer iterations until it rests.
constexpr double kHandedOn = 1.0, kHandedOnInContact = 0.5, kHandedOnWithoutCoarseNodes = 0.5;
constexpr double kRough = 0.25, kRoughAtRest = 0.6;

// A body with so few nodes is solved to a tighter tolerance than asked for, which costs microseconds. If a stiff body
// swings about a node, that motion is not a mode of the preconditioner, which then underestimates the error up to a
// hundred times, and steps that turn the body by more than 0.1 rad gained energy. With the tolerance asked for, 9 of 16
// such bodies (0.3 to 8 s, 20 to 128 nodes, 1 MPa) gained up to 10^4 times their initial energy; with a hundredth of
// it, none does.
constexpr int kFewNodes = 128;

// Iterations of a step from which on the next one's smoother is made of the present tangents, which costs as much as
// two products. Measured in docs/lab/engine.md.
constexpr int kSlow = 5;
constexpr double kTighter = 0.01, kSmallestTolerance = 1e-5; // the second is the limit of float

// [-] A shell whose nodes have turned against their neighbours so far is crumpled. A sheet of 441 nodes and 1 MPa that
// collapsed took 179 iterations per step (of any number) with the preconditioner of rest, 18 with either as this
// chooses, and 33 with that of present blocks alone; from 0.95 to 0.99 it makes no difference. At 0.1 MPa: 76, 14, 19.
constexpr double kCoherent = 0.97;

constexpr int kNodesPerPart = 512;

void store(Vec3 value, float* out)
{
    out[0] = asFloat(value.x);
    out[1] = asFloat(value.y);
    out[2] = asFloat(value.z);
}

Vec3 vectorAt(const linalg::NodeArray& array, int node)
{
    const float* at = array[node];
    return {at[0], at[1], at[2]};
}

} // namespace

void MatrixFreeSystem::load(std::span<const Vec3> from, Vec3 origin, NodeArray& to, WorkerPool& pool) const
{
    const Parts parts{static_cast<int>(nodeOf_.size()), kNodesPerPart};
    pool.run(parts.count(), [&](int part) {
        for (int slot = parts[part].begin; slot < parts[part].end; ++slot)
            if (nodeOf_[slot] >= 0) store(from[nodeOf_[slot]] - origin, to[slot]);
    });
}

void MatrixFreeSystem::loadImpulses(std::span<const Vec3> forces, std::span<const Vec3> residual, double dt,
                                    WorkerPool& pool)
{
    const Parts parts{freeNodes_, kNodesPerPart};
    pool.run(parts.count(), [&](int part) {
        for (int slot = parts[part].begin; slot < parts[part].end; ++slot) {
            const int node = nodeOf_[slot];
            store(scale_ * residual[node], handedOn_[slot]);
            if (free_) store(scale_ * dt * forces[node], outer_[slot]);
            store(scale_ * (dt * forces[node] + residual[node]), residual_[slot]);
        }
    });
}

void MatrixFreeSystem::assemble(const SoftModel& model, std::span<const Vec3> given, double dt, double inertia,
                                SoftState& state, WorkerPool& pool)
{
    const RayleighDamping rayleigh{model.rayleigh.mass, model.rayleigh.stiffness};
    const bool implicit = std::holds_alternative<physics::ImplicitEuler>(model.integrator);
    const RelaxationStep relaxation = nextRelaxation(model, dt, state);
    const ImplicitWeights weights =
        implicit ? implicitWeights(dt, rayleigh, relaxation.tangent) : explicitWeights(dt, rayleigh);
    dt_ = dt;
    massWeight_ = inertia * weights.mass;
    massLoss_ = dt * rayleigh.mass;
    elasticLoss_ = 1.0 - 0.5 * weights.lawTurning;
    for (std::size_t i = 0; i < pins_.size(); ++i) diagonal_[i] = asFloat(weights.stiffness) * pins_[i];

    load(state.x, state.x[static_cast<std::size_t>(std::max(nodeOf_.front(), 0))], x_, pool);
    load(state.v, {}, v_, pool);
    loadImpulses(given, state.residual, dt, pool);

    // Springs have no law, and their matrix has the weight of what does not relax.
    const bool fem = !elements_.empty();
    const BlockWeights blockWeights{.force = asFloat(dt),
                                    .stiffness = asFloat(fem ? weights.law : weights.stiffness),
                                    .damping = asFloat(weights.damping),
                                    .turning = asFloat(fem ? weights.lawTurning : weights.turning),
                                    .fibreStiffness = asFloat(weights.stiffness),
                                    .fibreTurning = asFloat(weights.turning),
                                    .volumeStiffness = asFloat(weights.stiffness)};
    const std::span<float> corners = floats(corners_), quaternions = floats(quaternions_);
    const std::span<float> elementCorners = corners.first(kElementCorners * elements_.size());
    const std::span<float> springCorners = corners.subspan(elementCorners.size(), kSpringCorners * springs_.size());
    const Parts elements = elementParts(elements_.size()), springs = elementParts(springs_.size());
    const BlockInput input{x_, v_, blockWeights, relaxation.terms > 0 ? &relaxation : nullptr,
                           asFloat(std::min(model.material.validStrain, safeStrain(model.material.law)))};
    const ElementOutput elementOutput{
        state.rotations, tangents_,   inverted_,        strains_,
        elementCorners,  quaternions, state.relaxation, {model.material.fibres, fibres_, fibreTangents_}};
    const SpringOutput springOutput{springMatrices_, springCorners};
    pool.run(elements.count(),
             [&](int part) { updateElements(model.material.law, elements_, input, elements[part], elementOutput); });
    volumes_.assemble(elements_, input, pool, elementCorners);
    pool.run(springs.count(), [&](int part) { updateSprings(springs_, input, springs[part], springOutput); });
    shell_.update(input, corners.last(64 * shell_.groups()), quaternions, pool);
    size_ = linalg::sumOfParts(pool, linalg::nodeParts(freeBlocks_), sums_, [&](linalg::Blocks blocks) {
        if (implicit && !quaternions_.empty())
            averageRotations(turns_, quaternions, preconditioner_.rotations(), blocks);
        return gatherForces({gather_, corners, asFloat(dt * rayleigh.mass), masses_, diagonal_}, v_, residual_, blocks);
    });
    if (!implicit) return;
    preconditioner_.useOwnRotations();
    if (shell_.empty())
        preconditioner_.usePresent({});
    else
        followCreases();
    preconditioner_.followPieces(x_, masses_, massWeight_);
}

void MatrixFreeSystem::followCreases()
{
    present_.clear();
    if (preconditioner_.coherence() < kCoherent) {
        present_.resize(static_cast<std::size_t>(freeNodes_));
        shell_.addDiagonal(present_);
        for (std::size_t slot = 0; slot < present_.size(); ++slot)
            present_[slot] += (massWeight_ * masses_[slot] + diagonal_[slot]) * Mat3::identity();
    }
    preconditioner_.usePresent(present_);
}

double MatrixFreeSystem::multiply(const NodeArray& p, NodeArray& q, WorkerPool& pool)
{
    const std::span<float> corners = floats(corners_);
    const Parts elements = elementParts(elements_.size()), springs = elementParts(springMatrices_.size());
    pool.run(elements.count(), [&](int part) {
        multiplyElements(tangents_, fibreTangents_, p, corners.first(kElementCorners * elements_.size()),
                         elements[part]);
    });
    volumes_.multiply(p, pool, corners.first(kElementCorners * elements_.size()));
    pool.run(springs.count(), [&](int part) {
        multiplySprings(springMatrices_, p, corners.subspan(kElementCorners * elements_.size()), springs[part]);
    });
    shell_.multiply(p, corners.last(64 * shell_.groups()), pool);
    const double curvature =
        linalg::sumOfParts(pool, linalg::nodeParts(freeBlocks_), sums_, [&](linalg::Blocks blocks) {
            return gatherAndAdd({gather_, corners, asFloat(massWeight_), masses_, diagonal_}, p, q, blocks);
        });
    return curvature + cavities_.multiply(p, q);
}

void MatrixFreeSystem::setCavities(std::span<const RankOneStiffness> cavities)
{
    cavities_.set(cavities, slotOf_, freeNodes_, scale_);
}

double MatrixFreeSystem::precondition(const NodeArray& r, NodeArray& z, WorkerPool& pool)
{
    return preconditioner_.apply(r, z, pool);
}

bool MatrixFreeSystem::mayFollowTangents() const
{
    // The coarse level is that of the period. Beside it, D of a step twice as long saves a seventh of the iterations,
    // and of one five times as long costs a half more.
    const bool near = dt_ < 2.5 * period_ && dt_ > 0.4 * period_;
    return near && !elements_.empty() && springs_.empty() && volumes_.empty() && !preconditioner_.hasClusters() &&
           !std::holds_alternative<std::vector<WarpedBlock>>(tangents_);
}

void MatrixFreeSystem::smoothByTangents(WorkerPool& pool)
{
    mixed_.resize(4 * elements_.size());
    const std::span<float> own = floats(corners_), mixed = floats(mixed_);
    const Parts elements = elementParts(elements_.size());
    pool.run(elements.count(),
             [&](int part) { diagonalOfElements(tangents_, fibreTangents_, own, mixed, elements[part]); });
    preconditioner_.usePresentSmoother({{gather_, own, asFloat(massWeight_), masses_, diagonal_}, mixed}, pool);
}

linalg::NodeSolveReport MatrixFreeSystem::solve(const linalg::SolveLimits& limits, int iterations, std::span<Vec3> dv,
                                                std::span<Vec3> residual, WorkerPool& pool)
{
    load(dv, {}, dv_, pool);
    if (iterations >= kSlow && mayFollowTangents()) smoothByTangents(pool);
    linalg::SolveLimits tighter = limits;
    if (freeNodes_ <= kFewNodes)
        tighter.tolerance = std::min(limits.tolerance, std::max(kTighter * limits.tolerance, kSmallestTolerance));
    // Scaled, the mean mass of a node is 1.
    const linalg::NodeSolveReport report =
        cg_.solve({*this, preconditioner_, residual_, size_, static_cast<double>(freeNodes_)}, dv_, tighter, pool);
    finish(report, rigidPush(), kHandedOn, dv, residual, pool);
    return report;
}

void MatrixFreeSystem::finish(const linalg::NodeSolveReport& report, std::span<Vec3> dv, std::span<Vec3> residual,
                              WorkerPool& pool)
{
    finish(report, {}, kHandedOnInContact, dv, residual, pool);
}

void MatrixFreeSystem::finish(const linalg::NodeSolveReport& report, const RigidMotion& push, double share,
                              std::span<Vec3> dv, std::span<Vec3> residual, WorkerPool& pool)
{
    // If the solve was cut short, its residual could do harm: it is not handed on, and the body is slowed down instead.
    const double removed = std::max(heldBack(pool), report.converged ? 0.0 : report.residual);
    const RigidMotion rigid = removed > 0.0 ? rigidMotion() : RigidMotion{};
    const bool smooth = report.converged && preconditioner_.coarseNodes() > 0;
    if (smooth) preconditioner_.carry(masses_, residual_, handedOn_, pool);
    const NodeArray& left = smooth ? handedOn_ : residual_;
    const double handed = !report.converged ? 0.0 : smooth ? share : kHandedOnWithoutCoarseNodes;
    const double rough = report.small ? kRoughAtRest : kRough;
    const Parts parts{freeNodes_, kNodesPerPart};
    pool.run(parts.count(), [&](int part) {
        for (int slot = parts[part].begin; slot < parts[part].end; ++slot) {
            const Vec3 change = vectorAt(dv_, slot), all = vectorAt(residual_, slot), some = vectorAt(left, slot);
            const int node = nodeOf_[slot];
            residual[node] = handed / scale_ * (some + rough * (all - some));
            dv[node] = change + push.at(vectorAt(x_, slot));
            if (removed > 0.0) dv[node] -= removed * (vectorAt(v_, slot) + change - rigid.at(vectorAt(x_, slot)));
        }
    });
}

bool MatrixFreeSystem::findStressed(const SoftModel& model, const SoftState& state, double limit, WorkerPool& pool,
                                    std::vector<std::uint16_t>& stressed)
{
    if (!hasLawAlone(model)) { // the bound is one of the law's stress
        stressed.clear();
        return true;
    }
    load(state.x, state.x[static_cast<std::size_t>(std::max(nodeOf_.front(), 0))], scratch_, pool);
    stressed.resize(elements_.size());
    const StressLimit at{model.material.law, asFloat(limit), asFloat(stiffest_.mu), asFloat(stiffest_.lambda)};
    const Parts parts = elementParts(elements_.size());
    pool.run(parts.count(), [&](int part) {
        engine::findStressed({elements_, scratch_, state.rotations}, at, stressed, parts[part]);
    });
    return std::ranges::any_of(stressed, [](std::uint16_t bits) { return bits != 0; });
}

Vec3 MatrixFreeSystem::takeImpulse(int node)
{
    const int slot = slotOf_[static_cast<std::size_t>(node)];
    const Vec3 impulse = 1.0 / scale_ * vectorAt(residual_, slot);
    store({}, residual_[slot]);
    store({}, handedOn_[slot]);
    if (free_) store(massLoss_ * static_cast<double>(masses_[slot]) * vectorAt(v_, slot), outer_[slot]);
    return impulse;
}

RigidMotion MatrixFreeSystem::rigidMotion() const
{
    return rigidMotionOf(
        [&](int slot) { return static_cast<double>(masses_[slot]) * (vectorAt(v_, slot) + vectorAt(dv_, slot)); });
}

RigidMotion MatrixFreeSystem::rigidPush() const
{
    return rigidMotionOf([&](int slot) {
        const double mass = masses_[slot];
        return 1.0 / massWeight_ * (vectorAt(outer_, slot) - massLoss_ * mass * vectorAt(v_, slot)) -
               mass * vectorAt(dv_, slot);
    });
}

template <class MomentumOf> RigidMotion MatrixFreeSystem::rigidMotionOf(const MomentumOf& momentumOf) const
{
    if (!free_) return {};
    return engine::rigidMotionOf(
        freeNodes_, [&](int slot) { return static_cast<double>(masses_[slot]); },
        [&](int slot) { return vectorAt(x_, slot); }, momentumOf);
}

double MatrixFreeSystem::heldBack(WorkerPool& pool)
{
    const Parts parts = linalg::nodeParts(freeBlocks_);
    const auto workOf = [&](const NodeArray& v, const NodeArray& dv) {
        std::vector<linalg::StepWork> works(static_cast<std::size_t>(parts.count()));
        pool.run(parts.count(), [&](int part) {
            works[static_cast<std::size_t>(part)] = linalg::stepWork(masses_, v, dv, residual_, handedOn_, parts[part]);
        });
        linalg::StepWork all;
        for (const linalg::StepWork& each : works) {
            all.work += each.work;
            all.change += each.change;
            all.motion += each.motion;
        }
        return all;
    };
    const linalg::StepWork whole = workOf(v_, dv_);
    if (whole.work >= -0.5 * whole.change) return 0.0; // no energy is gained: the products below are not needed

    const RigidMotion rigid = rigidMotion();
    for (int slot = 0; slot < freeNodes_; ++slot)
        store(vectorAt(v_, slot) + vectorAt(dv_, slot) - rigid.at(vectorAt(x_, slot)), scratch_[slot]);
    const linalg::StepWork inner = workOf(scratch_, zeros_);
    const double inertia = multiply(scratch_, product_, pool); // w . A w
    const double cavities = cavities_.curvature(scratch_);     // no damping is part of it
    const double elastic = std::max(0.0, inertia - cavities - massWeight_ * inner.motion);
    const double lost = 0.5 * (whole.change + cavities) + (massWeight_ - 1.0) * inner.motion + elasticLoss_ * elastic;
    return inner.work >= -lost ? 0.0 : std::min(1.0, -inner.work / inertia);
}

void MatrixFreeSystem::solveExplicit(std::span<Vec3> dv) const
{
    for (int slot = 0; slot < freeNodes_; ++slot) {
        const float* impulse = residual_[slot];
        const double perMass = 1.0 / (massWeight_ * masses_[slot]);
        dv[nodeOf_[slot]] = {perMass * impulse[0], perMass * impulse[1], perMass * impulse[2]};
    }
}

linalg::Interpolation MatrixFreeSystem::coarseWeights(int node) const
{
    linalg::Interpolation how = preconditioner_.interpolation(slotOf_[static_cast<std::size_t>(node)]);
    for (std::size_t k = 0; k < how.corners.size(); ++k)
        if (how.corners[k] >= preconditioner_.coarseLevel().latticeNodes()) how.weights[k] = 0.0f;
    return how;
}

Mat3 MatrixFreeSystem::rotation(int node) const
{
    return preconditioner_.rotation(slotOf_[static_cast<std::size_t>(node)]);
}

double MatrixFreeSystem::compliance(int node) const
{
    return scale_ / 3.0 * trace(preconditioner_.inverseDiagonal(slotOf_[static_cast<std::size_t>(node)]));
}

double MatrixFreeSystem::coarseCompliance(std::size_t row, std::size_t column) const
{
    return scale_ * preconditioner_.coarseLevel().inverseEntry(row, column);
}

} // namespace filasofia::engine
