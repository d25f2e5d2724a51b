#include "filasofia/linalg/matrix_free_cg.h"

#include "filasofia/linalg/node_parts.h"

#include <algorithm>
#include <cmath>

namespace filasofia::linalg {

MatrixFreeCg::MatrixFreeCg(int unknownBlocks, int pinnedBlocks)
    : z_(unknownBlocks), p_(unknownBlocks, pinnedBlocks), q_(unknownBlocks),
      sums_(static_cast<std::size_t>(nodeParts(unknownBlocks).count()))
{
}

NodeSolveReport MatrixFreeCg::solve(const NodeSystem& system, NodeArray& x, const SolveLimits& limits, WorkerPool& pool)
{
    NodeArray& r = system.r;
    NodeSolveReport report;
    if (system.squaredNorm == 0.0 || !std::isfinite(system.squaredNorm)) { // nothing to solve, or nothing that could be
        x.setZero();
        report.residual = system.squaredNorm == 0.0 ? 0.0 : 1.0;
        report.converged = system.squaredNorm == 0.0;
        return report;
    }
    const Parts parts = nodeParts(x.blocks());
    const auto step = [&](double alpha) {
        const auto length = static_cast<float>(alpha);
        return sumOfParts(pool, parts, sums_, [&](Blocks blocks) { return stepAlong(length, p_, q_, x, r, blocks); });
    };

    // The first guess is the last step's answer, times the one factor that makes its error smallest.
    std::swap(x, p_); // both extend over the pinned nodes
    x.setZero();
    const double guessCurvature = system.a.multiply(p_, q_, pool);
    const double derivative = sumOfParts(pool, parts, sums_, [&](Blocks blocks) { return dot(p_, r, blocks); });
    const double small = system.mass * limits.smallAnswer * limits.smallAnswer;
    double energy = 0.0; // x . A x
    if (guessCurvature > 0.0 && std::isfinite(guessCurvature) && std::isfinite(derivative / guessCurvature)) {
        step(derivative / guessCurvature);
        energy = derivative * derivative / guessCurvature;
    } else {
        p_.setZero(); // numbers that are not finite would stay in all later directions
    }

    for (double rz = 0.0;; ++report.iterations) {
        const bool anew = report.iterations == kBlendAfter && system.m.blendRotations();
        const double rzNew = system.m.apply(r, z_, pool); // the energy of the error, as the preconditioner sees it
        const bool number = rzNew >= 0.0 && std::isfinite(rzNew);
        report.residual = rzNew == 0.0 ? 0.0 : number ? std::sqrt(rzNew / (rzNew + std::max(energy, small))) : 1.0;
        report.converged = report.residual <= limits.tolerance;
        report.small = energy < small;
        if (report.converged || !number) break;
        if (report.iterations >= limits.maxIterations) break;
        report.outOfTime = report.iterations == limits.stopAt ||
                           (report.iterations >= limits.minIterations && limits.outOfTime && limits.outOfTime());
        if (report.outOfTime) break;

        const float beta = report.iterations == 0 || anew ? 0.0f : static_cast<float>(rzNew / rz);
        rz = rzNew;
        pool.run(parts.count(), [&](int part) { updateDirection(z_, beta, p_, parts[part]); });
        const double curvature = system.a.multiply(p_, q_, pool);
        if (!(curvature > 0.0)) break; // not positive definite, or not finite: the present answer is the best there is
        step(rz / curvature);
        energy += rz * rz / curvature;
    }
    return report;
}

} // namespace filasofia::linalg
