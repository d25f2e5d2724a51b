#pragma once

#include "filasofia/engine/constraint/body_operator.h"
#include "filasofia/engine/constraint/constraint.h"
#include "filasofia/linalg/sparse_cholesky.h"

#include <span>
#include <vector>

namespace filasofia::engine {

/// The filter of bodies that are all small: the stiffness that all constraints together keep after the bodies have
/// yielded to them,
///
///     M = Sigma - Sigma J K^-1 J^T Sigma,   K = A + J^T Sigma J
///
/// so that K^-1 = A^-1 - A^-1 J^T M J A^-1 (Woodbury's formula). K has a block per body and per pair of bodies with a
/// constraint between them. It is factorised: a step whose constraints neither begin nor end is solved at once, however
/// stiff the constraints and however high the tower are.
class ExactFilter {
public:
    /// `bodies`: all of them are small. `first`: each body's first contact point; last, the total number. The rows must
    /// outlive the filter's use.
    void begin(std::span<const SmallBody* const> bodies, std::span<const int> first, const ConstraintRows& rows);
    /// `sigma` [kg] per row and axis of its frame; zero if the row takes no part. Returns false if K is not positive
    /// definite to rounding; apply() must not be called then.
    bool build(std::span<const Vec3> sigma);
    /// In: velocities u [m/s]; out: impulses M u [N s]; per row in its frame.
    void apply(std::span<Vec3> perRow);

private:
    /// One body of a row.
    struct Side {
        std::size_t body = 0;
        std::size_t columns = 0; ///< the place of its columns of F J
    };

    [[nodiscard]] std::span<const Side> sidesOf(std::size_t row) const
    {
        return std::span(sides_).subspan(firstSide_[row], firstSide_[row + 1] - firstSide_[row]);
    }
    [[nodiscard]] std::span<const Vec3> columnsOf(const Side& side) const
    {
        return std::span(columns_).subspan(side.columns, unknowns_[side.body]);
    }

    std::vector<std::size_t> unknowns_, offsets_;      ///< per body: number of unknowns, and the first of them
    std::vector<linalg::SparseCholesky::Entry> a_, k_; ///< lower halves
    std::vector<std::size_t> firstSide_;               ///< per row; last, the total number
    std::vector<Side> sides_;
    std::vector<Vec3> columns_, sigma_;
    std::vector<double> vector_;
    linalg::SparseCholesky factor_;
};

} // namespace filasofia::engine
