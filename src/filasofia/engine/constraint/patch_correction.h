#pragma once

#include "filasofia/engine/constraint/constraint.h"
#include "filasofia/engine/constraint/body_operator.h"
#include "filasofia/linalg/dense_cholesky.h"

#include <vector>

namespace filasofia::engine {

/// Tells the bodies' coarse levels what they do not know: that constraints hold the bodies, one against another. A soft
/// body in the grip of jaws, or sewn to another, else takes the more iterations the stiffer it is: its coarse level
/// believes it to be free (measured: 38 for 10 where forceps pull at a polyp).
///
/// Per patch, the constraints between the same two bodies that all touch or all hold, it is the six rigid motions U of
/// one side against the other (Woodbury's formula). Of a body that has fallen into pieces each is a side of its own:
/// jaws that crush crumbs hold every one of them, not their sum alone.
///
///     B' = B - B F S^-1 F^T B,   F = J^T M U,   S = U^T M U + F^T B F,
///
/// M the filter, which is what constraints still are to the coarse level once the smoother has given way to them. As
/// F (U^T M U)^-1 F^T <= J^T M J, this never corrects too much: B' stays positive definite, and no softer than what is
/// true.
class PatchCorrection {
public:
    void clear();
    [[nodiscard]] bool empty() const { return sums_.empty(); }

    /// Of the constraints whose filter (in their frames) is not zero. `first`: per body its first grip of all, and
    /// their number.
    void make(const std::vector<CoupledBody*>& bodies, std::span<const int> first, const Constraints& constraints,
              std::span<const Mat3> filters);

    /// Asks the bodies for F^T B r, between their smooth() and their spread().
    void weigh(const std::vector<CoupledBody*>& bodies);
    /// What spread() of that body is to be given then.
    [[nodiscard]] std::span<const double> shares(std::size_t body) const;

private:
    std::vector<std::vector<std::size_t>> rows_; ///< per body, per pull: its row in S, ascending
    std::vector<std::vector<double>> shares_;    ///< per body, per pull
    std::vector<double> sums_;
    linalg::DenseCholesky factor_; ///< of S
};

} // namespace filasofia::engine
