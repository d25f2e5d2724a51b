#pragma once

#include "filasofia/linalg/factor_kernels.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace filasofia::linalg {

/// A symmetric matrix whose entries further than kWidth from the diagonal are zero. Its lower half is stored, column by
/// column: the entry (row, column) is at kBandColumn times the column, plus row - column. A cyclic one also has entries
/// in its corner: the last kCorner rows against the first kCorner columns.
class BandMatrix {
public:
    /// What a rod needs: a node, the next two, and the angles of both edges between.
    static constexpr std::size_t kWidth = kBandEntries - 1;

    static constexpr std::size_t kCorner = 8; ///< what a ring needs: two nodes and the edges behind them

    /// A cyclic one has at least 2 kCorner + kWidth rows: the corner and the band have no entry in common.
    explicit BandMatrix(std::size_t rows = 0, bool cyclic = false) { resize(rows, cyclic); }
    void resize(std::size_t rows, bool cyclic = false)
    {
        rows_ = rows;
        cyclic_ = cyclic;
        entries_.assign((rows + kWidth) * kBandColumn, 0.0); // further columns of zeros, so that loops need no bound
        corner_.fill(0.0);
    }
    void setZero() { resize(rows_, cyclic_); }

    [[nodiscard]] std::size_t rows() const { return rows_; }
    [[nodiscard]] bool cyclic() const { return cyclic_; }
    /// The entry of row rows() - kCorner + r and column c, both r and c < kCorner.
    [[nodiscard]] double& corner(std::size_t r, std::size_t c) { return corner_[kCorner * r + c]; }
    [[nodiscard]] double corner(std::size_t r, std::size_t c) const { return corner_[kCorner * r + c]; }
    /// Adds to an entry, given in either half, in the band or in the corner.
    void add(std::size_t row, std::size_t column, double value)
    {
        const std::size_t low = row < column ? row : column, high = row < column ? column : row;
        (high - low > kWidth ? corner(high + kCorner - rows_, low) : at(high, low)) += value;
    }
    /// row >= column, at most kWidth from it
    [[nodiscard]] double& at(std::size_t row, std::size_t column)
    {
        return entries_[column * kBandColumn + row - column];
    }
    [[nodiscard]] double at(std::size_t row, std::size_t column) const
    {
        return entries_[column * kBandColumn + row - column];
    }
    /// Any entry, in either half.
    [[nodiscard]] double entry(std::size_t row, std::size_t column) const
    {
        const std::size_t low = row < column ? row : column, high = row < column ? column : row;
        if (high - low <= kWidth) return at(high, low);
        return cyclic_ && low < kCorner && high + kCorner >= rows_ ? corner(high + kCorner - rows_, low) : 0.0;
    }
    [[nodiscard]] double* column(std::size_t j) { return &entries_[j * kBandColumn]; }
    [[nodiscard]] const double* column(std::size_t j) const { return &entries_[j * kBandColumn]; }

    [[nodiscard]] std::span<double> columns() { return entries_; }
    [[nodiscard]] std::span<const double> columns() const { return entries_; }

    void multiply(std::span<const double> x, std::span<double> y) const; ///< y = A x

private:
    std::size_t rows_ = 0;
    bool cyclic_ = false;
    std::vector<double> entries_;
    std::array<double, kCorner * kCorner> corner_{};
};

/// A positive definite one, factorised: A = L L^T. All costs are linear in the number of rows. The last kCorner rows of
/// a cyclic one are its border: their rows of L are full.
class BandCholesky {
public:
    /// Returns false if the matrix is not positive definite to rounding; nothing else must be called then.
    bool factorise(const BandMatrix& matrix);
    void solve(std::span<double> x) const; ///< x = A^-1 x
    /// The entries of A^-1 within the band and the corner (Takahashi, Fagan and Chen 1973).
    void invert(BandMatrix& inverse) const;

private:
    static constexpr std::size_t kBorder = BandMatrix::kCorner;
    using Border = std::array<double, kBorder>; ///< one entry per row of the border
    using Square = std::array<Border, kBorder>;

    void takeApart(const BandMatrix& matrix);
    void eliminate(std::size_t j);
    [[nodiscard]] bool factoriseBorder();
    void solveBorder(Border& x) const; ///< with its own block of L, forwards and back
    void addBorder(BandMatrix& inverse) const;

    std::size_t rows_ = 0;
    BandMatrix lower_;                 ///< L without the border, but on the diagonal the inverse of its entries
    std::vector<Border> border_;       ///< per column of lower_: the border's rows of L; empty if there is no border
    Square corner_{};                  ///< the border's own block of L, on the diagonal the inverse of its entries
    mutable std::vector<double> work_; ///< scratch, longer than x by the width of the band
};

} // namespace filasofia::linalg
