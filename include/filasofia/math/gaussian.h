#pragma once

#include "filasofia/math/vec3.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace filasofia {

/// The share of a Gaussian distribution below `x` standard deviations.
inline double gaussianBelow(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

/// What a straight way meets of a cloud whose density falls as a Gaussian: 1 for a whole line through its middle.
/// `radius` [m] is its standard deviation.
inline double gaussianColumn(Vec3 middle, double radius, Vec3 from, Vec3 to)
{
    const Vec3 way = to - from;
    const double far = length(way);
    if (!(far > 0.0)) return 0.0;
    const double along = dot(middle - from, way) / far;
    const double aside = std::max(lengthSquared(middle - from) - along * along, 0.0);
    return std::exp(-0.5 * aside / (radius * radius)) *
           (gaussianBelow((far - along) / radius) - gaussianBelow(-along / radius));
}

} // namespace filasofia
