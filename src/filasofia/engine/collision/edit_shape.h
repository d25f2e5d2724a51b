#pragma once

#include "filasofia/engine/collision/inset.h"
#include "filasofia/geometry/box.h"

#include <utility>

namespace filasofia::engine {

/// The change that a topology edit makes to a surface.
struct SurfaceEdit {
    std::vector<int> removed;                                     ///< removed triangles, ascending
    std::vector<std::pair<int, geometry::Triangle>> changed = {}; ///< triangles that get other vertices, ascending
    std::vector<geometry::Triangle> added = {};                   ///< new triangles, appended in this order
    std::vector<Vec3> vertices = {};                              ///< [m] new vertices at rest, appended
};

/// The old features' new indices. Vertices keep their indices.
struct ShapeChange {
    std::vector<int> triangles; ///< per old triangle: its new index; -1 if it was removed
    std::vector<int> edges;     ///< per old edge: the same
    std::vector<int> fresh;     ///< new indices of triangles that were added or changed, ascending
    std::vector<int> touched;   ///< vertices of these triangles, before and after the edit; ascending
    geometry::Box box;          ///< [m] around all of these triangles at rest
};

/// Builds the shape that makeCollisionShape() would build from the edited mesh, but for the order of elements in the
/// tree: the old tree is kept, with new elements inserted beside their neighbours, until half of it is new. Linear in
/// the size of the surface, without sorting it. The shape has triangles; lines of no triangle stay.
CollisionShape editShape(const CollisionShape& before, const SurfaceEdit& edit, ShapeChange& change);

/// Returns the inset that makeInset() would return for the edited shape, recomputed only near the edit.
Inset editInset(const Inset& inset, const CollisionShape& before, const CollisionShape& now, const ShapeChange& change,
                double depth);

} // namespace filasofia::engine
