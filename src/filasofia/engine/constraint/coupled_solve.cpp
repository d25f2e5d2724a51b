#include "filasofia/engine/constraint/coupled_solve.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

// A direction is followed to where its slope is this share of what it was, or less; looked for so many times at most.
constexpr double kFlatEnough = 0.3;
constexpr int kLooks = 6;
constexpr int kHard = 4;             // iterations after which the coarse levels are corrected
constexpr double kSteepEnough = 0.1; // a direction's slope over that of z: less steep ones are left for z

} // namespace

CoupledReport CoupledSolve::solve(const CoupledLimits& limits, const std::vector<CoupledBody*>& bodies,
                                  const std::vector<std::vector<Grip>>& gripsOf, Constraints& constraints)
{
    limits_ = &limits;
    bodies_ = &bodies;
    constraints_ = &constraints;
    begin(gripsOf);
    chooseStiffness();
    firstGuess();
    makeFilter();
    const auto isHeld = [](const Constraint& constraint) { return constraint.friction < 0.0; };
    if (std::ranges::any_of(constraints.list, isHeld)) correctCoarseLevels();

    const linalg::SolveLimits& linear = limits.linear;
    CoupledReport report;
    report.rounds = 1;
    for (int raises = 0, followed = 0;; ++report.iterations, ++followed) {
        if (report.iterations == kHard && patches_.empty()) correctCoarseLevels();
        const double rz = precondition(); // the energy of the error, as the preconditioner sees it
        const bool number = rz >= 0.0 && std::isfinite(rz);
        report.residual = rz == 0.0 ? 0.0 : number ? std::sqrt(rz / (rz + energy_)) : 1.0;
        report.converged = report.residual <= linear.tolerance && impulsesSettled();
        if (report.converged && !statesKept_ && raises < limits.raises && raiseImpulses()) {
            ++raises;
            ++report.rounds;
            followed = -1; // a new problem, from this one's answer
            --report.iterations;
            continue;
        }
        if (report.converged || !number || report.iterations >= linear.maxIterations) break;
        report.outOfTime = report.iterations == linear.stopAt ||
                           (report.iterations >= linear.minIterations && linear.outOfTime && linear.outOfTime());
        if (report.outOfTime) break;
        if (followed == limits.following) {
            keepStates();
            ++report.rounds;
        }
        if (!turn(rz)) break; // nothing bends: numbers have run out
        advance();
    }
    report.mismatch = mismatch();
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        constraints.list[c].next = law(c, rows_[c].u).impulse;
        constraints.list[c].impulse = rows_[c].impulse;
    }
    return report;
}

void CoupledSolve::begin(const std::vector<std::vector<Grip>>& gripsOf)
{
    first_.assign(1, 0);
    sharing_.clear();
    compliance_.clear();
    double mass = 0.0;
    for (std::size_t b = 0; b < bodies_->size(); ++b) {
        CoupledBody& body = *(*bodies_)[b];
        body.begin(gripsOf[b]);
        mass += body.mass();
        const int offset = first_.back(), count = static_cast<int>(gripsOf[b].size());
        for (int g = 0; g < count; ++g) {
            compliance_.push_back(body.compliance(g));
            int same = g; // grips of one body come in the order of their nodes
            if (g > 0 &&
                gripsOf[b][static_cast<std::size_t>(g)].node == gripsOf[b][static_cast<std::size_t>(g) - 1].node)
                same = sharing_.back() - offset;
            sharing_.push_back(offset + same);
        }
        first_.push_back(offset + count);
    }
    at_.resize(sharing_.size());
    rows_.assign(constraints_->list.size(), {});
    smallest_ = mass * limits_->smallChange;
    energy_ = smallest_ * limits_->smallChange;
    patches_.clear();
    statesKept_ = false;
    restart_ = true;
}

Vec3 CoupledSolve::reaction(std::size_t c, Vec3 u) const
{
    const Constraint& constraint = constraints_->list[c];
    return constraint.impulse - times(rows_[c].stiffness, constraint.bias + u);
}

Projected CoupledSolve::law(std::size_t c, Vec3 u) const { return project(constraints_->list[c], reaction(c, u)); }

Vec3 CoupledSolve::lawAlong(std::size_t c, Vec3 u) const
{
    const Row& row = rows_[c];
    if (!statesKept_) return project(constraints_->list[c], reaction(c, u), row.cone).impulse;
    return row.state.active ? times({1.0, row.state.slip, row.state.slip}, reaction(c, u)) : row.state.impulse;
}

void CoupledSolve::gather(Read read)
{
    for (std::size_t b = 0; b < bodies_->size(); ++b)
        ((*bodies_)[b]->*read)(std::span(at_).subspan(static_cast<std::size_t>(first_[b]),
                                                      static_cast<std::size_t>(first_[b + 1] - first_[b])));
}

Vec3 CoupledSolve::velocityOf(std::size_t c) const
{
    const Constraint& constraint = constraints_->list[c];
    Vec3 sum;
    for (int g = constraint.first; g < constraint.first + constraint.count; ++g) {
        const WeightedGrip& grip = constraints_->grips[static_cast<std::size_t>(g)];
        sum += grip.weight * at_[static_cast<std::size_t>(grip.grip)];
    }
    return inFrame(constraint.frame, sum);
}

double CoupledSolve::multiply()
{
    double bend = 0.0;
    for (CoupledBody* body : *bodies_) bend += body->multiply();
    gather(&CoupledBody::readDirection);
    for (std::size_t c = 0; c < rows_.size(); ++c) rows_[c].along = velocityOf(c);
    return bend;
}

void CoupledSolve::firstGuess()
{
    // The last step's answer, or as much of it as is good under this step's forces and impulses.
    double slope = 0.0;
    const double bend = multiply();
    for (CoupledBody* body : *bodies_) slope += body->slope();
    const auto rise = [&](double t) {
        double sum = t * bend - slope;
        for (std::size_t c = 0; c < rows_.size(); ++c)
            sum -= dot(rows_[c].along, law(c, rows_[c].u + t * rows_[c].along).impulse);
        return sum;
    };
    double t = 0.0;
    const double atStart = rise(0.0), atOne = rise(1.0);
    if (bend > 0.0 && std::isfinite(atOne) && atStart < 0.0) {
        t = 1.0;
        if (!(std::abs(atOne) <= 0.5 * -atStart)) t = std::clamp(atStart / (atStart - atOne), 0.0, 2.0);
        if (atOne < atStart) t = 0.0;
    }
    for (CoupledBody* body : *bodies_) body->descend(t);
    for (Row& row : rows_) row.u += t * row.along;
    energy_ += t * t * std::max(0.0, bend);
    obey();
}

bool CoupledSolve::impulsesSettled() const
{
    // What z would still change: a good guess at the error, as the preconditioner is one at the matrix.
    double change = 0.0, all = 0.0;
    for (const Row& row : rows_) {
        change += lengthSquared(times(row.sigma, row.step));
        all += lengthSquared(row.impulse);
    }
    const double small = 0.01 * smallest_;
    return change <= limits_->tolerance * limits_->tolerance * std::max(all, small * small);
}

bool CoupledSolve::turn(double rz)
{
    double beta = 0.0;
    slope_ = rz;
    if (!restart_) {
        double bent = 0.0;
        for (CoupledBody* body : *bodies_) bent += body->bent();
        bent *= way_;
        for (const Row& row : rows_) bent -= dot(row.step, row.change);
        beta = -bent / (lastSlope_ - end_);
        slope_ = rz + beta * endNow_;
        if (!std::isfinite(beta) || !(slope_ > kSteepEnough * rz)) {
            beta = 0.0;
            slope_ = rz;
        }
    }
    restart_ = false;
    for (CoupledBody* body : *bodies_) body->turn(beta);
    own_ = 0.0;
    for (CoupledBody* body : *bodies_) own_ += body->multiply();
    bend_ = own_;
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        Row& row = rows_[c];
        row.along = row.step + beta * row.along;
        row.cone = std::max(0.0, constraints_->list[c].friction * row.impulse.x);
        bend_ += dot(row.along, times(row.sigma, row.along));
    }
    return bend_ > 0.0;
}

void CoupledSolve::advance()
{
    const auto slopeAt = [&](double way) {
        double sum = slope_ - way * own_;
        for (std::size_t c = 0; c < rows_.size(); ++c) {
            Row& row = rows_[c];
            row.change = lawAlong(c, row.u + way * row.along) - row.impulse;
            sum += dot(row.along, row.change);
        }
        return sum;
    };
    way_ = slope_ / bend_;
    end_ = slopeAt(way_);
    double low = 0.0, atLow = slope_, high = 0.0, atHigh = 0.0; // the slope falls all the way
    for (int look = 1; look < kLooks && std::abs(end_) > kFlatEnough * slope_; ++look) {
        (end_ > 0.0 ? low : high) = way_;
        (end_ > 0.0 ? atLow : atHigh) = end_;
        if (high > 0.0) {
            const double share = atLow / (atLow - atHigh);
            way_ = low + std::clamp(share, 0.1, 0.9) * (high - low);
        } else {
            const double straight = slope_ / (slope_ - end_);
            way_ *= straight > 1.0 && straight < 4.0 ? straight : 4.0;
        }
        end_ = slopeAt(way_);
    }
    energy_ += way_ * way_ * std::max(0.0, own_);
    for (CoupledBody* body : *bodies_) body->descend(way_);
    for (Row& row : rows_) row.u += way_ * row.along;
    obey();
    endNow_ = end_;
    for (const Row& row : rows_) endNow_ += dot(row.along, row.probe - row.change);
    lastSlope_ = slope_;
    if (!statesKept_) renewFilter();
}

void CoupledSolve::obey()
{
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        Row& row = rows_[c];
        if (!statesKept_) row.now = law(c, row.u);
        const Vec3 lawful = statesKept_ ? lawAlong(c, row.u) : row.now.impulse;
        row.probe = lawful - row.impulse;
        row.impulse = lawful;
    }
    giveImpulses(&CoupledBody::addToResidual, [&](std::size_t c) { return rows_[c].probe; });
}

void CoupledSolve::keepStates()
{
    makeFilter();
    statesKept_ = true;
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

bool CoupledSolve::raiseImpulses()
{
    const auto isRigid = [](const Constraint& constraint) { return constraint.give == 0.0; };
    bool needed = false;
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        const Constraint& constraint = constraints_->list[c];
        if (!isRigid(constraint) || rows_[c].stiffness.x == 0.0) continue;
        if (std::abs(constraint.impulse.x) >= constraint.most) continue; // it bears no more
        const Vec3 missed = constraint.bias + rows_[c].u;
        needed =
            needed || (constraint.friction < 0.0 ? length(missed) > constraint.slack : missed.x < -constraint.slack);
    }
    if (!needed) return false;
    for (std::size_t c = 0; c < rows_.size(); ++c)
        if (isRigid(constraints_->list[c])) constraints_->list[c].impulse = law(c, rows_[c].u).impulse;
    obey();
    makeFilter();
    restart_ = true;
    return true;
}

} // namespace filasofia::engine
