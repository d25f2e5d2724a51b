#pragma once

#include <memory>
#include <span>

namespace filasofia::linalg {

/// A sparse symmetric positive definite matrix, factorised: Q A Q^T = L L^T, with an order Q that keeps L sparse
/// (approximate minimum degree, Amestoy et al. 1996).
class SparseCholesky {
public:
    struct Entry {
        int row = 0, column = 0;
        double value = 0.0;
    };

    SparseCholesky();
    ~SparseCholesky();
    SparseCholesky(SparseCholesky&&) noexcept;
    SparseCholesky& operator=(SparseCholesky&&) noexcept;

    /// `lower`: the entries of the lower half of a matrix of n rows, in any order; those of one place are added up.
    /// Returns false if the matrix is not positive definite to rounding; solve() must not be called then.
    bool factorise(std::span<const Entry> lower, int n);
    void solve(std::span<double> x) const; ///< x = A^-1 x; x has n numbers

private:
    struct Factor;
    std::unique_ptr<Factor> factor_;
};

} // namespace filasofia::linalg
