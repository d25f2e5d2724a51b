#pragma once

#include "filasofia/engine/collision/collision_shape.h"

#include <span>

/// The parts that a shape is built from. All are linear in its size, except the tree.
namespace filasofia::engine {

/// A triangle's side, or a line of no triangle.
struct EdgeUse {
    std::array<int, 2> edge; ///< lower vertex first
    int triangle = -1;       ///< -1 if there is none
    friend constexpr auto operator<=>(const EdgeUse&, const EdgeUse&) = default;
};

/// An edge in its stored form: lower vertex first.
constexpr std::array<int, 2> ordered(int a, int b) { return a < b ? std::array{a, b} : std::array{b, a}; }

/// Builds the edges and the adjacency from vertices, triangles and the ascending uses of their edges.
void connect(std::span<const EdgeUse> uses, CollisionShape& shape);

/// Builds the elements from triangles and lines (or points), and a tree over them.
void plantTree(CollisionShape& shape);

/// Splits the elements at the median of their middles, recursively down to leaves, and appends the tree's nodes.
/// Element indices in the tree begin at `first`; `order` is permuted into the order of the leaves.
int plant(const std::vector<Vec3>& middles, std::span<int> order, int first, std::vector<CollisionShape::Node>& nodes);

/// [m] centre of the box around an element at rest.
Vec3 middleOf(const CollisionShape& shape, const CollisionShape::Element& element);

/// Assigns every vertex and edge to the first element that has it.
void shareOut(CollisionShape& shape);

} // namespace filasofia::engine
