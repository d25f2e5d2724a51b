#pragma once

#include "filasofia/engine/constraint/body_operator.h"
#include "filasofia/engine/constraint/constraint.h"

#include <algorithm>
#include <span>
#include <vector>

namespace filasofia::engine {

/// Three motions that active constraints resist.
struct ConstraintMotions {
    std::vector<std::size_t> rows; ///< the constraints, ascending
    std::vector<Mat3> u;           ///< [m/s] per row: its three velocities as columns, world axes
};

/// The constraints between the bodies of a solve.
struct ConstraintNetwork {
    std::span<const CoupledBody> bodies;
    std::span<const int> first; ///< per body: its first contact point; last, the total number
    const ConstraintRows& rows;
    std::span<const Mat3> filters; ///< [kg] M per row, world axes; zero if it is not active

    [[nodiscard]] std::size_t bodyOf(int point) const ///< the body that a contact point is of
    {
        return static_cast<std::size_t>(std::ranges::upper_bound(first, point) - first.begin()) - 1;
    }
};

/// The rigid motions of patches, three translations and three rotations each. A patch is the set of active constraints
/// of one sort (unilateral or bilateral) between the same two bodies; it has the six rigid motions of one side relative
/// to the other. If a body has fallen into pieces, each piece is a side of its own: jaws that crush fragments hold
/// every fragment, not only their sum.
std::vector<ConstraintMotions> patchMotions(const ConstraintNetwork& network);
/// The motions of the coarse nodes that active constraints follow, three for each. Nothing if there are too many.
std::vector<ConstraintMotions> coarseNodeMotions(const ConstraintNetwork& network);

} // namespace filasofia::engine
