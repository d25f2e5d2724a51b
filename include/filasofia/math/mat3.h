#pragma once

#include "filasofia/math/vec3.h"

namespace filasofia {

/// A 3 x 3 matrix stored by rows: m[r][c].
struct Mat3 {
    Vec3 row[3];

    constexpr Vec3& operator[](int r) { return row[r]; }
    constexpr const Vec3& operator[](int r) const { return row[r]; }
    [[nodiscard]] constexpr Vec3 column(int c) const { return {row[0][c], row[1][c], row[2][c]}; }

    static constexpr Mat3 identity() { return diagonal({1.0, 1.0, 1.0}); }
    static constexpr Mat3 diagonal(Vec3 d) { return {{{d.x, 0, 0}, {0, d.y, 0}, {0, 0, d.z}}}; }
    static constexpr Mat3 columns(Vec3 a, Vec3 b, Vec3 c)
    {
        return {{{a.x, b.x, c.x}, {a.y, b.y, c.y}, {a.z, b.z, c.z}}};
    }

    constexpr Mat3& operator+=(const Mat3& b) { return row[0] += b[0], row[1] += b[1], row[2] += b[2], *this; }
    constexpr Mat3& operator-=(const Mat3& b) { return row[0] -= b[0], row[1] -= b[1], row[2] -= b[2], *this; }
    constexpr Mat3& operator*=(double s) { return row[0] *= s, row[1] *= s, row[2] *= s, *this; }
    friend constexpr bool operator==(const Mat3&, const Mat3&) = default;
};

constexpr Mat3 operator+(Mat3 a, const Mat3& b) { return a += b; }
constexpr Mat3 operator-(Mat3 a, const Mat3& b) { return a -= b; }
constexpr Mat3 operator*(double s, Mat3 a) { return a *= s; }
constexpr Vec3 operator*(const Mat3& a, Vec3 v) { return {dot(a[0], v), dot(a[1], v), dot(a[2], v)}; }
constexpr Mat3 transpose(const Mat3& a) { return {{a.column(0), a.column(1), a.column(2)}}; }
constexpr Mat3 operator*(const Mat3& a, const Mat3& b)
{
    const auto rowTimes = [&](Vec3 r) { return r.x * b[0] + r.y * b[1] + r.z * b[2]; };
    return {{rowTimes(a[0]), rowTimes(a[1]), rowTimes(a[2])}};
}
/// a^T b without forming the transpose.
constexpr Mat3 transposeTimes(const Mat3& a, const Mat3& b) { return transpose(a) * b; }
constexpr Vec3 transposeTimes(const Mat3& a, Vec3 v) { return v.x * a[0] + v.y * a[1] + v.z * a[2]; }
constexpr double trace(const Mat3& a) { return a[0].x + a[1].y + a[2].z; }
constexpr double determinant(const Mat3& a) { return dot(a[0], cross(a[1], a[2])); }
/// a : b, the sum of the products of the entries.
constexpr double contract(const Mat3& a, const Mat3& b) { return dot(a[0], b[0]) + dot(a[1], b[1]) + dot(a[2], b[2]); }
inline double frobeniusNorm(const Mat3& a) { return std::sqrt(contract(a, a)); }
/// a b^T
constexpr Mat3 outer(Vec3 a, Vec3 b) { return {{a.x * b, a.y * b, a.z * b}}; }
/// The matrix of v -> a x v.
constexpr Mat3 crossMatrix(Vec3 a) { return {{{0, -a.z, a.y}, {a.z, 0, -a.x}, {-a.y, a.x, 0}}}; }
/// The inverse; the caller makes sure that the determinant is not zero.
constexpr Mat3 inverse(const Mat3& a)
{
    const Vec3 c0 = cross(a[1], a[2]), c1 = cross(a[2], a[0]), c2 = cross(a[0], a[1]);
    return (1.0 / dot(a[0], c0)) * Mat3::columns(c0, c1, c2);
}

} // namespace filasofia
