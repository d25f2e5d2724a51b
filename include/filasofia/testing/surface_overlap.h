#pragma once

#include "filasofia/geometry/triangle_mesh.h"

#include <optional>
#include <span>
#include <vector>

namespace filasofia::testing {

/// A surface in its current place, of any number of triangles.
struct PlacedSurface {
    std::vector<Vec3> vertices = {};                ///< [m]
    std::vector<geometry::Triangle> triangles = {}; ///< outwards if closed
    bool closed = true;                             ///< it has an inside
};

/// Where two surfaces pass through each other deepest.
struct SurfaceOverlap {
    double depth =
        0.0; ///< [m] how deep a point is inside a closed surface, or the nearer end of an edge beyond an open one
    Vec3 place = {}; ///< [m] that point
};

/// Where `a` and `b` pass through each other, or lie inside each other; nothing if they do not. Every edge is tested
/// against every triangle, by the signs of volumes, and the depth is the distance to the nearest of all triangles: this
/// shares nothing with the search for contacts, and is slow. Vertices and, of an edge that passes through twice, the
/// middle between are the points that are measured.
std::optional<SurfaceOverlap> overlapOf(const PlacedSurface& a, const PlacedSurface& b);

/// How a line passes through a surface.
struct LineOverlap {
    /// [m] how deep its deepest point is inside a closed surface, or how far the end that reaches less far goes beyond
    /// an open one
    double depth = 0.0;
    Vec3 place = {};     ///< [m] that point
    double inside = 0.0; ///< [m] length of it inside a closed surface
};

/// How a line of edges passes through a surface; nothing if it does not. By the signs of volumes as above.
std::optional<LineOverlap> overlapOf(std::span<const Vec3> line, const PlacedSurface& surface);

} // namespace filasofia::testing
