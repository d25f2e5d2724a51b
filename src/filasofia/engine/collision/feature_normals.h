#pragma once

#include "filasofia/engine/collision/collision_surface.h"

namespace filasofia::engine {

/// Normals that point outwards if the surface is closed. They are not of unit length, and 0 if the triangles have no
/// area. They give a point's distance the right sign (Baerentzen and Aanaes 2005, Signed distance computation using the
/// angle weighted pseudonormal); any other normal of an edge or vertex gives a wrong sign somewhere.
Vec3 faceNormal(const CollisionSurface& surface, int triangle); ///< length: twice the area
Vec3 edgeNormal(const CollisionSurface& surface, int edge);
Vec3 vertexNormal(const CollisionSurface& surface, int vertex);
/// That of a face, edge or vertex by its vertices (-1: unused); 0 if the surface's triangles have no such feature.
Vec3 featureNormal(const CollisionSurface& surface, const std::array<int, 3>& vertices);

/// Whether a feature is at the rim of a sheet: an edge with one triangle, or an end of such an edge.
bool rimEdge(const CollisionShape& shape, int edge);
bool rimVertex(const CollisionShape& shape, int vertex);

struct NearestOnSurface {
    int triangle = -1; ///< -1 if no triangle is that near
    std::array<double, 3> weights{};
    Vec3 place;
    Vec3 normal; ///< normal of the face, edge or vertex that holds the nearest place
};
/// Finds the place on the surface's triangles that is nearest to a point, if there is one within `distance` [m] (it may
/// be a little farther).
NearestOnSurface nearestOn(const CollisionSurface& surface, Vec3 point, double distance);

/// Whether the point is inside the closed surface or within rounding of it. The nearest place must be known to be
/// within `distance` [m].
bool inside(const CollisionSurface& surface, Vec3 point, double distance);

/// [m] How deep the point is inside the closed surface; 0 outside.
double depthInside(const CollisionSurface& surface, Vec3 point);

} // namespace filasofia::engine
