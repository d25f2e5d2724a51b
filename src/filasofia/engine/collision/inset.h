#pragma once

#include "filasofia/engine/collision/collision_shape.h"

#include <span>

namespace filasofia::engine {

/// How far the vertices of a surface are moved inwards before collision detection. The gap is then the distance between
/// the inset surfaces minus both insets. While surfaces rest on each other, or overlap by less than the insets, the
/// inset surfaces stay apart, and it is clear which side is outside and in which direction. Edges and corners become
/// round, with the inset as their radius.
struct Inset {
    std::vector<double> depth; ///< [m], >= 0, per vertex; 0 if the surface has no inside
    /// [-] parallel to vertexTriangles.items: the coefficient of each triangle's normal in the direction inwards
    std::vector<double> share;
};

/// Vertices are moved so far that each triangle around them moves by `depth` [m]. They move less if more than a quarter
/// of the body's thickness, or of an edge around them, would be taken off.
Inset makeInset(const CollisionShape& shape, double depth);

/// For features that stand for all that is within `radius` [m] of them: they are its surface moved inwards by that.
Inset roundInset(const CollisionShape& shape, double radius);

/// Moves the current vertices [m] of a shape inwards.
void applyInset(const CollisionShape& shape, const Inset& inset, std::vector<Vec3>& normals, std::span<Vec3> x);

} // namespace filasofia::engine
