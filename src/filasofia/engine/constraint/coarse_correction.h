#pragma once

#include "filasofia/engine/constraint/constraint_motions.h"
#include "filasofia/linalg/dense_cholesky.h"

#include <vector>

namespace filasofia::engine {

/// Deflates the bodies' coarse levels by the constraints between the bodies. The coarse level treats a body as free.
/// Without the correction, a soft body between jaws, or sewn to another, therefore takes more iterations the stiffer it
/// is (measured: 38 instead of 10 with forceps that pull at a polyp).
///
///     B' = B - B F S^-1 F^T B,   F = J^T M U,   S = U^T M U + F^T B F,
///
/// where M is the filter: the stiffness that the constraints keep for the coarse level after the smoother has yielded
/// to them; and U are motions of the constraints (Woodbury's formula). As F (U^T M U)^-1 F^T <= J^T M J, the correction
/// is never too large: B' stays positive definite, and is no softer than the exact inverse. If U are the motions of all
/// coarse nodes, B' is exact: (A_c + P^T J^T M J P)^-1 on the coarse nodes of all bodies together.
class CoarseCorrection {
public:
    void clear();
    [[nodiscard]] bool empty() const { return sums_.empty(); }

    void make(const ConstraintNetwork& network, std::vector<ConstraintMotion> motions);

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
