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

/// Whether the point is inside the closed surface or as good as on it; its nearest place is known to be within
/// `distance` [m].
bool inside(const CollisionSurface& surface, Vec3 point, double distance);

} // namespace filasofia::engine
