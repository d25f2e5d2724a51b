#include "filasofia/engine/constraint/coupled_solve.h"

#include <algorithm>
#include <cmath>
#include <utility>

/// The preconditioner of the coupled solve.
namespace filasofia::engine {
namespace {

// The filter is made anew where one in so many contacts has begun or ended, or its cone leaves another share of
// friction.
constexpr std::size_t kOthers = 64;
constexpr double kOtherSlip = 1.5;

// A link on a hinge can be pushed in some directions only. A contact whose normal is less than a milliradian away from
// those in which it cannot would ask for forces without end.
constexpr double kStiff = 1e-6;

} // namespace

void CoupledSolve::chooseStiffness()
{
    give_.resize(constraints_->grips.size());
    double heaviest = 0.0;
    for (const CoupledBody* body : *bodies_) heaviest = std::max(heaviest, body->mass());
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        const Constraint& constraint = constraints_->list[c];
        const Mat3 turn{constraint.frame[0], constraint.frame[1], constraint.frame[2]};
        double compliance = 0.0, anyDirection = 0.0;
        for (int g = constraint.first; g < constraint.first + constraint.count; ++g) {
            const WeightedGrip& grip = constraints_->grips[static_cast<std::size_t>(g)];
            const Mat3 give = turn * compliance_[static_cast<std::size_t>(grip.grip)] * transpose(turn);
            compliance += grip.weight * grip.weight * give[0].x;
            anyDirection += grip.weight * grip.weight * trace(give);
            give_[static_cast<std::size_t>(g)] = std::abs(grip.weight) * give;
        }
        if (constraint.friction >= 0.0 && !(compliance > kStiff * anyDirection)) compliance = 0.0;
        const bool spring = constraint.give > 0.0, held = constraint.friction < 0.0;
        const double kappa = held ? limits_->holding : limits_->stiffening;
        const double rigid = compliance > 0.0 ? std::max(kappa / compliance, limits_->bearing * heaviest) : 0.0;
        const double normal = spring ? constraint.give : rigid, tangential = spring && held ? constraint.give : rigid;
        rows_[c].stiffness = {normal, tangential, tangential};
        rows_[c].u = constraint.start;
        if (compliance == 0.0) constraints_->list[c].impulse = {}; // nothing that could give way: it has no say
    }
}

void CoupledSolve::makeFilter()
{
    shares_.assign(sharing_.size(), 0.0);
    filters_.resize(rows_.size());
    const auto gripsOf = [&](std::size_t c) {
        const Constraint& constraint = constraints_->list[c];
        return std::pair(static_cast<std::size_t>(constraint.first),
                         static_cast<std::size_t>(constraint.first + constraint.count));
    };
    const auto shareOf = [&](std::size_t g) -> double& {
        return shares_[static_cast<std::size_t>(sharing_[static_cast<std::size_t>(constraints_->grips[g].grip)])];
    };
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        Row& row = rows_[c];
        row.state = row.now;
        row.sigma = row.state.active ? times(row.stiffness, {1.0, row.state.slip, row.state.slip}) : Vec3{};
        filters_[c] = {};
        const auto [first, end] = gripsOf(c);
        for (std::size_t g = first; row.state.active && g < end; ++g)
            shareOf(g) += std::abs(constraints_->grips[g].weight);
    }
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        Row& row = rows_[c];
        if (row.sigma.x == 0.0) continue;
        const auto [first, end] = gripsOf(c);
        Mat3 give;
        for (std::size_t g = first; g < end; ++g) give += shareOf(g) * give_[g];
        const Mat3 sigma{{{row.sigma.x, 0.0, 0.0}, {0.0, row.sigma.y, 0.0}, {0.0, 0.0, row.sigma.z}}};
        filters_[c] = inverse(Mat3::identity() + sigma * give) * sigma;
    }
}

void CoupledSolve::renewFilter()
{
    const auto isOther = [](const Row& row) {
        const Projected &now = row.now, &then = row.state;
        return now.active != then.active || now.slip > kOtherSlip * then.slip || then.slip > kOtherSlip * now.slip;
    };
    const auto others = static_cast<std::size_t>(std::ranges::count_if(rows_, isOther));
    if (others * kOthers > rows_.size()) makeFilter();
}

void CoupledSolve::correctCoarseLevels() { patches_.make(*bodies_, first_, *constraints_, filters_); }

double CoupledSolve::precondition()
{
    for (CoupledBody* body : *bodies_) body->smooth();
    gather(&CoupledBody::readSmoothed);
    for (std::size_t c = 0; c < rows_.size(); ++c) rows_[c].probe = velocityOf(c);
    giveImpulses(&CoupledBody::addToSpread, [&](std::size_t c) { return -(filters_[c] * rows_[c].probe); });
    double rz = 0.0;
    if (!patches_.empty()) patches_.weigh(*bodies_);
    for (std::size_t b = 0; b < bodies_->size(); ++b) rz += (*bodies_)[b]->spread(patches_.shares(b));
    gather(&CoupledBody::readSpread);
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        Row& row = rows_[c];
        const Vec3 filtered = filters_[c] * velocityOf(c);
        rz -= dot(row.probe, filtered);
        row.probe = filtered;
    }
    giveImpulses(&CoupledBody::subtractSmoothed, [&](std::size_t c) { return rows_[c].probe; });
    gather(&CoupledBody::readSpread);
    for (std::size_t c = 0; c < rows_.size(); ++c) rows_[c].step = velocityOf(c);
    return rz;
}

} // namespace filasofia::engine
