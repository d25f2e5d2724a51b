#pragma once

#include "filasofia/mapping/map.h"

#include <array>

namespace filasofia::mapping {

/// A point on a mapped surface, and the frame that the surface carries there: +Z points outwards, and the frame rotates
/// with the triangle (by the rotation nearest to its deformation, so that no edge is preferred and stretching causes no
/// rotation).
struct SurfacePoint {
    geometry::Embedding corners;     ///< the triangle's corners, embedded in the body's nodes
    std::array<double, 3> weights{}; ///< barycentric weights of the corners
    Pose rest;                       ///< pose at rest
    Mat3 restInverse; ///< inverse of the matrix of the triangle's edges from its first corner and its scaled normal, at
                      ///< rest
    double scale = 0.0; ///< [m], length of that normal
};

/// The point of a triangle with the given weights of its corners: each in [0, 1], their sum 1. At rest the frame's +Y
/// is as close as possible to the world's +Y. Throws an Error naming `object`, the bound and the value if there is no
/// such triangle, it has no area, or the weights are invalid.
SurfacePoint pointOnTriangle(const MappedSurface& mapped, int triangle, const std::array<double, 3>& weights,
                             const std::string& object);

/// The point nearest to `place` [m, world, at rest] on a triangle that has an area; ties go to the lowest triangle.
/// Throws an Error naming `object` if there is none.
SurfacePoint nearestPoint(const MappedSurface& mapped, Vec3 place, const std::string& object);

/// The current position of the point and its frame. While the triangle has no area, or a node is not finite, the
/// orientation stays `last`.
Pose apply(const SurfacePoint& point, const frame::SoftBodyFrame& body, Quat last);

} // namespace filasofia::mapping
