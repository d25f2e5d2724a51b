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
// Bodies with a coarse level up to which that pays off. In a heap of fifty, 34 iterations with it took a fifth longer
// than 41 without: there the impulses go from body to body.
constexpr int kMostJoined = 4;
// Multipliers are updated again if the last update has brought the worst constraint down to this share.
constexpr double kUpdateHelps = 0.5;
constexpr double kSteepEnough = 0.1; // a direction's derivative relative to that of z; if it is less, z is used instead

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
    const auto holds = [](const ConstraintRow& row) { return row.constraint->bilateral() && !row.constraint->tied; };
    if (std::ranges::any_of(rows.list, holds)) correctCoarseLevels();

    const bool mayJoin = std::ranges::count_if(bodies, [](const CoupledBody& body) {
                             return body.deflation() != nullptr;
                         }) <= kMostJoined;
    const linalg::SolveLimits& linear = limits.linear;
    CoupledReport report;
    report.rounds = 1;
    for (int updates = 0, nonlinear = 0;; ++report.iterations, ++nonlinear) {
        if (report.iterations == kCorrectAfter && !correction_.hasMotions()) correctCoarseLevels();
        if (report.iterations == kJoinAfter && mayJoin) joinConstraints();
        const double rz = precondition(); // the energy of the error, as the preconditioner estimates it
        // Where stiff constraints hold what is at rest, rounding may make it less than nothing.
        const bool nothing = std::abs(rz) <= linear.tolerance * linear.tolerance * energy_;
        const bool number = (rz >= 0.0 || nothing) && std::isfinite(rz);
        report.residual = !number ? 1.0 : rz <= 0.0 ? 0.0 : std::sqrt(rz / (rz + energy_));
        report.converged = report.residual <= linear.tolerance && impulsesSettled();
        if (report.converged && !activeSetFrozen_ && updates < limits.multiplierUpdates && updateMultipliers()) {
            ++updates;
            ++report.rounds;
            nonlinear = -1; // a new problem, which starts from this solution
            --report.iterations;
            continue;
        }
        if (report.converged || !number || report.iterations >= linear.maxIterations) break;
        report.outOfTime = report.iterations == linear.stopAt ||
                           (report.iterations >= linear.minIterations && linear.outOfTime && linear.outOfTime());
        if (report.outOfTime) break;
        if (nonlinear == limits.nonlinear) {
            freezeActiveSet();
            ++report.rounds;
        }
        if (!updateDirection(rz)) break; // no positive curvature: rounding errors dominate
        lineSearch();
    }
    report.mismatch = mismatch();
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        Constraint& solved = *rows.list[c].constraint;
        solved.multiplier = law(c, rows_[c].u).impulse;
        solved.impulse = rows_[c].impulse;
    }
    return report;
}

void CoupledSolve::begin(const std::vector<std::vector<ContactPoint>>& pointsOf)
{
    first_.assign(1, 0);
    sharing_.clear();
    compliance_.clear();
    masses_.clear();
    double mass = 0.0;
    for (std::size_t b = 0; b < bodies_->size(); ++b) {
        BodyOperator& body = *(*bodies_)[b].matrix;
        const std::vector<ContactPoint>& points = pointsOf[b];
        masses_.push_back(body.begin(points));
        mass += masses_.back();
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
    for (std::size_t c = 0; c < rows_.size(); ++c) rows_[c].law = constraint(c);
    for (std::vector<Vec3>* each : {&smoothed_, &velocities_, &impulses_, &perRow_}) each->resize(rows_.size());
    exact_ = std::ranges::all_of(*bodies_, [](const CoupledBody& body) { return body.smoother->isExact(); });
    joined_ = exact_;
    together_ =
        exact_ || std::ranges::any_of(*bodies_, [](const CoupledBody& body) { return body.smoother->couplesNodes(); });
    if (together_) filter_.begin(*bodies_, first_, *constraints_);
    smallest_ = mass * limits_->smallChange;
    energy_ = smallest_ * limits_->smallChange;
    activeSetFrozen_ = false;
    restart_ = true;
    missed_ = std::numeric_limits<double>::infinity();
}

Vec3 CoupledSolve::reaction(std::size_t c, Vec3 u) const
{
    const Row& row = rows_[c];
    return row.law.impulse - times(row.stiffness, row.law.bias + u);
}

Projected CoupledSolve::law(std::size_t c, Vec3 u) const { return project(rows_[c].law, reaction(c, u)); }

Vec3 CoupledSolve::lawAlong(std::size_t c, Vec3 u) const
{
    const Row& row = rows_[c];
    if (!activeSetFrozen_) return project(row.law, reaction(c, u), row.cone).impulse;
    return linearised(row.law, row.state, reaction(c, u));
}

void CoupledSolve::read(SolveVector from, std::vector<Vec3>& velocities)
{
    for (std::size_t b = 0; b < bodies_->size(); ++b)
        (*bodies_)[b].matrix->read(from,
                                   std::span(atPoints_).subspan(static_cast<std::size_t>(first_[b]),
                                                                static_cast<std::size_t>(first_[b + 1] - first_[b])));
    const WeightedPoint* points = constraints_->points.data();
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        const ConstraintRow& row = constraints_->list[c];
        Vec3 sum;
        for (int k = row.first; k < row.first + row.count; ++k)
            sum += points[k].weight * atPoints_[static_cast<std::size_t>(points[k].point)];
        velocities[c] = sum;
    }
}

double CoupledSolve::multiply()
{
    double curvature = 0.0;
    for (const CoupledBody& body : *bodies_) curvature += body.matrix->multiply();
    read(SolveVector::Direction, velocities_);
    for (std::size_t c = 0; c < rows_.size(); ++c) rows_[c].along = inFrame(rows_[c].law.frame, velocities_[c]);
    return curvature;
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
        for (std::size_t c = 0; c < rows_.size(); ++c)
            sum -= dot(rows_[c].along, law(c, rows_[c].u + t * rows_[c].along).impulse);
        return sum;
    };
    double t = 0.0;
    const double atStart = rise(0.0), atOne = rise(1.0);
    if (curvature > 0.0 && std::isfinite(atOne) && atStart < 0.0) {
        t = 1.0;
        if (!(std::abs(atOne) <= 0.5 * -atStart)) t = std::clamp(atStart / (atStart - atOne), 0.0, 2.0);
        if (atOne < atStart) t = 0.0;
    }
    for (const CoupledBody& body : *bodies_) body.matrix->step(t);
    for (Row& row : rows_) row.u += t * row.along;
    energy_ += t * t * std::max(0.0, curvature);
    projectImpulses();
}

bool CoupledSolve::impulsesSettled() const
{
    // The change that z would still make: it estimates the error as well as the preconditioner estimates the matrix.
    double change = 0.0, all = 0.0;
    for (const Row& row : rows_) {
        change += lengthSquared(times(row.sigma, row.step));
        all += lengthSquared(row.impulse);
    }
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
        for (const Row& row : rows_) met -= dot(row.step, row.change);
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
        Row& row = rows_[c];
        row.along = row.step + beta * row.along;
        row.cone = coneOf(row.law, row.impulse);
        curvature_ += dot(row.along, times(row.sigma, row.along));
    }
    return curvature_ > 0.0;
}

void CoupledSolve::lineSearch()
{
    const auto derivativeAt = [&](double length) {
        double sum = derivative_ - length * ownCurvature_;
        for (std::size_t c = 0; c < rows_.size(); ++c) {
            Row& row = rows_[c];
            row.change = lawAlong(c, row.u + length * row.along) - row.impulse;
            sum += dot(row.along, row.change);
        }
        return sum;
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
    for (const CoupledBody& body : *bodies_) body.matrix->step(length_);
    for (Row& row : rows_) row.u += length_ * row.along;
    projectImpulses();
    derivativeAfter_ = derivativeAtEnd_;
    for (const Row& row : rows_) derivativeAfter_ += dot(row.along, row.passed - row.change);
    lastDerivative_ = derivative_;
    if (!activeSetFrozen_) renewFilter();
}

void CoupledSolve::projectImpulses()
{
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        Row& row = rows_[c];
        if (!activeSetFrozen_) row.now = law(c, row.u);
        const Vec3 lawful = activeSetFrozen_ ? lawAlong(c, row.u) : row.now.impulse;
        row.passed = lawful - row.impulse;
        row.impulse = lawful;
        impulses_[c] = inWorld(row.law.frame, row.passed);
    }
    push(1.0, [](const CoupledBody& body, std::span<const Vec3> impulses) {
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
        const Vec3 lawful = law(c, rows_[c].u).impulse;
        worst = std::max(worst, length(lawful - rows_[c].impulse));
        largest = std::max(largest, length(lawful));
    }
    return worst / largest;
}

bool CoupledSolve::updateMultipliers()
{
    const auto isRigid = [](const Constraint& constraint) { return constraint.softness == 0.0; };
    double worst = 0.0; // relative to the tolerance
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        const Constraint& each = constraint(c);
        if (!isRigid(each) || rows_[c].stiffness.x == 0.0) continue;
        if (std::abs(rows_[c].law.impulse.x) >= each.maxImpulse) continue; // the constraint has yielded
        const Vec3 missed = each.bias + rows_[c].u;
        // What was trapped and is let go would fly off by the impulse that it was held with.
        const bool thrown = rows_[c].trapped && rows_[c].impulse.x > 0.0 && missed.x > 0.0;
        worst = std::max(worst, (each.bilateral() ? length(missed) : thrown ? missed.x : -missed.x) / each.tolerance);
    }
    if (worst <= 1.0 || worst > kUpdateHelps * missed_) return false;
    missed_ = worst;
    for (std::size_t c = 0; c < rows_.size(); ++c)
        if (isRigid(constraint(c))) rows_[c].law.impulse = law(c, rows_[c].u).impulse;
    projectImpulses();
    makeFilter();
    restart_ = true;
    return true;
}

} // namespace filasofia::engine
