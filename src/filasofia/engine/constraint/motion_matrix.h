#pragma once

#include "filasofia/linalg/block_cholesky.h"
#include "filasofia/linalg/dense_cholesky.h"

namespace filasofia::engine {

/// The matrix S of CoarseCorrection, in 3x3 blocks. A block is there where both of its motions reach the same body. So
/// in a heap S is sparse, and factorised as such; between few bodies it is dense, or nearly so.
class MotionMatrix {
public:
    void begin(std::size_t size); ///< rows of blocks, zero
    /// Adds a block in the lower half, row >= column. One on the diagonal is symmetric.
    void add(std::size_t row, std::size_t column, const Mat3& block);
    /// Makes the diagonal of what has been added a little larger. Motions may be linearly dependent, as those of a
    /// patch with two points, or of a flat one without friction. They cancel to rounding. A motion that nothing resists
    /// takes no part.
    void shiftDiagonal();
    /// Returns false if the matrix is not positive definite to rounding; solve() must not be called then.
    bool factorise();
    void solve(std::span<Vec3> x) const; ///< x = S^-1 x

private:
    [[nodiscard]] bool isDense() const;
    bool factoriseDense();

    std::size_t size_ = 0;
    std::vector<linalg::BlockCholesky::Place> places_; ///< the diagonal first
    std::vector<Mat3> blocks_;
    linalg::DenseCholesky dense_;
    linalg::BlockCholesky sparse_;
};

} // namespace filasofia::engine
