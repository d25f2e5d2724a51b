// CoupledSolve by sweeps over the constraints, where Newton's iteration does not end.
#include "filasofia/engine/constraint/coupled_solve.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

// [-] Sweeps end when one changes the impulses by this share of all. Heaps of 36 to 72 boxes that fall together get
// there in all but one step of a hundred; with a tenth of it, in all but one of ten.
constexpr double kSettled = 1e-3;
constexpr int kMaxSweeps = 400;

} // namespace

/// x becomes the solution for the impulses that act.
void CoupledSolve::solveForImpulses()
{
    for (const CoupledBody& body : *bodies_) {
        body.preconditioner->smooth();
        body.preconditioner->applyCoarse({});
        body.matrix->updateDirection(0.0);
    }
    multiply();
    moveAlong(1.0);
}

bool CoupledSolve::sweepsAwake(std::size_t c, Vec3 u) const
{
    const Row& row = rows_[c];
    if (row.stiffness.x == 0.0) return false; // no body can move along the normal
    return row.law.bilateral() || row.impulse.x > 0.0 || reaction(c, u).x > 0.0;
}

/// Returns the change of the impulses relative to all.
double CoupledSolve::sweepOnce(double& mismatch)
{
    double change = 0.0, all = 0.0, worst = 0.0, largest = 0.01 * smallest_;
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        Row& row = rows_[c];
        const Vec3 u = velocityIn(c) + sweeps_.velocityOf(c);
        if (!sweepsAwake(c, u)) continue;
        const Vec3 impulse = sweeps_.relax(c, row.law, row.stiffness, u, row.impulse);
        const Vec3 passed = impulse - row.impulse;
        sweeps_.add(c, passed);
        row.impulse = impulse;
        row.passed += passed;
        change += lengthSquared(passed);
        all += lengthSquared(impulse);
        worst = std::max(worst, length(passed));
        largest = std::max(largest, length(impulse));
    }
    mismatch = worst / largest;
    const double small = 0.01 * smallest_;
    return std::sqrt(change / std::max(all, small * small));
}

bool CoupledSolve::sweep(CoupledReport& report)
{
    solveForImpulses();
    for (Row& row : rows_) row.passed = {};
    sweeps_.begin(filter_.columns());
    for (int done = 0; done < kMaxSweeps && report.iterations < limits_->linear.maxIterations && !report.outOfTime;
         ++done) {
        report.residual = sweepOnce(report.mismatch);
        ++report.iterations;
        report.converged = report.residual <= kSettled;
        if (report.converged) break;
        report.outOfTime = isOutOfTime(report.iterations);
    }
    passing_.clear();
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        normals_[c].sleeps = !rows_[c].law.bilateral() && rows_[c].impulse == Vec3{};
        if (rows_[c].passed == Vec3{}) continue;
        impulses_[c] = inWorld(rows_[c].law.frame, rows_[c].passed);
        passing_.push_back(c);
    }
    push(1.0, passing_, [](const CoupledBody& body, std::span<const Vec3> impulses) {
        body.matrix->add(impulses, SolveVector::Residual);
    });
    solveForImpulses();
    swept_ = report.outOfTime || report.mismatch <= kLawful;
    return swept_;
}

} // namespace filasofia::engine
