#pragma once

#include "filasofia/engine/constraint/body_operator.h"
#include "filasofia/engine/constraint/constraint.h"
#include "filasofia/linalg/dense_cholesky.h"

#include <vector>

namespace filasofia::engine {

/// Deflates the bodies' coarse levels by the constraints between the bodies. The coarse level treats a body as free.
/// Without the correction, a soft body between jaws, or sewn to another, therefore takes more iterations the stiffer it
/// is (measured: 38 instead of 10 with forceps that pull at a polyp).
///
/// A patch is the set of active constraints of one sort (unilateral or bilateral) between the same two bodies. It is
/// represented by the six rigid motions U of one side relative to the other (Woodbury's formula). If a body has fallen
/// into pieces, each piece is a side of its own: jaws that crush fragments hold every fragment, not only their sum.
///
///     B' = B - B F S^-1 F^T B,   F = J^T M U,   S = U^T M U + F^T B F,
///
/// where M is the filter: the stiffness that the constraints keep for the coarse level after the smoother has yielded
/// to them. As F (U^T M U)^-1 F^T <= J^T M J, the correction is never too large: B' stays positive definite, and is no
/// softer than the exact inverse.
class PatchCorrection {
public:
    void clear();
    [[nodiscard]] bool empty() const { return sums_.empty(); }

    /// Builds patches of the rows whose filter (in their frames) is not zero. `first` holds each body's first contact
    /// point, and last the total number.
    void make(std::span<const CoupledBody> bodies, std::span<const int> first, const ConstraintRows& rows,
              std::span<const Mat3> filters);

    /// Computes the coefficients from the bodies' F^T B s. To be called between their smooth() and their applyCoarse().
    void project(std::span<const CoupledBody> bodies);
    /// The coefficients that applyCoarse() of this body takes.
    [[nodiscard]] std::span<const double> shares(std::size_t body) const;

private:
    std::vector<std::vector<std::size_t>> rows_; ///< per body, per column: its row in S, ascending
    std::vector<std::vector<double>> shares_;    ///< per body, per column
    std::vector<double> sums_;
    linalg::DenseCholesky factor_; ///< Cholesky factor of S
};

} // namespace filasofia::engine
