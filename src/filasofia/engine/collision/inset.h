#pragma once

#include "filasofia/engine/collision/collision_shape.h"

#include <span>

namespace filasofia::engine {

/// How the vertices of a surface are moved inwards before two surfaces are looked at, so that what counts as their gap
/// is the distance of what is left less what was taken off. While surfaces rest on each other, or are inside each other
/// by less than that, what is left stays apart: it is plain which side is out, and in which direction. Edges and
/// corners come out round, with the inset as their radius.
struct Inset {
    std::vector<double> depth; ///< [m], >= 0, per vertex; 0 where a surface has no inside
    std::vector<double> share; ///< [-] beside vertexTriangles.items: of each triangle's normal in the way inwards
};

/// Vertices go in so far that each triangle around them does by `depth` [m], or less where the body is so thin that
/// more than a quarter of it would be taken off, or its triangles that small.
Inset makeInset(const CollisionShape& shape, double depth);

/// Moves vertices [m] of a shape, as it is now, inwards.
void applyInset(const CollisionShape& shape, const Inset& inset, std::vector<Vec3>& normals, std::span<Vec3> x);

} // namespace filasofia::engine
