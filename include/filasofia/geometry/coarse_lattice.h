#pragma once

#include "filasofia/math/vec3.h"

#include <array>
#include <span>
#include <vector>

namespace filasofia::geometry {

/// A coarse mesh in which a body's nodes are embedded: each node's motion is interpolated from four coarse nodes.
struct CoarseLattice {
    int nodeCount = 0; ///< coarse nodes, each with at least one node of weight > 0
    std::vector<std::array<int, 4>>
        corners; ///< per node, its coarse nodes; one may occur twice, the second time with weight 0
    std::vector<std::array<float, 4>>
        weights; ///< per node, >= 0, summing to 1; all four are 0 for a node that is left out
    std::vector<std::vector<int>> pieces =
        {}; ///< small pieces, left out of the lattice: the nodes of each, in ascending order
};

/// Lays a lattice of tetrahedra through a body so that about `target` coarse nodes are in use, or a quarter of the
/// active nodes if that is less (at most 5 % more; fewer if the body admits no lattice of that size). Only the nodes
/// [m] and the edges between them are used. Parts that are close but not connected by edges through active nodes share
/// no coarse node: every cell exists once for each connected part of the body inside it (virtual nodes, Molino et al.
/// 2004).
///
/// Linear fields are reproduced up to rounding, with two exceptions. A coarse node that supports hardly any of the body
/// (less than 5 % of the median support) is dropped and its weights are given to the nodes' other corners, so the few
/// nodes that it supported follow a linear field only approximately. And if the target allows fewer than four coarse
/// nodes per piece, all but the target/8 largest pieces get a single coarse node, which can only translate them; these
/// pieces take at most a quarter of the target, the largest first, and the rest is left out.
///
/// A piece with fewer than 16 active nodes does not need a lattice, because a solver can solve for it exactly. The 64
/// largest of these pieces are listed in `pieces`; the others get one coarse node each.
///
/// Only nodes with `active` set take part. The result is empty (nodeCount 0, no pieces, all nodes left out) if no node
/// is active or the target is below 4, if more than half of the active nodes would be left out, or if a coordinate is
/// not finite or beyond 1e100 m. The same input gives the same lattice.
CoarseLattice coarseLattice(std::span<const Vec3> nodes, std::span<const std::array<int, 2>> edges,
                            const std::vector<bool>& active, int target);

} // namespace filasofia::geometry
