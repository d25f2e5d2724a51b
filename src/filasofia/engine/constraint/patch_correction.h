#pragma once

#include "filasofia/engine/constraint/body_operator.h"
#include "filasofia/engine/constraint/constraint.h"
#include "filasofia/linalg/dense_cholesky.h"

#include <vector>

namespace filasofia::engine {

/// Tells the bodies' coarse levels what they do not know: that constraints hold the bodies, one against another.
/// Without it, a soft body in the grip of jaws, or sewn to another, takes the more iterations the stiffer it is,
/// because its coarse level takes it for free (measured: 38 instead of 10 where forceps pull at a polyp).
///
/// A patch is the active constraints of one sort (unilateral or bilateral) between the same two bodies. It is
/// represented by the six rigid motions U of one side against the other (Woodbury's formula). Each piece of a body that
/// has fallen into pieces is a side of its own: jaws that crush fragments hold every one of them, not their sum alone.
///
///     B' = B - B F S^-1 F^T B,   F = J^T M U,   S = U^T M U + F^T B F,
///
/// M the filter, which is what constraints still are to the coarse level once the smoother has given way to them. As
/// F (U^T M U)^-1 F^T <= J^T M J, this never corrects too much: B' stays positive definite, and is no softer than the
/// truth.
class PatchCorrection {
public:
    void clear();
    [[nodiscard]] bool empty() const { return sums_.empty(); }

    /// Makes patches of the rows whose filter (in their frames) is not zero. `first`: per body its first contact point,
    /// and last their number.
    void make(std::span<const CoupledBody> bodies, std::span<const int> first, const ConstraintRows& rows,
              std::span<const Mat3> filters);

    /// Asks the bodies for F^T B r, between their smooth() and their applyCoarse().
    void project(std::span<const CoupledBody> bodies);
    /// What applyCoarse() of that body is to be given then.
    [[nodiscard]] std::span<const double> shares(std::size_t body) const;

private:
    std::vector<std::vector<std::size_t>> rows_; ///< per body, per column: its row in S, ascending
    std::vector<std::vector<double>> shares_;    ///< per body, per column
    std::vector<double> sums_;
    linalg::DenseCholesky factor_; ///< of S
};

} // namespace filasofia::engine
