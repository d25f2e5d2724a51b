#pragma once

#include "filasofia/engine/collision/bounds.h"
#include "filasofia/engine/collision/collision_shape.h"
#include "filasofia/engine/collision/plates.h"
#include "filasofia/engine/collision/sheet_side.h"

#include <memory>
#include <vector>

namespace filasofia::engine {

/// A shape in its current state.
struct CollisionSurface {
    /// Surfaces of one body collide with each other only if both have `self` set, and a soft one then also with itself.
    SurfaceName name;
    bool self = false; ///< that of the shape, or of its model once that has been cut
    /// The element of a rigid body, and the one that a joint connects it to (-1: none): they do not collide. -1 for a
    /// soft body.
    int element = -1, parent = -1;
    std::shared_ptr<const CollisionShape> shape;
    bool cuts = false;     ///< it passes through surfaces that are cuttable
    bool cuttable = false; ///< surfaces that cut pass through it
    /// [m] current vertices. Elements with a vertex that is not finite or beyond 1e9 m are not found.
    std::vector<Vec3> x;
    std::vector<Vec3> v; ///< [m/s] velocities in the coming step
    Vec3 spin = {};      ///< [rad/s] a rigid element's; zero for a soft body
    /// Per vertex: the number of its piece; -1: a fragment that meets nothing of its own body. Empty if there is only
    /// one piece.
    std::vector<int> pieceOf;
    /// Per triangle: the vertex that is the fourth corner of its tetrahedron; -1: it is not on the surface. Only of a
    /// solid that meets itself.
    std::vector<int> apexes;
    std::shared_ptr<const CollisionShape> apexesOf = {}; ///< the shape whose they are

    // Boxes and plates, for findProximities() and for what tests the surfaces after it: each bounds them anew.
    std::vector<Bounds> vertexBounds;
    std::vector<Bounds> elementBounds; ///< in the order of the shape's elements
    std::vector<Bounds> nodeBounds;
    std::vector<Plate> plates;                               ///< in the order of the shape's elements
    std::vector<Plate> restPlates;                           ///< the same at rest, of a solid that meets itself
    std::shared_ptr<const CollisionShape> restPlatesOf = {}; ///< the shape whose they are
    std::vector<Vec3>
        rest; ///< [m] vertices at rest, moved inwards as `x` is, if a surface that meets itself needs them
    std::shared_ptr<const CollisionShape> restOf = {}; ///< the shape whose they are
    Bounds whole{};
};

/// Computes boxes that hold every vertex now and at any time within `reach` [s], with `margin` [m] around it; as seen
/// by who moves with `drift` [m/s].
void boundVertices(CollisionSurface& surface, double reach, double margin, Vec3 drift = {});
/// Computes boxes that hold every vertex at any time within `dt` [s], with `margin` [m] around it, and those of
/// elements and nodes; as seen by who moves with `drift` [m/s]. Tighter than the other ones, which reach as far to all
/// sides.
void boundMotion(CollisionSurface& surface, double dt, Vec3 drift, double margin);
/// Computes the boxes of elements and nodes; to be called after boundVertices().
void boundTree(CollisionSurface& surface);

/// Computes all boxes, with the shape's depth around the vertices.
inline void boundSurface(CollisionSurface& surface, double reach)
{
    boundVertices(surface, reach, surface.shape->depth);
    boundTree(surface);
}
/// The same for the surface against itself; as seen by who moves with `drift` [m/s].
inline void boundAgainstItself(CollisionSurface& surface, double reach, Vec3 drift)
{
    boundVertices(surface, reach, surface.shape->ownDepth(), drift);
    boundTree(surface);
}

/// [m] The diagonal of the surface's box.
double sizeOf(const CollisionSurface& surface);

} // namespace filasofia::engine
