#pragma once

#include "filasofia/mapping/map.h"

#include <array>

namespace filasofia::mapping {

/// A point on a mapped surface, and the frame that the surface carries there: +Z points out of it, and the frame turns
/// as the triangle does (its nearest rotation, so no edge of it is preferred and stretching turns nothing).
struct SurfacePoint {
    geometry::Embedding corners;     ///< of the triangle, on the body's nodes
    std::array<double, 3> weights{}; ///< of the corners, barycentric
    Pose rest;                       ///< where it is at rest
    Mat3 restInverse;                ///< of the triangle's edges from its first corner and its scaled normal, at rest
    double scale = 0.0;              ///< [m], of that normal
};

/// The point of a triangle with these weights of its corners: each in [0, 1], their sum 1. At rest the frame's +Y is as
/// near to the world's as can be. Throws an Error naming `object`, the bound and the value where there is no such
/// triangle, it has no area, or the weights are wrong.
SurfacePoint pointOnTriangle(const MappedSurface& mapped, int triangle, const std::array<double, 3>& weights,
                             const std::string& object);

/// The point nearest to `place` [m, world, at rest] on a triangle that has an area; ties go to the lowest triangle.
/// Throws an Error naming `object` where there is none.
SurfacePoint nearestPoint(const MappedSurface& mapped, Vec3 place, const std::string& object);

/// Where the point and its frame are. While the triangle has no area, or a node is not finite, the orientation stays
/// `last`.
Pose apply(const SurfacePoint& point, const frame::SoftBodyFrame& body, Quat last);

} // namespace filasofia::mapping
