#pragma once

#include <span>
#include <vector>

namespace filasofia::linalg {

/// A small symmetric positive definite matrix, factorised: A = L L^T.
class DenseCholesky {
public:
    /// `matrix`: n rows of n, of which the lower half is read. Returns false if it is not positive definite to
    /// rounding; solve() must not be called then.
    bool factorise(std::span<const double> matrix, int n);
    void solve(std::span<double> x) const; ///< x = A^-1 x; x has n numbers

private:
    std::vector<double> lower_; ///< L, row by row
};

} // namespace filasofia::linalg
