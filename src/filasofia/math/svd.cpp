#include "filasofia/math/svd.h"

#include <algorithm>
#include <utility>

namespace filasofia {
namespace {

constexpr int kMaxSweeps = 30; // convergence is quadratic: 3 x 3 needs 4 to 6

struct Columns {
    Vec3 c[3];
};

/// Any unit vector normal to a unit vector.
Vec3 anyNormal(Vec3 a)
{
    const Vec3 axis = std::abs(a.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    return normalized(cross(a, axis));
}

/// Rotates columns p and q of both matrices so that those of `a` become orthogonal; false if they already were.
bool rotatePair(Columns& a, Columns& v, int p, int q)
{
    const double alpha = lengthSquared(a.c[p]), beta = lengthSquared(a.c[q]), gamma = dot(a.c[p], a.c[q]);
    if (std::abs(gamma) <= 1e-16 * std::sqrt(alpha * beta) || gamma == 0.0) return false;
    const double zeta = (beta - alpha) / (2.0 * gamma);
    const double t = std::copysign(1.0, zeta) / (std::abs(zeta) + std::hypot(1.0, zeta));
    const double c = 1.0 / std::hypot(1.0, t), s = c * t;
    for (Columns* m : {&a, &v}) {
        const Vec3 old = m->c[p];
        m->c[p] = c * old - s * m->c[q];
        m->c[q] = s * old + c * m->c[q];
    }
    return true;
}

} // namespace

Svd svd(const Mat3& matrix)
{
    // Scale the matrix so that squares neither overflow nor vanish.
    double scale = 0.0;
    for (const Vec3& row : matrix.row)
        for (int i = 0; i < 3; ++i) scale = std::max(scale, std::abs(row[i]));
    if (!(scale > 0.0) || !std::isfinite(scale)) return {Mat3::identity(), {}, Mat3::identity()};

    Columns a, v{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    for (int i = 0; i < 3; ++i) a.c[i] = matrix.column(i) / scale;
    for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
        bool rotated = rotatePair(a, v, 0, 1);
        rotated |= rotatePair(a, v, 0, 2);
        rotated |= rotatePair(a, v, 1, 2);
        if (!rotated) break;
    }

    // Sort by length, largest first; each exchange flips one column's sign, so that v stays a rotation.
    const auto exchange = [&](int i, int j) {
        if (lengthSquared(a.c[i]) >= lengthSquared(a.c[j])) return;
        std::swap(a.c[i], a.c[j]);
        std::swap(v.c[i], v.c[j]);
        a.c[j] = -a.c[j];
        v.c[j] = -v.c[j];
    };
    exchange(0, 1);
    exchange(1, 2);
    exchange(0, 1);

    // The columns are u times sigma. A vanishing column has no direction: take any that completes the rotation.
    const Vec3 u0 = normalized(a.c[0]);
    const double s0 = length(a.c[0]);
    const bool line = length(a.c[1]) <= 1e-15 * s0;
    const Vec3 u1 = line ? anyNormal(u0) : normalized(a.c[1] - dot(a.c[1], u0) * u0);
    const Vec3 u2 = cross(u0, u1);
    const double s1 = line ? 0.0 : std::min(dot(a.c[1], u1), s0); // equal except for rounding: keep the order
    const double s2 = std::clamp(dot(a.c[2], u2), -s1, s1);
    return {Mat3::columns(u0, u1, u2), scale * Vec3{s0, s1, s2}, Mat3::columns(v.c[0], v.c[1], v.c[2])};
}

} // namespace filasofia
