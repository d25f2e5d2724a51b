#pragma once

#include "filasofia/math/vec3.h"

#include <span>
#include <vector>

namespace filasofia::geometry {

/// The indices of points [m] along a Z-order curve through their bounding box (Morton 1966). Neighbours in the list are
/// mostly neighbours in space, so data that is used together lies together in memory. Points at the same position keep
/// their order.
std::vector<int> orderAlongCurve(std::span<const Vec3> points);

} // namespace filasofia::geometry
