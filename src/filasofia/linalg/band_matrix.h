#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace filasofia::linalg {

/// A symmetric matrix whose entries further than kWidth from the diagonal are zero. Its lower half is stored, column by
/// column: the entry (row, column) is at kWidth + 1 times the column, plus row - column.
class BandMatrix {
public:
    static constexpr std::size_t kWidth =
        10; ///< what a rod needs: a node, the next two, and the angles of both edges between

    explicit BandMatrix(std::size_t rows = 0) { resize(rows); }
    void resize(std::size_t rows)
    {
        rows_ = rows;
        entries_.assign((rows + kWidth) * (kWidth + 1), 0.0); // further columns of zeros, so that loops need no bound
    }
    void setZero() { resize(rows_); }

    [[nodiscard]] std::size_t rows() const { return rows_; }
    /// row >= column, at most kWidth from it
    [[nodiscard]] double& at(std::size_t row, std::size_t column)
    {
        return entries_[column * (kWidth + 1) + row - column];
    }
    [[nodiscard]] double at(std::size_t row, std::size_t column) const
    {
        return entries_[column * (kWidth + 1) + row - column];
    }
    /// Any entry, in either half.
    [[nodiscard]] double entry(std::size_t row, std::size_t column) const
    {
        const std::size_t low = row < column ? row : column, high = row < column ? column : row;
        return high - low > kWidth ? 0.0 : at(high, low);
    }
    [[nodiscard]] double* column(std::size_t j) { return &entries_[j * (kWidth + 1)]; }
    [[nodiscard]] const double* column(std::size_t j) const { return &entries_[j * (kWidth + 1)]; }

    void multiply(std::span<const double> x, std::span<double> y) const; ///< y = A x

private:
    std::size_t rows_ = 0;
    std::vector<double> entries_;
};

/// A positive definite one, factorised: A = L L^T. All costs are linear in the number of rows.
class BandCholesky {
public:
    /// Returns false if the matrix is not positive definite to rounding; nothing else must be called then.
    bool factorise(const BandMatrix& matrix);
    void solve(std::span<double> x) const; ///< x = A^-1 x
    /// The entries of A^-1 within the band (Takahashi, Fagan and Chen 1973).
    void invert(BandMatrix& inverse) const;

private:
    BandMatrix lower_;                 ///< L, but on the diagonal the inverse of its entries
    mutable std::vector<double> work_; ///< scratch, longer than x by the width of the band
};

} // namespace filasofia::linalg
