#pragma once

#include "filasofia/linalg/linear_operator.h"

#include <vector>

namespace filasofia::linalg {

/// A square matrix of 3 x 3 blocks in compressed rows. Which blocks exist is fixed at construction.
class BlockSparseMatrix final : public LinearOperator {
public:
    BlockSparseMatrix() = default;
    /// `columns[r]` lists the columns of the blocks of row r, sorted, without repeats, including the diagonal.
    explicit BlockSparseMatrix(const std::vector<std::vector<int>>& columns);

    /// Where block (row, column) is stored, or -1 if there is none.
    [[nodiscard]] int find(int row, int column) const;
    [[nodiscard]] Mat3& block(int position) { return blocks_[position]; }
    [[nodiscard]] const Mat3& block(int position) const { return blocks_[position]; }
    void setZero();

    [[nodiscard]] const std::vector<int>& rowStarts() const { return rowStarts_; } ///< rows() + 1 positions
    [[nodiscard]] const std::vector<int>& columns() const { return columns_; }     ///< the column of each position

    [[nodiscard]] int rows() const override { return rowStarts_.empty() ? 0 : static_cast<int>(rowStarts_.size()) - 1; }
    void multiply(std::span<const Vec3> x, std::span<Vec3> y) const override;
    void diagonal(std::span<Mat3> blocks) const override;
    [[nodiscard]] const BlockSparseMatrix& entries() const override { return *this; }

private:
    std::vector<int> rowStarts_;
    std::vector<int> columns_;
    std::vector<int> diagonal_; ///< the position of each row's diagonal block
    std::vector<Mat3> blocks_;
};

} // namespace filasofia::linalg
