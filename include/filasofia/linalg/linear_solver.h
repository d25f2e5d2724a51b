#pragma once

#include "filasofia/linalg/linear_operator.h"

#include <memory>

namespace filasofia::linalg {

/// How a solve went.
struct SolveReport {
    int iterations = 0;    ///< [-], 1 for a direct solver
    double residual = 0.0; ///< [-], |b - A x| / |b|
    bool converged = true; ///< false if the cap was reached, or if the matrix was not positive definite
};

/// Solves A x = b. It keeps what it can from one solve to the next (patterns, factors, buffers), so each body has its
/// own.
class LinearSolver {
public:
    virtual ~LinearSolver() = default;
    /// `x` holds the first guess on entry. On return it holds the solution, or the best approximation that was found,
    /// or zero if there was none. A bad matrix never throws: see the report.
    virtual SolveReport solve(const LinearOperator& a, std::span<const Vec3> b, std::span<Vec3> x) = 0;
    [[nodiscard]] virtual bool isDirect() const { return false; }
    /// x = A^-1 b with the matrix A of the last solve(). Returns false and leaves x alone if the solver is not direct,
    /// or if that solve failed.
    virtual bool solveAgain(std::span<const Vec3> b, std::span<Vec3> x)
    {
        static_cast<void>(b);
        static_cast<void>(x);
        return false;
    }
};

/// Sparse Cholesky, A = L L^T, in a fill-reducing order (AMD). The pattern is analysed once per block structure.
std::unique_ptr<LinearSolver> makeCholesky();

/// Conjugate gradients preconditioned by the inverse diagonal blocks (block Jacobi), from the first guess in x, until
/// |b - A x| <= tolerance |b| (Shewchuk 1994, section B3).
std::unique_ptr<LinearSolver> makeConjugateGradient(int maxIterations, double tolerance);

} // namespace filasofia::linalg
