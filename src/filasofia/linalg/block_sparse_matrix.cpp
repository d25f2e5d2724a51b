#include "filasofia/linalg/block_sparse_matrix.h"

#include "filasofia/core/assert.h"

#include <algorithm>

namespace filasofia::linalg {

BlockSparseMatrix::BlockSparseMatrix(const std::vector<std::vector<int>>& columns)
{
    rowStarts_.push_back(0);
    for (std::size_t r = 0; r < columns.size(); ++r) {
        const auto& row = columns[r];
        const auto own = std::lower_bound(row.begin(), row.end(), static_cast<int>(r));
        FILASOFIA_ASSERT(own != row.end() && *own == static_cast<int>(r));
        diagonal_.push_back(rowStarts_.back() + static_cast<int>(own - row.begin()));
        columns_.insert(columns_.end(), row.begin(), row.end());
        rowStarts_.push_back(static_cast<int>(columns_.size()));
    }
    blocks_.resize(columns_.size());
}

int BlockSparseMatrix::find(int row, int column) const
{
    const auto begin = columns_.begin() + rowStarts_[row], end = columns_.begin() + rowStarts_[row + 1];
    const auto found = std::lower_bound(begin, end, column);
    return found != end && *found == column ? static_cast<int>(found - columns_.begin()) : -1;
}

void BlockSparseMatrix::setZero() { std::fill(blocks_.begin(), blocks_.end(), Mat3{}); }

void BlockSparseMatrix::multiply(std::span<const Vec3> x, std::span<Vec3> y) const
{
    for (int r = 0; r < rows(); ++r) {
        Vec3 sum;
        for (int p = rowStarts_[r]; p < rowStarts_[r + 1]; ++p) sum += blocks_[p] * x[columns_[p]];
        y[r] = sum;
    }
}

void BlockSparseMatrix::diagonal(std::span<Mat3> blocks) const
{
    for (int r = 0; r < rows(); ++r) blocks[r] = blocks_[diagonal_[r]];
}

} // namespace filasofia::linalg
