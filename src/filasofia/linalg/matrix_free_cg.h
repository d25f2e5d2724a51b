#pragma once

#include "filasofia/linalg/linear_solver.h"
#include "filasofia/linalg/node_operator.h"
#include "filasofia/linalg/two_level_preconditioner.h"

#include <functional>

namespace filasofia::linalg {

/// When a solve ends.
struct SolveLimits {
    double tolerance = 1e-2;              ///< [-], error relative to the answer, in the norm of the energy x . A x
    double smallAnswer = 0.0;             ///< [unit of x] the error is relative to at least the energy of this in all x
    int maxIterations = 300;              ///< the solve ends there, converged or not
    int minIterations = 0;                ///< iterations before outOfTime is asked
    std::function<bool()> outOfTime = {}; ///< asked between iterations; empty: never out of time
    int stopAt = -1;                      ///< iterations after which the solve is out of time; -1: never
};

/// How a solve went; `residual` is the error that the tolerance is about.
struct NodeSolveReport : SolveReport {
    bool outOfTime = false; ///< it stopped because outOfTime or stopAt said so
    bool small = false;     ///< the answer has less energy than SolveLimits::smallAnswer
};

/// A system A x = b of one solve.
struct NodeSystem {
    NodeOperator& a;
    TwoLevelPreconditioner& m;
    NodeArray& r;             ///< b on entry; on return the residual as the recurrence knows it
    double squaredNorm = 0.0; ///< b . b; only zero and values that are not finite matter
    double mass = 0.0;        ///< sum of all masses: the energy of a small answer is mass times its square
};

/// Preconditioned conjugate gradients (Shewchuk 1994, section B3) in single precision.
///
///     x  solution          z = M^-1 r  preconditioned residual     alpha  step length, r.z / p.q
///     r  residual b - A x  q = A p     product                     beta   r.z / (r.z of the iteration before)
///     p  direction         p.q         curvature                   x.A x  energy of the answer
///
/// They end by the energy of the error relative to that of the answer, r.z / (x.A x + r.z), which costs nothing to
/// compute. A residual relative to the right-hand side would not do: if stiff forces nearly cancel, a small part of
/// them is still enough to throw the body about. The energy of the answer counts as that of SolveLimits::smallAnswer if
/// it is less: at rest, the answer is rounding noise.
class MatrixFreeCg {
public:
    MatrixFreeCg() = default;
    MatrixFreeCg(int unknownBlocks, int pinnedBlocks);

    /// Solves the system from the first guess in x.
    NodeSolveReport solve(const NodeSystem& system, NodeArray& x, const SolveLimits& limits, WorkerPool& pool);

private:
    NodeArray z_, p_, q_;
    std::vector<double> sums_;
};

} // namespace filasofia::linalg
