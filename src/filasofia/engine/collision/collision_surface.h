#pragma once

#include "filasofia/engine/collision/bounds.h"
#include "filasofia/engine/collision/collision_shape.h"
#include "filasofia/engine/collision/side_kept.h"

#include <memory>
#include <vector>

namespace filasofia::engine {

/// A shape where it is now.
struct CollisionSurface {
    SurfaceName name; ///< surfaces of one body do not meet, but for one whose shape has `self` set: with itself
    std::shared_ptr<const CollisionShape> shape;
    bool cuttable = false; ///< surfaces that cut do not touch it
    std::vector<Vec3> x;   ///< [m] vertices now; what has a vertex that is not finite or beyond 1e9 m is not found
    std::vector<Vec3> v;   ///< [m/s] with which they will move in the coming step

    // Boxes for this step: written by findProximities.
    std::vector<Bounds> vertexBounds;
    std::vector<Bounds> elementBounds; ///< in the order of the shape's elements
    std::vector<Bounds> nodeBounds;
    Bounds whole{};
};

/// Boxes that hold every vertex now and at any time within `reach` [s], with the shape's depth around it.
void boundVertices(CollisionSurface& surface, double reach);
/// Those of elements and nodes; after boundVertices().
void boundTree(CollisionSurface& surface);

} // namespace filasofia::engine
