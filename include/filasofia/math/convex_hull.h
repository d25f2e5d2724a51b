#pragma once

#include "filasofia/math/vec3.h"

#include <array>
#include <vector>

namespace filasofia {

/// The triangles of the convex hull of points, as indices, counter-clockwise seen from outside; none if the points lie
/// in a plane. Their surface is closed. The time grows with the square of the points.
std::vector<std::array<int, 3>> convexHull(const std::vector<Vec3>& points);

} // namespace filasofia
