#include "filasofia/engine/contact/coupled_solve.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

// In every round but the last: more of them for a law that the next round will change do not pay. Measured: three
// instead of growing numbers save a third of the iterations of a fast tool, and leave a smaller mismatch.
constexpr int kIterationsPerRound = 3;

// A link on a hinge can be pushed in some directions only. A contact whose normal is less than a milliradian away from
// those in which it cannot would ask for forces without end.
constexpr double kStiff = 1e-6;

Vec3 times(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
Vec3 mixed(Vec3 a, Vec3 b, double t) { return a + t * (b - a); }

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

    CoupledReport report;
    int raises = 0;
    for (int round = 1;; ++round) {
        const bool last = round == limits.rounds;
        makeFilter();
        report.converged = iterate(last ? limits.linear.maxIterations : kIterationsPerRound, report);
        ++report.rounds;
        const bool solved = agree(report) && report.converged;
        if (report.outOfTime || !(report.residual < 1.0)) break; // not a number: whoever moves the bodies will see it
        if (solved && (raises == limits.raises || !raiseImpulses())) break;
        if (!solved && last) break;
        if (solved) {
            ++raises;
            round = 0; // a new problem, from this one's answer
        }
        shorten();
    }
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        constraints.list[c].next = law(c, rows_[c].u).impulse;
        constraints.list[c].impulse = rows_[c].linear;
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
}

void CoupledSolve::chooseStiffness()
{
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        const Constraint& constraint = constraints_->list[c];
        double compliance = 0.0, anyDirection = 0.0;
        for (int g = 0; g < constraint.count; ++g) {
            const WeightedGrip& grip = constraints_->grips[static_cast<std::size_t>(constraint.first + g)];
            const Vec3 n = constraint.frame[0];
            const Mat3& give = compliance_[static_cast<std::size_t>(grip.grip)];
            compliance += grip.weight * grip.weight * dot(n, give * n);
            anyDirection += grip.weight * grip.weight * trace(give);
        }
        if (constraint.friction >= 0.0 && !(compliance > kStiff * anyDirection)) compliance = 0.0;
        const bool spring = constraint.give > 0.0, held = constraint.friction < 0.0;
        const double kappa = held ? limits_->holding : limits_->stiffening;
        const double rigid = compliance > 0.0 ? kappa / compliance : 0.0;
        const double normal = spring ? constraint.give : rigid, tangential = spring && held ? constraint.give : rigid;
        rows_[c].stiffness = {normal, tangential, tangential};
        rows_[c].u = constraint.start;
        if (compliance == 0.0) constraints_->list[c].impulse = {}; // nothing that could give way: it has no say
    }
}

Projected CoupledSolve::law(std::size_t c, Vec3 u) const
{
    const Constraint& constraint = constraints_->list[c];
    return project(constraint, constraint.impulse - times(rows_[c].stiffness, constraint.bias + u));
}

void CoupledSolve::makeFilter()
{
    shares_.assign(sharing_.size(), 0.0);
    const auto gripsAt = [&](const Constraint& constraint) {
        return std::span(constraints_->grips)
            .subspan(static_cast<std::size_t>(constraint.first), static_cast<std::size_t>(constraint.count));
    };
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        const Constraint& constraint = constraints_->list[c];
        const Projected now = law(c, rows_[c].u);
        rows_[c].sigma = now.active ? times(rows_[c].stiffness, {1.0, now.slip, now.slip}) : Vec3{};
        if (!now.active) continue;
        for (const WeightedGrip& grip : gripsAt(constraint))
            shares_[static_cast<std::size_t>(sharing_[static_cast<std::size_t>(grip.grip)])] += std::abs(grip.weight);
    }
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        Row& row = rows_[c];
        row.filter = {};
        if (row.sigma.x == 0.0) continue;
        const Constraint& constraint = constraints_->list[c];
        const Mat3 turn{constraint.frame[0], constraint.frame[1], constraint.frame[2]};
        Mat3 give;
        for (const WeightedGrip& grip : gripsAt(constraint)) {
            const auto g = static_cast<std::size_t>(grip.grip);
            const double share = std::abs(grip.weight) * shares_[static_cast<std::size_t>(sharing_[g])];
            give += share * (turn * compliance_[g] * transpose(turn));
        }
        const Mat3 sigma{{{row.sigma.x, 0.0, 0.0}, {0.0, row.sigma.y, 0.0}, {0.0, 0.0, row.sigma.z}}};
        row.filter = inverse(Mat3::identity() + sigma * give) * sigma;
    }
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

template <class ImpulseOf> void CoupledSolve::giveImpulses(Add add, const ImpulseOf& impulseOf)
{
    std::fill(at_.begin(), at_.end(), Vec3{});
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        const Constraint& constraint = constraints_->list[c];
        const Vec3 impulse = inWorld(constraint.frame, impulseOf(c));
        for (int g = constraint.first; g < constraint.first + constraint.count; ++g) {
            const WeightedGrip& grip = constraints_->grips[static_cast<std::size_t>(g)];
            at_[static_cast<std::size_t>(grip.grip)] += grip.weight * impulse;
        }
    }
    for (std::size_t b = 0; b < bodies_->size(); ++b)
        ((*bodies_)[b]->*add)(std::span(at_).subspan(static_cast<std::size_t>(first_[b]),
                                                     static_cast<std::size_t>(first_[b + 1] - first_[b])));
}

double CoupledSolve::multiply()
{
    double bend = 0.0;
    for (CoupledBody* body : *bodies_) bend += body->multiply();
    gather(&CoupledBody::readDirection);
    for (std::size_t c = 0; c < rows_.size(); ++c) rows_[c].along = velocityOf(c);
    return bend;
}

void CoupledSolve::descend(double alpha)
{
    for (CoupledBody* body : *bodies_) body->descend(alpha);
    for (Row& row : rows_) {
        row.u += alpha * row.along;
        row.linear -= alpha * times(row.sigma, row.along);
    }
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
    descend(t); // sigma is still zero
    energy_ += t * t * std::max(0.0, bend);
    for (std::size_t c = 0; c < rows_.size(); ++c) rows_[c].linear = law(c, rows_[c].u).impulse;
    giveImpulses(&CoupledBody::addToResidual, [&](std::size_t c) { return rows_[c].linear; });
}

double CoupledSolve::precondition()
{
    for (CoupledBody* body : *bodies_) body->smooth();
    gather(&CoupledBody::readSmoothed);
    for (std::size_t c = 0; c < rows_.size(); ++c) rows_[c].probe = velocityOf(c);
    giveImpulses(&CoupledBody::addToSpread, [&](std::size_t c) { return -(rows_[c].filter * rows_[c].probe); });
    double rz = 0.0;
    for (CoupledBody* body : *bodies_) rz += body->spread();
    gather(&CoupledBody::readSpread);
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        Row& row = rows_[c];
        const Vec3 filtered = row.filter * velocityOf(c);
        rz -= dot(row.probe, filtered);
        row.probe = filtered;
    }
    giveImpulses(&CoupledBody::subtractSmoothed, [&](std::size_t c) { return rows_[c].probe; });
    return rz;
}

bool CoupledSolve::iterate(int cap, CoupledReport& report)
{
    const linalg::SolveLimits& limits = limits_->linear;
    for (CoupledBody* body : *bodies_) body->save();
    for (Row& row : rows_) {
        row.uSaved = row.u;
        row.linearSaved = row.linear;
    }
    double rz = 0.0;
    for (int made = 0;; ++made, ++report.iterations) {
        const double rzNew = precondition(); // the energy of the error, as the preconditioner sees it
        const bool number = rzNew >= 0.0 && std::isfinite(rzNew);
        report.residual = rzNew == 0.0 ? 0.0 : number ? std::sqrt(rzNew / (rzNew + energy_)) : 1.0;
        if (report.residual <= limits.tolerance) return true;
        if (!number || report.iterations >= limits.maxIterations) return false;
        if (made >= cap) { // what touches may have changed: where it has not, go on
            if (!agree(report)) return false;
            cap = limits.maxIterations;
        }
        report.outOfTime = report.iterations == limits.stopAt ||
                           (report.iterations >= limits.minIterations && limits.outOfTime && limits.outOfTime());
        if (report.outOfTime) return false;

        const double beta = made == 0 ? 0.0 : rzNew / rz;
        rz = rzNew;
        for (CoupledBody* body : *bodies_) body->turn(beta);
        const double own = multiply();
        double bend = own;
        for (const Row& row : rows_) bend += dot(row.along, times(row.sigma, row.along));
        giveImpulses(&CoupledBody::addToProduct, [&](std::size_t c) { return times(rows_[c].sigma, rows_[c].along); });
        if (!(bend > 0.0)) return true; // what we have is the best there is
        descend(rz / bend);
        energy_ += rz / bend * (rz / bend) * std::max(0.0, own);
    }
}

bool CoupledSolve::agree(CoupledReport& report)
{
    double worst = 0.0, largest = 0.01 * smallest_;
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        const Vec3 lawful = law(c, rows_[c].u).impulse;
        worst = std::max(worst, length(lawful - rows_[c].linear));
        largest = std::max(largest, length(lawful));
    }
    report.mismatch = worst / largest;
    return worst <= limits_->tolerance * largest;
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
    for (std::size_t c = 0; needed && c < rows_.size(); ++c)
        if (isRigid(constraints_->list[c])) constraints_->list[c].impulse = law(c, rows_[c].u).impulse;
    return needed;
}

void CoupledSolve::shorten()
{
    // The energy's slope along the way of this round: linear in what the bodies have, piecewise in what constraints do.
    double atSaved = 0.0, atEnd = 0.0;
    for (CoupledBody* body : *bodies_) {
        const auto [saved, now] = body->rise();
        atSaved -= saved;
        atEnd -= now;
    }
    for (Row& row : rows_) {
        row.along = row.u - row.uSaved;
        atSaved += dot(row.along, row.linearSaved);
        atEnd += dot(row.along, row.linear);
    }
    const auto slope = [&](double t) {
        double sum = atSaved + t * (atEnd - atSaved);
        for (std::size_t c = 0; c < rows_.size(); ++c)
            sum -= dot(rows_[c].along, law(c, rows_[c].uSaved + t * rows_[c].along).impulse);
        return sum;
    };
    double t = 1.0;
    const double first = slope(0.0), last = slope(1.0);
    if (first < 0.0 && last > 0.1 * -first) {
        double low = 0.0, high = 1.0;
        for (int k = 0; k < 8; ++k) (slope(t = 0.5 * (low + high)) > 0.0 ? high : low) = t;
        for (CoupledBody* body : *bodies_) body->goBack(t);
    }
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        Row& row = rows_[c];
        row.u = mixed(row.uSaved, row.u, t);
        row.linear = mixed(row.linearSaved, row.linear, t);
        row.probe = law(c, row.u).impulse - row.linear;
        row.linear += row.probe;
    }
    giveImpulses(&CoupledBody::addToResidual, [&](std::size_t c) { return rows_[c].probe; });
}

} // namespace filasofia::engine
