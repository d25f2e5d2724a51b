#include "filasofia/engine/constraint/coupled_solve.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

// The line search ends if the magnitude of the directional derivative has fallen to this fraction of its start, or
// after this number of trials.
constexpr double kFlatEnough = 0.3;
constexpr int kMaxTrials = 6;
constexpr int kCorrectAfter = 4; // iterations after which the coarse levels know patches of constraints
// Iterations after which filter and coarse levels know all constraints together. The slow scenes of docs/lab/contact.md
// take about the same time with 8, 12 and 16; solves that end soon are spared the cost.
constexpr int kJoinAfter = 16;
// Bodies with a coarse level up to which that pays off; with up to twice as many, after more iterations. In a heap of
// fifty, 34 iterations with it took a fifth longer than 41 without: there the impulses go from body to body. Since the
// five bodies of a cholecystectomy join late, none of its 31,600 steps ends at the limit, in place of 12.
constexpr std::ptrdiff_t kFewJoined = 4;
constexpr int kJoinManyAfter = 64;
// Friction lags if the residual has not fallen by half for this many iterations: docs/lab/contact.md.
constexpr int kLagAfter = 24;
// [-] Mismatch beyond which a solve has not converged, frozen or swept: contacts pull, or slide uphill.
constexpr double kLawful = 0.05;
// Iterations of Newton's method after which rigid bodies are solved by sweeps. Towers and heaps at rest take less.
constexpr int kSweepAfter = 40;
// [-] If this many steps in a row are so short, what the preconditioner proposes breaks constraints, and all are joined
// at once. A plate of 2 mm on a table went by 0.0001 to 0.001 of the proposals for 16 iterations, and gained nothing.
// They are more than kCorrectAfter: stiff cubes make short steps until the patches are known, and none after them.
constexpr double kShort = 0.05;
constexpr int kStuckAfter = 6;
constexpr double kSteepEnough = 0.1; // a direction's derivative relative to that of z; if it is less, z is used instead

/// How far a solve has come, from the iteration that it is made at.
class Progress {
public:
    explicit Progress(int iterations) : at_(iterations) {}
    void note(int iterations, double residual, double tolerance)
    {
        if (residual > std::max(tolerance, 0.5 * halved_)) return;
        halved_ = residual;
        at_ = iterations;
    }
    [[nodiscard]] bool stalls(int iterations) const { return iterations - at_ >= kLagAfter; }

private:
    double halved_ = 1.0; ///< the residual when it had last fallen by half
    int at_;              ///< iterations at that time
};

} // namespace

CoupledReport CoupledSolve::solve(const CoupledLimits& limits, const std::vector<CoupledBody>& bodies,
                                  const std::vector<std::vector<ContactPoint>>& pointsOf, const ConstraintRows& rows,
                                  std::span<const SolvedTie> ties)
{
    limits_ = &limits;
    bodies_ = &bodies;
    constraints_ = &rows;
    begin(pointsOf);
    correction_.begin(ties);
    chooseStiffness();
    firstGuess();
    makeFilter();
    const auto holds = [](const ConstraintRow& row) {
        const Constraint& each = *row.constraint;
        return each.bilateral() && !each.tied && each.kind != ConstraintKind::ClipLeg;
    };
    if (std::ranges::any_of(rows.list, holds)) correctCoarseLevels();

    const auto joinable =
        std::ranges::count_if(bodies, [](const CoupledBody& body) { return body.deflation() != nullptr; });
    const bool few = joinable <= kFewJoined;
    const int joinAfter = few ? kJoinAfter : joinable <= 2 * kFewJoined ? kJoinManyAfter : -1; // -1: never
    const linalg::SolveLimits& linear = limits.linear;
    CoupledReport report;
    report.rounds = 1;
    Progress progress(0);
    int shortSteps = 0; // in a row
    for (int updates = 0, nonlinear = 0;; ++report.iterations, ++nonlinear) {
        if (report.iterations == kCorrectAfter && !correction_.hasMotions()) correctCoarseLevels();
        const bool isStuck = shortSteps >= kStuckAfter && !activeSetFrozen_;
        const bool joins = report.iterations == joinAfter || (few && isStuck);
        if (report.iterations == linalg::kBlendAfter || joins) blendRotations();
        if (joins) joinConstraints();
        const double rz = precondition(); // the energy of the error, as the preconditioner estimates it
        // Where stiff constraints hold what is at rest, rounding may make it less than nothing.
        const bool nothing = std::abs(rz) <= linear.tolerance * linear.tolerance * energy_;
        const bool number = (rz >= 0.0 || nothing) && std::isfinite(rz);
        report.residual = !number ? 1.0 : rz <= 0.0 ? 0.0 : std::sqrt(rz / (rz + energy_));
        if (number) progress.note(report.iterations, report.residual, linear.tolerance);
        if (progress.stalls(report.iterations) && report.iterations < linear.maxIterations && mayLag()) {
            lagFriction();
            beginAnew();
            nonlinear = -1; // a new problem, which starts from this solution
            --report.iterations;
            continue;
        }
        report.converged = report.residual <= linear.tolerance && impulsesSettled();
        // What holds a body much lighter than the others shows in no measure of all: such a solve takes a step.
        const bool ends =
            report.converged && (nonlinear > 0 || (updates == 0 && (report.iterations > 0 || holdsWell())));
        if (ends && !activeSetFrozen_ && updateMultipliers(updates)) {
            ++updates;
            ++report.rounds;
            progress = Progress(report.iterations);
            nonlinear = -1;
            --report.iterations;
            continue;
        }
        if (ends || !number || report.iterations >= linear.maxIterations) break;
        report.outOfTime = isOutOfTime(report.iterations);
        if (report.outOfTime) break;
        if (nonlinear == (limits.sweeps ? std::min(kSweepAfter, limits.nonlinear) : limits.nonlinear)) {
            ++report.rounds;
            if (limits.sweeps && sweep(report)) break;
            freezeActiveSet();
        }
        if (!updateDirection(rz)) break; // no positive curvature: rounding errors dominate
        lineSearch();
        shortSteps = length_ < kShort ? shortSteps + 1 : 0;
    }
    if (!swept_) report.mismatch = mismatch();
    report.converged = report.converged && report.mismatch <= kLawful;
    report.apart = !swept_ && !holdsTogether();
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        Constraint& solved = *rows.list[c].constraint;
        solved.multiplier = carried(c);
        solved.impulse = rows_[c].impulse;
    }
    rememberLag(report);
    return report;
}

bool CoupledSolve::isOutOfTime(int iterations) const
{
    const linalg::SolveLimits& linear = limits_->linear;
    return iterations == linear.stopAt ||
           (iterations >= linear.minIterations && linear.outOfTime && linear.outOfTime());
}

void CoupledSolve::begin(const std::vector<std::vector<ContactPoint>>& pointsOf)
{
    first_.assign(1, 0);
    sharing_.clear();
    compliance_.clear();
    masses_.clear();
    whole_ = 0.0;
    for (std::size_t b = 0; b < bodies_->size(); ++b) {
        BodyOperator& body = *(*bodies_)[b].matrix;
        const std::vector<ContactPoint>& points = pointsOf[b];
        masses_.push_back(body.begin(points));
        whole_ += masses_.back();
        const int offset = first_.back(), count = static_cast<int>(points.size());
        for (int k = 0; k < count; ++k) {
            compliance_.push_back((*bodies_)[b].smoother->compliance(k));
            int same = k; // a body's contact points come in the order of their nodes
            if (k > 0 && points[static_cast<std::size_t>(k)].node == points[static_cast<std::size_t>(k) - 1].node)
                same = sharing_.back() - offset;
            sharing_.push_back(offset + same);
        }
        first_.push_back(offset + count);
    }
    atPoints_.resize(sharing_.size());
    rows_.assign(constraints_->list.size(), {});
    normals_.assign(rows_.size(), {});
    filters_.assign(rows_.size(), Mat3{});
    for (std::vector<Vec3>* each : {&velocities_, &alongs_, &steps_, &smoothed_, &impulses_})
        each->assign(rows_.size(), Vec3{});
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        const Constraint& each = constraint(c);
        rows_[c].law = each;
        velocities_[c] = each.sides[0].velocity - each.sides[1].velocity;
    }
    for (std::vector<std::size_t>* list : {&active_, &changing_, &passing_}) list->clear();
    exact_ = std::ranges::all_of(*bodies_, [](const CoupledBody& body) { return body.smoother->isExact(); });
    joined_ = exact_;
    blended_ = false;
    together_ =
        exact_ || std::ranges::any_of(*bodies_, [](const CoupledBody& body) { return body.smoother->couplesNodes(); });
    if (together_) filter_.begin(*bodies_, first_, *constraints_);
    smallest_ = whole_ * limits_->linear.smallAnswer;
    energy_ = smallest_ * limits_->linear.smallAnswer;
    activeSetFrozen_ = frictionLags_ = swept_ = false;
    const auto lags = [](const ConstraintRow& row) { return row.constraint->contact.cached.frictionLags; };
    if (!limits_->sweeps && std::ranges::any_of(constraints_->list, lags)) lagFriction();
    restart_ = true;
    missed_ = std::numeric_limits<double>::infinity();
}

Vec3 CoupledSolve::reaction(std::size_t c, Vec3 u) const
{
    const Row& row = rows_[c];
    return row.law.impulse - times(row.stiffness, row.law.bias + u);
}

Projected CoupledSolve::law(std::size_t c, Vec3 u) const
{
    const Vec3 y = reaction(c, u);
    return project(rows_[c].law, y, coneAt(c, y));
}

Vec3 CoupledSolve::lawAlong(std::size_t c, Vec3 u) const
{
    const Row& row = rows_[c];
    if (!activeSetFrozen_) return project(row.law, reaction(c, u), coneAt(c, row.impulse)).impulse;
    return linearised(row.law, row.state, reaction(c, u));
}

void CoupledSolve::read(SolveVector from)
{
    for (std::size_t b = 0; b < bodies_->size(); ++b) (*bodies_)[b].matrix->read(from, ofBody(b));
}

Vec3 CoupledSolve::velocityOf(std::size_t c) const
{
    Vec3 sum;
    for (const WeightedPoint& each : constraints_->pointsOf(constraints_->list[c]))
        sum += each.weight * atPoints_[static_cast<std::size_t>(each.point)];
    return sum;
}

double CoupledSolve::multiply()
{
    double curvature = 0.0;
    for (const CoupledBody& body : *bodies_) curvature += body.matrix->multiply();
    read(SolveVector::Direction);
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        alongs_[c] = velocityOf(c);
        normals_[c].along = dot(normals_[c].axis, alongs_[c]);
    }
    return curvature;
}

void CoupledSolve::moveAlong(double length)
{
    for (const CoupledBody& body : *bodies_) body.matrix->step(length);
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        velocities_[c] += length * alongs_[c];
        normals_[c].velocity += length * normals_[c].along;
    }
}

void CoupledSolve::firstGuess()
{
    // The last step's solution, scaled by the factor that suits this step's forces and impulses best.
    double derivative = 0.0;
    const double curvature = multiply();
    for (const CoupledBody& body : *bodies_)
        derivative += body.matrix->dot(SolveVector::Direction, SolveVector::Residual);
    const auto rise = [&](double t) {
        double sum = t * curvature - derivative;
        for (std::size_t c = 0; c < rows_.size(); ++c) {
            if (staysAsleep(c, t)) continue;
            const Vec3 along = inFrame(rows_[c].law.frame, alongs_[c]);
            sum -= dot(along, law(c, velocityIn(c) + t * along).impulse);
        }
        return sum;
    };
    double t = 0.0;
    const double atStart = rise(0.0), atOne = rise(1.0);
    if (curvature > 0.0 && std::isfinite(atOne) && atStart < 0.0) {
        t = 1.0;
        if (!(std::abs(atOne) <= 0.5 * -atStart)) t = std::clamp(atStart / (atStart - atOne), 0.0, 2.0);
        if (atOne < atStart) t = 0.0;
    }
    moveAlong(t);
    energy_ += t * t * std::max(0.0, curvature);
    projectImpulses();
}

bool CoupledSolve::impulsesSettled() const
{
    // The change that z would still make: it estimates the error as well as the preconditioner estimates the matrix.
    double change = 0.0, all = 0.0;
    for (std::size_t c : active_)
        change += lengthSquared(times(rows_[c].sigma, inFrame(rows_[c].law.frame, steps_[c])));
    for (const Row& row : rows_) all += lengthSquared(row.impulse);
    const double small = 0.01 * smallest_;
    return change <= limits_->tolerance * limits_->tolerance * std::max(all, small * small);
}

bool CoupledSolve::updateDirection(double rz)
{
    double beta = 0.0;
    derivative_ = rz;
    if (!restart_) {
        double met = 0.0; // z . (change of forces along the last direction)
        for (const CoupledBody& body : *bodies_)
            met += body.matrix->dot(SolveVector::Preconditioned, SolveVector::Product);
        met *= length_;
        for (std::size_t c : changing_) met -= dot(inFrame(rows_[c].law.frame, steps_[c]), rows_[c].change);
        beta = -met / (lastDerivative_ - derivativeAtEnd_);
        derivative_ = rz + beta * derivativeAfter_;
        if (!std::isfinite(beta) || !(derivative_ > kSteepEnough * rz)) {
            beta = 0.0;
            derivative_ = rz;
        }
    }
    restart_ = false;
    for (const CoupledBody& body : *bodies_) body.matrix->updateDirection(beta);
    ownCurvature_ = 0.0;
    for (const CoupledBody& body : *bodies_) ownCurvature_ += body.matrix->multiply();
    curvature_ = ownCurvature_;
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        alongs_[c] = steps_[c] + beta * alongs_[c];
        normals_[c].along = dot(normals_[c].axis, alongs_[c]);
    }
    for (std::size_t c : active_) {
        const Vec3 along = inFrame(rows_[c].law.frame, alongs_[c]);
        curvature_ += dot(along, times(rows_[c].sigma, along));
    }
    return curvature_ > 0.0;
}

double CoupledSolve::changesAlong(double length)
{
    for (std::size_t c : changing_) rows_[c].change = {};
    changing_.clear();
    double sum = 0.0;
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        if (staysAsleep(c, length)) continue;
        Row& row = rows_[c];
        row.along = inFrame(row.law.frame, alongs_[c]);
        row.change = lawAlong(c, velocityIn(c) + length * row.along) - row.impulse;
        sum += dot(row.along, row.change);
        changing_.push_back(c);
    }
    return sum;
}

void CoupledSolve::lineSearch()
{
    const auto derivativeAt = [&](double length) {
        return derivative_ - length * ownCurvature_ + changesAlong(length);
    };
    length_ = derivative_ / curvature_;
    derivativeAtEnd_ = derivativeAt(length_);
    double low = 0.0, atLow = derivative_, high = 0.0, atHigh = 0.0; // the derivative decreases along the direction
    for (int trial = 1; trial < kMaxTrials && std::abs(derivativeAtEnd_) > kFlatEnough * derivative_; ++trial) {
        (derivativeAtEnd_ > 0.0 ? low : high) = length_;
        (derivativeAtEnd_ > 0.0 ? atLow : atHigh) = derivativeAtEnd_;
        if (high > 0.0) {
            const double secant = atLow / (atLow - atHigh);
            length_ = low + std::clamp(secant, 0.1, 0.9) * (high - low);
        } else {
            const double secant = derivative_ / (derivative_ - derivativeAtEnd_);
            length_ *= secant > 1.0 && secant < 4.0 ? secant : 4.0;
        }
        derivativeAtEnd_ = derivativeAt(length_);
    }
    energy_ += length_ * length_ * std::max(0.0, ownCurvature_);
    moveAlong(length_);
    projectImpulses();
    derivativeAfter_ = derivativeAtEnd_;
    for (std::size_t c : passing_) derivativeAfter_ += dot(inFrame(rows_[c].law.frame, alongs_[c]), rows_[c].passed);
    for (std::size_t c : changing_) derivativeAfter_ -= dot(rows_[c].along, rows_[c].change);
    lastDerivative_ = derivative_;
    if (!activeSetFrozen_) renewFilter();
}

void CoupledSolve::projectImpulses()
{
    for (std::size_t c : passing_) rows_[c].passed = {};
    passing_.clear();
    others_ = 0;
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        if (staysAsleep(c, 0.0)) {
            others_ += normals_[c].active ? 1 : 0;
            continue;
        }
        Row& row = rows_[c];
        const Vec3 u = velocityIn(c);
        if (!activeSetFrozen_) row.now = law(c, u);
        const Vec3 lawful = activeSetFrozen_ ? lawAlong(c, u) : row.now.impulse;
        others_ += isOther(row.now, row.state) ? 1 : 0;
        normals_[c].sleeps = !row.law.bilateral() && !row.now.active && lawful == Vec3{};
        if (lawful == row.impulse) continue;
        row.passed = lawful - row.impulse;
        row.impulse = lawful;
        impulses_[c] = inWorld(row.law.frame, row.passed);
        passing_.push_back(c);
    }
    push(1.0, passing_, [](const CoupledBody& body, std::span<const Vec3> impulses) {
        body.matrix->add(impulses, SolveVector::Residual);
    });
}

void CoupledSolve::freezeActiveSet()
{
    makeFilter();
    activeSetFrozen_ = true;
    restart_ = true;
}

double CoupledSolve::mismatch() const
{
    double worst = 0.0, largest = 0.01 * smallest_;
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        if (staysAsleep(c, 0.0)) continue;
        const Vec3 lawful = law(c, velocityIn(c)).impulse;
        worst = std::max(worst, length(lawful - rows_[c].impulse));
        largest = std::max(largest, length(lawful));
    }
    return worst > 0.0 ? worst / largest : 0.0; // where all is pinned, both are zero
}

} // namespace filasofia::engine
