#pragma once

#include <span>
#include <vector>

namespace filasofia::linalg {

/// A small symmetric positive definite matrix, factorised: A = L L^T.
class DenseCholesky {
public:
    /// `matrix`: n rows of n, the lower half is read. False where it is not positive definite to rounding; solve() is
    /// not to be called then.
    bool factorise(std::span<const double> matrix, int n);
    void solve(std::span<double> x) const; ///< x = A^-1 x, n numbers

private:
    std::vector<double> lower_; ///< L, row by row
};

} // namespace filasofia::linalg
