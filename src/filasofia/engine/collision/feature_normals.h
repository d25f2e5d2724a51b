#pragma once

#include "filasofia/engine/collision/collision_surface.h"

namespace filasofia::engine {

/// Outward where the surface is closed; not of unit length, and 0 where the triangles have no area. The sign of a
/// point's distance is right with these (Baerentzen and Aanaes 2005, Signed distance computation using the angle
/// weighted pseudonormal): with any other normal of an edge or vertex it is wrong somewhere.
Vec3 faceNormal(const CollisionSurface& surface, int triangle); ///< length: twice the area
Vec3 edgeNormal(const CollisionSurface& surface, int edge);
Vec3 vertexNormal(const CollisionSurface& surface, int vertex);

/// At the rim of a sheet: an edge with one triangle, and its ends.
bool rimEdge(const CollisionShape& shape, int edge);
bool rimVertex(const CollisionShape& shape, int vertex);

struct NearestOnSurface {
    int triangle = -1; ///< -1: there is none as near as that
    std::array<double, 3> weights{};
    Vec3 place;
    Vec3 normal; ///< of the face, edge or vertex that it is on
};
/// What of the surface's triangles is nearest to a point, where something is within `distance` [m] (it may be a little
/// farther).
NearestOnSurface nearestOn(const CollisionSurface& surface, Vec3 point, double distance);

/// Whether the point is inside the closed surface or as good as on it; its nearest place is known to be within
/// `distance` [m].
bool inside(const CollisionSurface& surface, Vec3 point, double distance);

} // namespace filasofia::engine
