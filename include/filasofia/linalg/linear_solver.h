#pragma once

#include "filasofia/linalg/linear_operator.h"

#include <memory>

namespace filasofia::linalg {

/// How a solve went.
struct SolveReport {
    int iterations = 0;    ///< [-], 1 for a direct solver
    double residual = 0.0; ///< [-], |b - A x| / |b|
    bool converged = true; ///< false: the cap was reached, or the matrix was not positive definite
};

/// Solves A x = b. Keeps what it can from one solve to the next (patterns, factors, buffers): one solver per body.
class LinearSolver {
public:
    virtual ~LinearSolver() = default;
    /// `x` holds the first guess on entry; on return the solution, the best there was, or zero where there was none.
    /// Never throws for a bad matrix: see the report.
    virtual SolveReport solve(const LinearOperator& a, std::span<const Vec3> b, std::span<Vec3> x) = 0;
    [[nodiscard]] virtual bool isDirect() const { return false; }
    /// x = A^-1 b, A the matrix of the last solve(), by a direct solver; false, and x left alone, by any other and
    /// where that solve failed.
    virtual bool solveAgain(std::span<const Vec3> b, std::span<Vec3> x)
    {
        static_cast<void>(b);
        static_cast<void>(x);
        return false;
    }
};

/// Sparse Cholesky, A = L L^T with a fill-reducing (AMD) order. The pattern is analysed once per block structure.
std::unique_ptr<LinearSolver> makeCholesky();

/// Conjugate gradients preconditioned by the inverse diagonal blocks (block Jacobi), from the first guess in x, until
/// |b - A x| <= tolerance |b| (Shewchuk 1994, section B3).
std::unique_ptr<LinearSolver> makeConjugateGradient(int maxIterations, double tolerance);

} // namespace filasofia::linalg
