#include "filasofia/geometry/solid_angle.h"

#include <cmath>

namespace filasofia::geometry {

double solidAngle(Vec3 point, Vec3 a, Vec3 b, Vec3 c)
{
    const Vec3 p = a - point, q = b - point, r = c - point;
    const double lp = length(p), lq = length(q), lr = length(r);
    return 2.0 * std::atan2(dot(p, cross(q, r)), lp * lq * lr + dot(p, q) * lr + dot(q, r) * lp + dot(r, p) * lq);
}

} // namespace filasofia::geometry
