// What constraints push with beyond their penalty: the part of CoupledSolve that updates multipliers at the end of a
// solve, and says which the next step starts from.
#include "filasofia/engine/constraint/coupled_solve.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

// Multipliers are updated again if the last update has brought the worst constraint down to this share; while it is off
// by more than kFarOff tolerances, any help counts, for up to kMostUpdates. A thread that slipped on tissue in one step
// fell back on other contacts: the first update brought them from 65 tolerances to 36, and it ended 1.6 diameters deep.
constexpr double kUpdateHelps = 0.5, kStillHelps = 0.95, kFarOff = 5.0;
constexpr int kMostUpdates = 10;
// [-] Tolerances by which a weld may be off if its solve takes no step. At 1, a tip of 0.01 mg on a bar of 10 g drifted
// at 0.1 mm/s until it was 0.1 mm off, again and again.
constexpr double kHeldWell = 0.02;
// [-] Tolerances by which a weld may miss what it is to do: 0.2 mm in a step, or a pair that stays 2 mm apart. A thread
// came 8 mm out of the tissue that it was tied to, in steps that all had converged.
constexpr double kApart = 20.0;

} // namespace

double CoupledSolve::missOf(std::size_t c) const
{
    const ConstraintLaw& each = rows_[c].law;
    if (each.softness != 0.0 || rows_[c].stiffness.x == 0.0) return 0.0;
    if (std::abs(each.impulse.x) >= each.maxImpulse) return 0.0; // the constraint has yielded
    const Vec3 missed = each.bias + velocityIn(c);
    // What was trapped and is let go would fly off by the impulse that it was held with.
    const bool thrown = rows_[c].trapped && rows_[c].impulse.x > 0.0 && missed.x > 0.0;
    return (each.bilateral() ? length(missed) : thrown ? missed.x : -missed.x) / each.tolerance;
}

bool CoupledSolve::weldsAreWithin(double tolerances) const
{
    for (std::size_t c = 0; c < rows_.size(); ++c)
        if (rows_[c].law.kind == ConstraintKind::Weld && missOf(c) > tolerances) return false;
    return true;
}

bool CoupledSolve::holdsWell() const { return weldsAreWithin(kHeldWell); }
bool CoupledSolve::holdsTogether() const { return weldsAreWithin(kApart); }

bool CoupledSolve::updateMultipliers(int made)
{
    double worst = 0.0; // relative to the tolerance
    for (std::size_t c = 0; c < rows_.size(); ++c) worst = std::max(worst, missOf(c));
    const bool farOff = worst > kFarOff;
    if (made >= (farOff ? std::max(kMostUpdates, limits_->multiplierUpdates) : limits_->multiplierUpdates))
        return false;
    if (worst <= 1.0 || worst > (farOff ? kStillHelps : kUpdateHelps) * missed_) return false;
    missed_ = worst;
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        if (rows_[c].law.softness != 0.0) continue;
        rows_[c].law.impulse = staysAsleep(c, 0.0) ? Vec3{} : law(c, velocityIn(c)).impulse;
        normals_[c].impulse = rows_[c].law.impulse.x;
    }
    beginAnew();
    return true;
}

void CoupledSolve::beginAnew()
{
    projectImpulses();
    makeFilter();
    restart_ = true;
}

Vec3 CoupledSolve::carried(std::size_t c) const
{
    if (swept_) return rows_[c].impulse;
    if (staysAsleep(c, 0.0)) return {};
    // Where the law was linearised in a state that does not hold, it would ask for impulses that are many times those
    // that act: the next step threw three boxes of some grams apart at 2 m/s.
    const Vec3 impulse = rows_[c].impulse;
    return activeSetFrozen_ ? project(rows_[c].law, impulse, coneAt(c, impulse)).impulse
                            : law(c, velocityIn(c)).impulse;
}

} // namespace filasofia::engine
