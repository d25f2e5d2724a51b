#pragma once

#include "filasofia/math/vec3.h"

#include <array>

namespace filasofia::geometry {

/// Where on a simplex of n corners the point nearest to another one lies.
template <int n> struct Nearest {
    Vec3 point;
    std::array<double, n> weights{}; ///< barycentric, each in [0, 1]; they sum to 1 and give `point`
    double squaredDistance = 0.0;    ///< [m^2]
};

/// All of these take degenerate corners (coincident, collinear, coplanar) and then answer for the simplex that is left.
Nearest<2> nearestOnSegment(Vec3 p, Vec3 a, Vec3 b);
Nearest<3> nearestOnTriangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c);
Nearest<4> nearestInTetrahedron(Vec3 p, Vec3 a, Vec3 b, Vec3 c, Vec3 d);

/// The weights that give p as a mean of the corners; they sum to 1, negative outside. The volume is not zero.
std::array<double, 4> barycentric(Vec3 p, Vec3 a, Vec3 b, Vec3 c, Vec3 d);

/// How far along the ray from `origin` it meets the triangle, from either side, in lengths of `direction`; infinity
/// where it does not, and where it runs in the triangle's plane.
double rayTriangle(Vec3 origin, Vec3 direction, Vec3 a, Vec3 b, Vec3 c);

} // namespace filasofia::geometry
