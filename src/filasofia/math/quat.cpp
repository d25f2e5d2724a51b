#include "filasofia/math/quat.h"

#include <algorithm>

namespace filasofia {

Quat toQuat(const Mat3& m)
{
    // Four times the squares of w, x, y, z; dividing by the largest is safe.
    const double t = trace(m);
    const double square[4] = {1 + t, 1 + 2 * m[0].x - t, 1 + 2 * m[1].y - t, 1 + 2 * m[2].z - t};
    const auto largest = std::max_element(square, square + 4) - square;
    Quat q;
    switch (largest) {
    case 0:
        q = {square[0], m[2].y - m[1].z, m[0].z - m[2].x, m[1].x - m[0].y};
        break;
    case 1:
        q = {m[2].y - m[1].z, square[1], m[0].y + m[1].x, m[0].z + m[2].x};
        break;
    case 2:
        q = {m[0].z - m[2].x, m[0].y + m[1].x, square[2], m[1].z + m[2].y};
        break;
    default:
        q = {m[1].x - m[0].y, m[0].z + m[2].x, m[1].z + m[2].y, square[3]};
        break;
    }
    q = normalized(q);
    return q.w < 0 ? Quat{-q.w, -q.x, -q.y, -q.z} : q;
}

Vec3 rotationVector(Quat q)
{
    if (q.w < 0) q = {-q.w, -q.x, -q.y, -q.z}; // the shorter way round
    const Vec3 u{q.x, q.y, q.z};
    const double s = length(u);
    // Near zero the angle is 2 s to first order, and the axis is lost in rounding: use the limit.
    return s < 1e-12 ? 2.0 * u : 2.0 * std::atan2(s, q.w) / s * u;
}

} // namespace filasofia
