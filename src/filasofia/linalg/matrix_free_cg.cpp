#include "filasofia/linalg/matrix_free_cg.h"

#include "filasofia/linalg/node_parts.h"

#include <cmath>

namespace filasofia::linalg {

MatrixFreeCg::MatrixFreeCg(int unknownBlocks, int heldBlocks)
    : z_(unknownBlocks), p_(unknownBlocks, heldBlocks), q_(unknownBlocks),
      sums_(static_cast<std::size_t>(nodeParts(unknownBlocks).count()))
{
}

NodeSolveReport MatrixFreeCg::solve(NodeOperator& a, TwoLevelPreconditioner& m, NodeArray& r, double size, NodeArray& x,
                                    const SolveLimits& limits, WorkerPool& pool)
{
    const Parts parts = nodeParts(x.blocks());
    const auto descendAll = [&](double alpha) {
        const auto step = static_cast<float>(alpha);
        return sumOfParts(pool, parts, sums_, [&](Blocks blocks) { return descend(step, p_, q_, x, r, blocks); });
    };
    NodeSolveReport report;
    if (size == 0.0 || !std::isfinite(size)) { // nothing to solve, or nothing that could be
        x.setZero();
        report.residual = size == 0.0 ? 0.0 : 1.0;
        report.converged = size == 0.0;
        return report;
    }

    // The first guess is the last step's answer, times the one factor that makes its error least.
    std::swap(x, p_); // both reach over the held nodes
    x.setZero();
    const double curvature = a.multiply(p_, q_, pool);
    const double along = sumOfParts(pool, parts, sums_, [&](Blocks blocks) { return dot(p_, r, blocks); });
    double energy = 0.0; // of the answer so far, x . A x
    if (curvature > 0.0 && std::isfinite(curvature) && std::isfinite(along / curvature)) {
        descendAll(along / curvature);
        energy = along * along / curvature;
    } else {
        p_.setZero(); // not finite, it would live on in the directions
    }

    for (double rz = 0.0;; ++report.iterations) {
        const double rzNew = m.apply(r, z_, pool); // the energy of the error, as the preconditioner sees it
        const bool number = rzNew >= 0.0 && std::isfinite(rzNew);
        report.residual = rzNew == 0.0 ? 0.0 : number ? std::sqrt(rzNew / (rzNew + energy)) : 1.0;
        report.converged = report.residual <= limits.tolerance;
        if (report.converged || !number) break;
        if (report.iterations >= limits.maxIterations) break;
        report.outOfTime = report.iterations == limits.stopAt ||
                           (report.iterations >= limits.minIterations && limits.outOfTime && limits.outOfTime());
        if (report.outOfTime) break;

        const float beta = report.iterations == 0 ? 0.0f : static_cast<float>(rzNew / rz);
        rz = rzNew;
        pool.run(parts.count(), [&](int part) { turn(z_, beta, p_, parts[part]); });
        const double bend = a.multiply(p_, q_, pool);
        if (!(bend > 0.0)) break; // what we have is the best there is
        descendAll(rz / bend);
        energy += rz * rz / bend;
    }
    return report;
}

} // namespace filasofia::linalg
