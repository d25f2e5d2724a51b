#pragma once

#include "filasofia/linalg/linear_solver.h"
#include "filasofia/linalg/node_operator.h"
#include "filasofia/linalg/two_level_preconditioner.h"

#include <functional>

namespace filasofia::linalg {

/// When a solve ends.
struct SolveLimits {
    double tolerance = 1e-2; ///< [-], of the error relative to the answer, in the norm of the energy x . A x
    int maxIterations = 300;
    int minIterations = 0;                ///< made before outOfTime is asked
    std::function<bool()> outOfTime = {}; ///< asked between iterations; empty: never
    int stopAt = -1;                      ///< out of time after as many iterations; -1: never
};

/// `residual` is the error that the tolerance is about.
struct NodeSolveReport : SolveReport {
    bool outOfTime = false; ///< it ended for want of time
};

/// Preconditioned conjugate gradients (Shewchuk 1994, section B3) in single precision.
///
/// They end by the error's energy relative to the answer's, r . M^-1 r / (x . A x + r . M^-1 r), which costs nothing to
/// know. A residual relative to the right-hand side would not do: where stiff forces nearly cancel, a small part of
/// them is still enough to throw the body about.
class MatrixFreeCg {
public:
    MatrixFreeCg() = default;
    MatrixFreeCg(int unknownBlocks, int heldBlocks);

    /// Solves A x = b from the first guess in x. On entry `r` holds b, and `size` its square; on return r is the
    /// residual as the recurrence knows it. The report's residual is the error that the tolerance is about.
    NodeSolveReport solve(NodeOperator& a, TwoLevelPreconditioner& m, NodeArray& r, double size, NodeArray& x,
                          const SolveLimits& limits, WorkerPool& pool);

private:
    NodeArray z_, p_, q_;
    std::vector<double> sums_;
};

} // namespace filasofia::linalg
