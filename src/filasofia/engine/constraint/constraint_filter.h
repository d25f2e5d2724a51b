#pragma once

#include "filasofia/engine/constraint/constraint_columns.h"

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

    [[nodiscard]] const ConstraintColumns& columns() const { return columns_; } ///< of begin()

private:
    ConstraintColumns columns_;
    std::vector<linalg::BlockCholesky::Place> places_; ///< where D has its blocks, then where the rows add theirs
    std::vector<Mat3> k_;                              ///< lower half, at these places
    std::vector<Vec3> sigma_, vector_;                 ///< per row; per unknown
    std::vector<char> placed_;                         ///< per row: 1 once it has taken part since begin()
    linalg::BlockCholesky factor_;
};

} // namespace filasofia::engine
