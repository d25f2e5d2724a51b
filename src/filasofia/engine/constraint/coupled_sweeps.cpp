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
// Friction of contacts that lie close to each other may go round in circles. If the second of such numbers of sweeps
// has not at least halved the change that is left, later ones do a part of what each constraint asks for.
constexpr int kWholeSweeps = 100;
constexpr double kPart = 0.3;

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
    if (row.stiffness.x == 0.0 || row.stiffness.y == 0.0) return false; // no body can move along the normal
    return row.law.bilateral() || row.impulse.x > 0.0 || reaction(c, u).x > 0.0;
}

/// Returns the change of the impulses relative to all.
double CoupledSolve::sweepOnce(double part, double& mismatch)
{
    double change = 0.0, all = 0.0, worst = 0.0, largest = 0.01 * smallest_;
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        Row& row = rows_[c];
        const Vec3 u = velocityIn(c) + sweeps_.velocityOf(c);
        if (!sweepsAwake(c, u)) continue;
        const Vec3 before = row.impulse;
        const Vec3 lawful = sweeps_.relax(c, row.law, row.stiffness, u, before);
        const Vec3 passed = part * (lawful - before);
        sweeps_.add(c, passed);
        row.impulse = part < 1.0 ? before + passed : lawful;
        row.passed += passed;
        change += lengthSquared(lawful - before);
        all += lengthSquared(row.impulse);
        worst = std::max(worst, length(lawful - before));
        largest = std::max(largest, length(row.impulse));
    }
    mismatch = worst / largest;
    const double small = 0.01 * smallest_;
    return std::sqrt(change / std::max(all, small * small));
}

bool CoupledSolve::sweep(CoupledReport& report)
{
    if (!sweeps_.begin(filter_.columns())) return false;
    solveForImpulses();
    for (Row& row : rows_) row.passed = {};
    double part = 1.0, halfway = 0.0;
    for (int done = 0; done < kMaxSweeps && report.iterations < limits_->linear.maxIterations && !report.outOfTime;
         ++done) {
        if (done == kWholeSweeps) halfway = report.residual;
        if (done == 2 * kWholeSweeps && report.residual > 0.5 * halfway) part = kPart;
        report.residual = sweepOnce(part, report.mismatch);
        ++report.iterations;
        report.converged = report.residual <= kSettled;
        if (report.converged) break;
        report.outOfTime = isOutOfTime(report.iterations);
    }
    passing_.clear();
    for (std::size_t c = 0; c < rows_.size(); ++c) {
        if (rows_[c].passed == Vec3{}) continue;
        impulses_[c] = inWorld(rows_[c].law.frame, rows_[c].passed);
        passing_.push_back(c);
    }
    push(1.0, passing_, [](const CoupledBody& body, std::span<const Vec3> impulses) {
        body.matrix->add(impulses, SolveVector::Residual);
    });
    solveForImpulses();
    return swept_ = true;
}

} // namespace filasofia::engine
