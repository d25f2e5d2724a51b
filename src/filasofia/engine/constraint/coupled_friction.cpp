// Lagged friction: the part of CoupledSolve that ends the swinging of friction and normal impulses.
#include "filasofia/engine/constraint/coupled_solve.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

constexpr int kCalm = 2; // a solve that takes at most this many iterations ends the lag

} // namespace

double CoupledSolve::coneAt(std::size_t c, Vec3 y) const
{
    return frictionLags_ && rows_[c].cone ? *rows_[c].cone : coneOf(rows_[c].law, y);
}

bool CoupledSolve::mayLag() const
{
    const auto rubs = [&](std::size_t c) { return rows_[c].law.friction > 0.0 && rows_[c].law.softness == 0.0; };
    return !limits_->sweeps && !activeSetFrozen_ && !frictionLags_ && std::ranges::any_of(active_, rubs);
}

void CoupledSolve::lagFriction()
{
    frictionLags_ = true;
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        const Constraint& last = constraint(c);
        if (last.kind == ConstraintKind::Contact && last.impulse.x > 0.0) rows_[c].cone = coneOf(last, last.impulse);
    }
}

void CoupledSolve::rememberLag(const CoupledReport& report)
{
    const bool ended = swept_ || (report.converged && report.iterations <= kCalm);
    for (const ConstraintRow& row : constraints_->list)
        if (row.constraint->kind == ConstraintKind::Contact)
            row.constraint->contact.cached.frictionLags = frictionLags_ && !ended;
}

} // namespace filasofia::engine
