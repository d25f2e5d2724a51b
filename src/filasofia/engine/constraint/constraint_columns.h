#pragma once

#include "filasofia/engine/constraint/body_operator.h"
#include "filasofia/engine/constraint/constraint.h"
#include "filasofia/linalg/block_cholesky.h"

#include <cstddef>
#include <span>
#include <vector>

namespace filasofia::engine {

/// The blocks of D and of F J that the constraints of a solve act on. A block of three unknowns has a number among all
/// those that constraints act on, or that D couples with such ones.
class ConstraintColumns {
public:
    /// The columns of F J of a row for one block of unknowns.
    struct Column {
        int unknown = 0;
        Mat3 j;
    };

    /// `first`: each body's first contact point; last, the total number.
    void collect(std::span<const CoupledBody> bodies, std::span<const int> first, const ConstraintRows& rows);

    [[nodiscard]] std::size_t unknowns() const { return unknowns_; } ///< blocks of them
    [[nodiscard]] std::size_t rows() const { return firstColumn_.size() - 1; }
    [[nodiscard]] std::span<const Column> of(std::size_t row) const
    {
        return std::span(columns_).subspan(firstColumn_[row], firstColumn_[row + 1] - firstColumn_[row]);
    }
    [[nodiscard]] std::span<const linalg::BlockCholesky::Place> places() const { return places_; } ///< of D, lower half
    [[nodiscard]] std::span<const Mat3> d() const { return d_; }                                   ///< at these places

private:
    void numberUnknowns(std::span<const CoupledBody> bodies, std::span<const int> first);

    std::size_t unknowns_ = 0;
    std::vector<linalg::BlockCholesky::Place> places_;
    std::vector<Mat3> d_;
    std::vector<Column> ofPoints_;          ///< J, per contact point
    std::vector<std::size_t> firstOfPoint_; ///< per contact point; last, the total number
    std::vector<std::size_t> firstColumn_;  ///< per row; last, the total number
    std::vector<Column> columns_;
    std::vector<BlockColumns> scratch_;
    std::vector<int> unknownOf_; ///< scratch: per block of a body; -1 if it has no number yet
};

} // namespace filasofia::engine
