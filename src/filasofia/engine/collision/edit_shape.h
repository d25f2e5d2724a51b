#pragma once

#include "filasofia/engine/collision/inset.h"
#include "filasofia/geometry/box.h"

#include <utility>

namespace filasofia::engine {

/// What a topology edit does to a surface.
struct SurfaceEdit {
    std::vector<int> removed;                                     ///< triangles that go, ascending
    std::vector<std::pair<int, geometry::Triangle>> changed = {}; ///< that get other vertices, ascending
    std::vector<geometry::Triangle> added = {};                   ///< behind those that are left, in this order
    std::vector<Vec3> vertices = {};                              ///< [m] at rest, behind those that are there
};

/// What became of a shape's features. Vertices keep their numbers.
struct ShapeChange {
    std::vector<int> triangles; ///< per old triangle: its number now; -1: it is gone
    std::vector<int> edges;     ///< per old edge: the same
    std::vector<int> fresh;     ///< triangles now that were added or changed, ascending
    std::vector<int> touched;   ///< vertices of those and of what was there before them, ascending
    geometry::Box box;          ///< [m] around all of these triangles at rest
};

/// The shape that makeCollisionShape() would make of the edited mesh, but for the order of what is in the tree: there
/// the old tree is kept, with what is new beside its neighbours, until half of it is new. Linear in the size of the
/// surface, without sorting it. The shape has triangles; lines of no triangle stay.
CollisionShape editShape(const CollisionShape& before, const SurfaceEdit& edit, ShapeChange& change);

/// What makeInset() would make for the edited shape, computed anew only near what has changed.
Inset editInset(const Inset& inset, const CollisionShape& before, const CollisionShape& now, const ShapeChange& change,
                double depth);

} // namespace filasofia::engine
