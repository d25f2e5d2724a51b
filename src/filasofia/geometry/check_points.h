#pragma once

#include "filasofia/core/error.h"
#include "filasofia/math/vec3.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string_view>

namespace filasofia::geometry {

/// [m] Up to this size, volumes (lengths to the third power), moments of inertia (fifth) and their determinants
/// (fifteenth) fit in a double, so that checks compare numbers and never infinities.
inline constexpr double kMaxCoordinate = 1e20;

/// Throws an Error "<name>: <what> <i> must ..." unless every point is finite and every coordinate within the bound.
inline void checkPoints(std::span<const Vec3> points, std::string_view name, std::string_view what)
{
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3 p = points[i];
        if (!isFinite(p)) fail(name, ": ", what, " ", i, " must be finite, got ", p.x, " ", p.y, " ", p.z);
        if (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > kMaxCoordinate)
            fail(name, ": ", what, " ", i, " must have coordinates within ", kMaxCoordinate, " m of the origin, got ",
                 p.x, " ", p.y, " ", p.z);
    }
}

} // namespace filasofia::geometry
