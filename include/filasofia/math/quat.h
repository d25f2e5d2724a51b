#pragma once

#include "filasofia/math/mat3.h"

namespace filasofia {

/// A unit quaternion, which represents a rotation. w is the real part.
struct Quat {
    double w = 1.0;
    double x = 0.0;
    double y = 0.0;
    double z = 0.0;

    friend constexpr bool operator==(const Quat&, const Quat&) = default;
};

/// Applies b first, then a.
constexpr Quat operator*(Quat a, Quat b)
{
    return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}
constexpr Quat conjugate(Quat q) { return {q.w, -q.x, -q.y, -q.z}; }
constexpr double dot(Quat a, Quat b) { return a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z; }

/// q scaled to unit length; the identity if q has no length.
inline Quat normalized(Quat q)
{
    const double l = std::sqrt(dot(q, q));
    if (!(l > 1e-300)) return {};
    return {q.w / l, q.x / l, q.y / l, q.z / l};
}

constexpr Vec3 rotate(Quat q, Vec3 v)
{
    const Vec3 u{q.x, q.y, q.z};
    const Vec3 t = 2.0 * cross(u, v);
    return v + q.w * t + cross(u, t);
}

constexpr Mat3 toMat3(Quat q)
{
    const double xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z;
    const double xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z, wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
    return {{{1 - 2 * (yy + zz), 2 * (xy - wz), 2 * (xz + wy)},
             {2 * (xy + wz), 1 - 2 * (xx + zz), 2 * (yz - wx)},
             {2 * (xz - wy), 2 * (yz + wx), 1 - 2 * (xx + yy)}}};
}

/// The quaternion of a rotation matrix, w >= 0 (Shepperd's choice of the largest component).
Quat toQuat(const Mat3& rotation);

/// The rotation by `angle` [rad] about `axis` (any length; a zero axis gives the identity).
inline Quat axisAngle(Vec3 axis, double angle)
{
    const Vec3 u = normalized(axis);
    const double s = std::sin(0.5 * angle);
    return u == Vec3{} ? Quat{} : Quat{std::cos(0.5 * angle), s * u.x, s * u.y, s * u.z};
}

/// The rotation vector (axis times angle [rad], angle in [0, pi]) of a unit quaternion.
Vec3 rotationVector(Quat q);

inline bool isFinite(Quat q)
{
    return std::isfinite(q.w) && std::isfinite(q.x) && std::isfinite(q.y) && std::isfinite(q.z);
}

constexpr auto fields(const Quat*)
{
    return describe("Quat", field("w", &Quat::w, "-", closed(-1, 1), ""), field("x", &Quat::x, "-", closed(-1, 1), ""),
                    field("y", &Quat::y, "-", closed(-1, 1), ""), field("z", &Quat::z, "-", closed(-1, 1), ""));
}

} // namespace filasofia
