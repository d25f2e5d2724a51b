// The preconditioner of CoupledSolve: the filter, the coarse correction, and their application.
#include "filasofia/engine/constraint/coupled_solve.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace filasofia::engine {
namespace {

// The filter is rebuilt if more than one contact in kOthers has become active or inactive, or has changed the fraction
// of the tangential impulse that its friction cone leaves by more than kOtherSlip. Where it is the inverse, the
// iteration is Newton's, and any such contact counts: heaps of frictionless balls took 158 iterations a step, now 5.
constexpr std::size_t kOthers = 64;
constexpr double kOtherSlip = 1.5;

// A link on a hinge can be pushed in some directions only. If a contact's normal were less than a milliradian away from
// those in which it cannot, the contact would need an unbounded force. Such contacts get no penalty.
constexpr double kStiff = 1e-6;

// [-] Links of one body whose joints move them against each other nearly across a contact's normal have no room, and
// friction jams them: if they can part by less than this share of all their relative motion, an angle of 18 degrees,
// the contact yields as one with what cannot move. Without, the shin of a robot that lay along its trunk, in the
// direction of the hip's axis, was pressed with 243 MN after 2 s.
constexpr double kParting = 0.1;

// A clamp of a steel rod bears moments with two nodes a millimetre apart: it must be as stiff as the rod itself. Beyond
// this factor over 1 / compliance the filter, a difference of large numbers, has no digits left.
constexpr double kExact = 1e5;

bool betweenRigid(const Constraint& constraint)
{
    return std::ranges::none_of(constraint.sides, [](const BodyPoint& side) { return side.of == BodyPoint::Of::Soft; });
}

/// What is left of the penalty of a constraint of which only one side can move, and what its carried impulse loses.
struct Trapped {
    double yielding = 1.0; ///< [-] factor on the penalty
    double loss = 0.0;     ///< [-] fraction of the carried normal impulse
};
/// The constraint's own, if all is rigid. They bound the impulse of a body that has no room by penalty over loss. A
/// smaller penalty needs the more of itself and the less loss for the same bound: with tissue in the island, a plate of
/// 0.2 kg that 20 N pressed on a floor sank through it.
Trapped trappedAt(const Constraint& constraint, double kappa)
{
    const Trapped rigid{constraint.trappedYielding, constraint.trappedLoss};
    if (kappa >= kRigidKappa) return rigid;
    const double yielding = std::min(1.0, rigid.yielding * kRigidKappa / kappa);
    return {yielding, rigid.loss * yielding / rigid.yielding * kappa / kRigidKappa};
}

} // namespace

std::size_t CoupledSolve::bodyOf(int point) const { return network().bodyOf(point); }

const BodySmoother& CoupledSolve::smootherAt(int& point) const
{
    const std::size_t body = bodyOf(point);
    point -= first_[body];
    return *(*bodies_)[body].smoother;
}

bool CoupledSolve::isExact(const ConstraintRow& row) const
{
    if (exact_ || !together_) return together_;
    return std::ranges::all_of(constraints_->pointsOf(row),
                               [&](WeightedPoint each) { return smootherAt(each.point).isExact(); });
}

double CoupledSolve::ownStiffness(const ConstraintRow& row)
{
    double sum = 0.0;
    for (auto [point, weight] : constraints_->pointsOf(row)) {
        const BodySmoother& smoother = smootherAt(point);
        columns_.clear();
        smoother.addColumns(point, columns_);
        for (const auto& [block, j] : columns_)
            sum += weight * weight * trace(j * smoother.block(block, block) * transpose(j));
    }
    return sum;
}

double CoupledSolve::parting(const ConstraintRow& row, const std::array<Side, 2>& sides) const
{
    const auto isLink = [](const BodyPoint& side) { return side.of == BodyPoint::Of::Rigid; };
    if (!sides[0].body || sides[0].body != sides[1].body) return 1.0;
    if (!std::ranges::all_of(row.constraint->sides, isLink)) return 1.0;
    const int first = first_[*sides[0].body];
    const BodySmoother& smoother = *(*bodies_)[*sides[0].body].smoother;
    Mat3 relative; // compliance of one side against the other
    for (const WeightedPoint& one : constraints_->pointsOf(row))
        for (const WeightedPoint& two : constraints_->pointsOf(row))
            relative += one.weight * two.weight * smoother.between(one.point - first, two.point - first);
    const Vec3 normal = row.constraint->frame[0];
    const double all = trace(relative);
    return all > 0.0 ? dot(normal, relative * normal) / all : 0.0;
}

std::array<CoupledSolve::Side, 2> CoupledSolve::sidesOf(const ConstraintRow& row) const
{
    const Vec3 normal = row.constraint->frame[0];
    std::array<Side, 2> sides;
    std::array<double, 2> largest = {}; // where a surface reaches beyond its tetrahedra, some weights change their sign
    for (const WeightedPoint& at : constraints_->pointsOf(row)) {
        const Mat3& own = compliance_[static_cast<std::size_t>(at.point)];
        Side& side = sides[sideOf(at)];
        if (std::abs(at.weight) > largest[sideOf(at)]) {
            largest[sideOf(at)] = std::abs(at.weight);
            side.body = bodyOf(at.point);
        }
        side.along += at.weight * at.weight * dot(normal, own * normal);
        side.inAll += at.weight * at.weight * trace(own);
    }
    return sides;
}

void CoupledSolve::chooseStiffness()
{
    double heaviest = 0.0;
    for (const double mass : masses_) heaviest = std::max(heaviest, mass);
    sides_.clear();
    for (const ConstraintRow& row : constraints_->list) sides_.push_back(sidesOf(row));
    findHolds();
    findBurdens();
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        const ConstraintRow& row = constraints_->list[c];
        const Constraint& each = *row.constraint;
        const auto& [one, two] = sides_[c];
        double compliance = one.along + two.along;
        const bool bothMove = one.along > kStiff * one.inAll && two.along > kStiff * two.inAll &&
                              (each.bilateral() || parting(row, sides_[c]) > kParting);
        if (!each.bilateral() && !(compliance > kStiff * (one.inAll + two.inAll))) compliance = 0.0;
        const bool spring = each.softness > 0.0;
        const bool exact = isExact(row);
        const Kappa& kappas = exact ? limits_->exactKappa : limits_->kappa;
        const double kappa = each.bilateral() ? kappas.holding : kappas.contact;
        const Trapped trapped = bothMove ? Trapped{} : trappedAt(each, kappa);
        const double pressed = exact || spring ? compliance : compliancePressed(c, kappa);
        double rigid = std::min(each.yielding * trapped.yielding * kappa / pressed, kExact / compliance);
        if (exact && each.bilateral()) rigid = std::max(rigid, std::min(ownStiffness(row), kExact / compliance));
        // A link's drive has inertia that its mass does not show. With tissue in the island a needle between jaws must
        // bear it, too.
        const double heavier = bothMove ? 1.0 / std::min(one.along, two.along) : 0.0;
        rigid = std::max(rigid, limits_->bearing * std::max(heaviest, heavier));
        if (exact && !each.bilateral() && betweenRigid(each))
            rigid = std::max(rigid, std::min(heavier, kExact / compliance));
        if (!(compliance > 0.0)) rigid = 0.0;
        const double along = spring ? each.softness : rigid;
        double tangential = spring && each.bilateral() ? each.softness : rigid;
        if (each.kind == ConstraintKind::Shaft) tangential *= each.across;
        rows_[c].stiffness = {along, tangential, tangential};
        const double loss = bothMove ? each.lostLoss : trapped.loss;
        rows_[c].law.impulse.x *= 1.0 - loss;
        rows_[c].trapped = loss > 0.0;
        if (compliance == 0.0) rows_[c].law.impulse = {}; // no body can move along the normal
        normals_[c] = {.axis = each.frame[0],
                       .impulse = rows_[c].law.impulse.x,
                       .stiffness = along,
                       .velocity = each.bias.x + dot(each.frame[0], velocities_[c]),
                       .sleeps = !each.bilateral()};
    }
}

void CoupledSolve::makeFilter()
{
    shares_.assign(sharing_.size(), 0.0);
    const auto shareOf = [&](std::size_t k) -> double& {
        const int point = constraints_->points[k].point;
        return shares_[static_cast<std::size_t>(sharing_[static_cast<std::size_t>(point)])];
    };
    const auto firstOf = [&](std::size_t c) { return static_cast<std::size_t>(constraints_->list[c].first); };
    const auto endOf = [&](std::size_t c) {
        return firstOf(c) + static_cast<std::size_t>(constraints_->list[c].count);
    };
    for (std::size_t c : active_) filters_[c] = {};
    active_.clear();
    others_ = 0;
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        if (normals_[c].sleeps && !normals_[c].active && !rows_[c].state.active) continue;
        Row& row = rows_[c];
        row.state = normals_[c].sleeps ? Projected{} : row.now;
        normals_[c].active = row.state.active;
        row.sigma = times(row.stiffness, sharesOf(row.law, row.state));
        if (row.sigma != Vec3{}) active_.push_back(c);
        for (std::size_t k = firstOf(c); row.state.active && k < endOf(c); ++k)
            shareOf(k) += std::abs(constraints_->points[k].weight);
    }
    perRow_.assign(rows_.size(), Vec3{});
    for (std::size_t c : active_) perRow_[c] = rows_[c].sigma;
    together_ = together_ && filter_.build(perRow_);
    if (together_ && joined_) return; // else the coarse levels need the filters of single constraints
    for (std::size_t c : active_) {
        const Row& row = rows_[c];
        Mat3 compliance;
        for (std::size_t k = firstOf(c); k < endOf(c); ++k) {
            const WeightedPoint& at = constraints_->points[k];
            compliance += shareOf(k) * std::abs(at.weight) * compliance_[static_cast<std::size_t>(at.point)];
        }
        const Mat3 frame = asMatrix(row.law.frame);
        const Mat3 sigma = transpose(frame) * (Mat3::diagonal(row.sigma) * frame);
        filters_[c] = inverse(Mat3::identity() + sigma * compliance) * sigma;
    }
}

bool CoupledSolve::isOther(const Projected& now, const Projected& then)
{
    return now.active != then.active || now.slip > kOtherSlip * then.slip || then.slip > kOtherSlip * now.slip;
}

void CoupledSolve::renewFilter()
{
    if (others_ <= (exact_ ? 0 : rows_.size() / kOthers)) return;
    makeFilter();
    restart_ = restart_ || exact_;
}

void CoupledSolve::correctCoarseLevels() { correction_.make(network(), patchMotions(network())); }

void CoupledSolve::blendRotations()
{
    if (std::exchange(blended_, true)) return; // coarse levels that know all constraints are not made twice
    bool changed = false;
    for (const CoupledBody& body : *bodies_) changed = body.preconditioner->blendRotations() || changed;
    if (!changed) return;
    if (correction_.hasMotions()) correctCoarseLevels();
    restart_ = true;
}

void CoupledSolve::joinConstraints()
{
    if (joined_) return;
    joined_ = true;
    if (std::vector<ConstraintMotions> motions = coarseNodeMotions(network()); !motions.empty())
        correction_.make(network(), std::move(motions));
    if (together_) return;
    together_ = true;
    filter_.begin(*bodies_, first_, *constraints_);
    makeFilter();
}

void CoupledSolve::applyFilter(const std::vector<Vec3>& velocities)
{
    if (!together_) {
        for (std::size_t c : active_) impulses_[c] = filters_[c] * velocities[c];
        return;
    }
    std::ranges::fill(perRow_, Vec3{});
    for (std::size_t c : active_) perRow_[c] = inFrame(rows_[c].law.frame, velocities[c]);
    filter_.apply(perRow_);
    for (std::size_t c : active_) impulses_[c] = inWorld(rows_[c].law.frame, perRow_[c]);
}

void CoupledSolve::readActive(SolveVector from, std::vector<Vec3>& to)
{
    read(from);
    for (std::size_t c : active_) to[c] = velocityOf(c);
}

double CoupledSolve::precondition()
{
    for (const CoupledBody& body : *bodies_) body.preconditioner->smooth();
    readActive(SolveVector::Smoothed, smoothed_);
    if (!exact_) { // else there is no coarse level
        applyFilter(smoothed_);
        push(-1.0, active_, [](const CoupledBody& body, std::span<const Vec3> impulses) {
            body.matrix->add(impulses, SolveVector::CoarseResidual);
        });
    }
    double rz = 0.0;
    if (!correction_.empty()) correction_.project(*bodies_);
    for (std::size_t b = 0; b < bodies_->size(); ++b)
        rz += (*bodies_)[b].preconditioner->applyCoarse(correction_.shares(b));
    readActive(SolveVector::Preconditioned, steps_);
    applyFilter(steps_);
    for (std::size_t c : active_) rz -= dot(smoothed_[c], impulses_[c]);
    push(1.0, active_, [](const CoupledBody& body, std::span<const Vec3> impulses) {
        body.preconditioner->subtractSmoothed(impulses);
    });
    read(SolveVector::Preconditioned);
    for (std::size_t c = 0; c < rows_.size(); ++c) steps_[c] = velocityOf(c);
    return rz;
}

} // namespace filasofia::engine
