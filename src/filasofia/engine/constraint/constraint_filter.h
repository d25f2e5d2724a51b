#pragma once

#include "filasofia/engine/constraint/body_operator.h"
#include "filasofia/engine/constraint/constraint.h"
#include "filasofia/linalg/block_cholesky.h"

#include <span>
#include <vector>

namespace filasofia::engine {

/// The filter of all constraints together: the stiffness that they keep after the smoother has yielded to them,
///
///     M = Sigma - Sigma J K^-1 J^T Sigma,   K = D + J^T Sigma J
///
/// so that K^-1 = D^-1 - D^-1 J^T M J D^-1 (Woodbury's formula). K has a row of 3x3 blocks per node or rigid body that
/// a constraint acts on, and is factorised. If D is A in all bodies, a step whose constraints neither begin nor end is
/// solved at once, however stiff the constraints and however high a tower are.
class ConstraintFilter {
public:
    /// `first`: each body's first contact point; last, the total number. The rows must outlive the filter's use.
    void begin(std::span<const CoupledBody> bodies, std::span<const int> first, const ConstraintRows& rows);
    /// `sigma` [kg] per row and axis of its frame; zero if the row takes no part. Returns false if K is not positive
    /// definite to rounding; apply() must not be called then.
    bool build(std::span<const Vec3> sigma);
    /// In: velocities u [m/s]; out: impulses M u [N s]; per row in its frame.
    void apply(std::span<Vec3> perRow);

private:
    /// The columns of F J of a row for one block of unknowns.
    struct Column {
        int unknown = 0;
        Mat3 j;
    };

    [[nodiscard]] std::span<const Column> columnsOf(std::size_t row) const
    {
        return std::span(columns_).subspan(firstColumn_[row], firstColumn_[row + 1] - firstColumn_[row]);
    }
    void numberUnknowns(std::span<const CoupledBody> bodies, std::span<const int> first);

    std::vector<linalg::BlockCholesky::Place> places_; ///< where D has its blocks, then where the rows add theirs
    std::vector<Mat3> d_, k_;                          ///< lower halves, at these places
    std::vector<Column> ofPoints_;                     ///< J, per contact point
    std::vector<std::size_t> firstOfPoint_;            ///< per contact point; last, the total number
    std::vector<std::size_t> firstColumn_;             ///< per row; last, the total number
    std::vector<Column> columns_;
    std::vector<Vec3> sigma_, vector_; ///< per row; per unknown
    linalg::BlockCholesky factor_;
    std::vector<BlockColumns> scratch_;
    std::vector<int> unknownOf_; ///< scratch: per block of a body; -1 if it has no number yet
};

} // namespace filasofia::engine
