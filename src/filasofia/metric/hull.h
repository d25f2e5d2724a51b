#pragma once

#include "filasofia/math/vec3.h"

#include <vector>

namespace filasofia::metric {

/// The volume [m^3] of the convex hull; 0 of points in a plane. Exact for up to kDirections points; of more, the hull
/// of those that lie furthest in so many directions: at most a percent or so too small for something round.
double hullVolume(const std::vector<Vec3>& points);

inline constexpr std::size_t kDirections = 512;

} // namespace filasofia::metric
