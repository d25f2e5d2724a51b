#pragma once

#include "filasofia/engine/collision/collision_shape.h"

#include <span>

/// What a shape is made of, piece by piece: all of it linear in its size, but for the tree.
namespace filasofia::engine {

/// A triangle's side, or a line of no triangle.
struct EdgeUse {
    std::array<int, 2> edge; ///< lower vertex first
    int triangle = -1;       ///< -1: none
    friend constexpr auto operator<=>(const EdgeUse&, const EdgeUse&) = default;
};

/// An edge as it is kept: lower vertex first.
constexpr std::array<int, 2> ordered(int a, int b) { return a < b ? std::array{a, b} : std::array{b, a}; }

/// The edges and who is beside whom, from vertices, triangles and their edges' uses, ascending.
void connect(std::span<const EdgeUse> uses, CollisionShape& shape);

/// Elements from triangles and lines (or points), and a tree over them.
void plantTree(CollisionShape& shape);

/// Halves the elements at the median of their middles down to leaves, and adds the nodes of that. Places in the tree
/// begin at `first`; `order` comes out in the order of the leaves.
int plant(const std::vector<Vec3>& middles, std::span<int> order, int first, std::vector<CollisionShape::Node>& nodes);

/// [m] of the box around an element at rest.
Vec3 middleOf(const CollisionShape& shape, const CollisionShape::Element& element);

/// Gives every vertex and edge to the first element that has it.
void shareOut(CollisionShape& shape);

} // namespace filasofia::engine
