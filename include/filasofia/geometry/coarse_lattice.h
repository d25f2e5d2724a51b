#pragma once

#include "filasofia/math/vec3.h"

#include <array>
#include <span>
#include <vector>

namespace filasofia::geometry {

/// A coarse mesh that a body's nodes are embedded in: what a node does is interpolated from four coarse nodes.
struct CoarseLattice {
    int nodeCount = 0;                         ///< coarse nodes, each with at least one node of weight > 0
    std::vector<std::array<int, 4>> corners;   ///< per node: its coarse nodes; one may stand there twice, with weight 0
    std::vector<std::array<float, 4>> weights; ///< per node, >= 0, summing to 1; all four 0 for a node left out
    std::vector<std::vector<int>> pieces = {}; ///< small ones, left out: the nodes of each, ascending
};

/// Lays a lattice of tetrahedra through a body so that about `target` coarse nodes are in use, or a quarter of the
/// active nodes where that is less (at most 5 % more; fewer where the body gives no lattice of that size), made from
/// nothing but the nodes [m] and the edges between them. Parts that are close but not connected by edges through active
/// nodes share no coarse node: every cell is there once per connected part of the body inside it (virtual nodes, Molino
/// et al. 2004).
///
/// Linear fields are reproduced but for rounding, with two exceptions. A coarse node that holds hardly any of the body
/// (less than 5 % of what the median one holds) is dropped and its share given to the node's other corners, so the few
/// nodes that it held follow a linear field only nearly. And all but the target/8 largest pieces of the body
/// get one coarse node, which can only translate them, where the target has no four coarse nodes for each; such pieces
/// take a quarter of the target at most, the largest first, and the rest is left out.
///
/// A piece with fewer than 16 active nodes is no matter for a lattice: whoever solves for it can do so exactly. The 64
/// largest of those are told instead, the others get one coarse node.
///
/// Only nodes with `active` set take part; the others are left out. Empty (nodeCount 0, no pieces, all left out)
/// where none is active or the target is below 4, where more than half of the active nodes would be left out, and where
/// a coordinate is not finite or beyond 1e100 m. The same input gives the same lattice.
CoarseLattice coarseLattice(std::span<const Vec3> nodes, std::span<const std::array<int, 2>> edges,
                            const std::vector<bool>& active, int target);

} // namespace filasofia::geometry
