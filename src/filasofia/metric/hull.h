#pragma once

#include "filasofia/math/vec3.h"

#include <vector>

namespace filasofia::metric {

/// The volume [m^3] of the convex hull; 0 for points in a plane. Exact for up to kDirections points. For more points,
/// the hull of those that lie furthest in as many directions: at most about a percent too small for round shapes.
double hullVolume(const std::vector<Vec3>& points);

inline constexpr std::size_t kDirections = 512;

} // namespace filasofia::metric
