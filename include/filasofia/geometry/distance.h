#pragma once

#include "filasofia/math/vec3.h"

#include <array>

namespace filasofia::geometry {

/// The point of a simplex of n corners that is nearest to another point.
template <int n> struct Nearest {
    Vec3 point;
    std::array<double, n> weights{}; ///< barycentric, each in [0, 1]; they sum to 1 and reproduce `point`
    double squaredDistance = 0.0;    ///< [m^2]
};

/// All of these accept degenerate corners (coincident, collinear, coplanar) and then treat the simplex as the one of
/// lower dimension that it is.
Nearest<2> nearestOnSegment(Vec3 p, Vec3 a, Vec3 b);
Nearest<3> nearestOnTriangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c);
Nearest<4> nearestInTetrahedron(Vec3 p, Vec3 a, Vec3 b, Vec3 c, Vec3 d);

/// The barycentric weights of p: they sum to 1 and are negative outside. The volume must not be zero.
std::array<double, 4> barycentric(Vec3 p, Vec3 a, Vec3 b, Vec3 c, Vec3 d);

/// The distance along the ray from `origin` to the triangle, hit from either side, in lengths of `direction`; infinity
/// if the ray misses the triangle or runs in its plane.
double rayTriangle(Vec3 origin, Vec3 direction, Vec3 a, Vec3 b, Vec3 c);

} // namespace filasofia::geometry
