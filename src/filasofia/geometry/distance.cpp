#include "filasofia/geometry/distance.h"

#include "filasofia/geometry/tet_mesh.h"

#include <limits>

namespace filasofia::geometry {
namespace {

// The result for a side of the simplex, expressed in the simplex's own corners.
template <int n, int m> Nearest<n> lifted(const Nearest<m>& side, const std::array<int, m>& corners)
{
    Nearest<n> all{side.point, {}, side.squaredDistance};
    for (int i = 0; i < m; ++i) all.weights[corners[i]] = side.weights[i];
    return all;
}

} // namespace

Nearest<2> nearestOnSegment(Vec3 p, Vec3 a, Vec3 b)
{
    const Vec3 ab = b - a;
    const double whole = lengthSquared(ab), along = dot(p - a, ab);
    double t = 0.0; // also if a and b coincide, or if a coordinate is NaN
    if (along > 0.0 && whole > 0.0) t = along < whole ? along / whole : 1.0;
    const Vec3 q = t < 1.0 ? a + t * ab : b;
    return {q, {1.0 - t, t}, lengthSquared(p - q)};
}

Nearest<3> nearestOnTriangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c)
{
    // Twice the areas of the triangles that p's projection makes with the sides, times twice that of the whole: if all
    // are positive, the projection falls inside (Ericson 2005, Real-Time Collision Detection, 5.1.5).
    const Vec3 normal = cross(b - a, c - a);
    const double u = dot(normal, cross(b - p, c - p));
    const double v = dot(normal, cross(c - p, a - p));
    const double w = dot(normal, cross(a - p, b - p));
    if (u > 0.0 && v > 0.0 && w > 0.0) {
        const double sum = u + v + w;
        const double wb = v / sum, wc = w / sum;
        const Vec3 q = a + wb * (b - a) + wc * (c - a);
        return {q, {u / sum, wb, wc}, lengthSquared(p - q)};
    }
    // Otherwise the nearest point lies on a side; a triangle without area consists of its sides only.
    const Vec3 corner[3] = {a, b, c};
    Nearest<3> best{{}, {}, std::numeric_limits<double>::infinity()};
    for (const std::array<int, 2> side : {std::array{0, 1}, {1, 2}, {2, 0}}) {
        const Nearest<2> here = nearestOnSegment(p, corner[side[0]], corner[side[1]]);
        if (here.squaredDistance < best.squaredDistance) best = lifted<3, 2>(here, side);
    }
    return best;
}

std::array<double, 4> barycentric(Vec3 p, Vec3 a, Vec3 b, Vec3 c, Vec3 d)
{
    // Cramer's rule in coordinates relative to a, so that a mesh far from the origin loses no precision.
    const Vec3 ab = b - a, ac = c - a, ad = d - a, ap = p - a;
    const double whole = dot(ab, cross(ac, ad));
    const double wb = dot(ap, cross(ac, ad)) / whole;
    const double wc = dot(ab, cross(ap, ad)) / whole;
    const double wd = dot(ab, cross(ac, ap)) / whole;
    return {1.0 - wb - wc - wd, wb, wc, wd};
}

Nearest<4> nearestInTetrahedron(Vec3 p, Vec3 a, Vec3 b, Vec3 c, Vec3 d)
{
    if (signedVolume(a, b, c, d) != 0.0) {
        const std::array<double, 4> w = barycentric(p, a, b, c, d);
        if (w[0] >= 0.0 && w[1] >= 0.0 && w[2] >= 0.0 && w[3] >= 0.0) return {p, w, 0.0};
    }
    const Vec3 corner[4] = {a, b, c, d};
    Nearest<4> best{{}, {}, std::numeric_limits<double>::infinity()};
    for (const std::array<int, 3>& face : kTetrahedronFaces) {
        const Nearest<3> here = nearestOnTriangle(p, corner[face[0]], corner[face[1]], corner[face[2]]);
        if (here.squaredDistance < best.squaredDistance) best = lifted<4, 3>(here, face);
    }
    return best;
}

double rayTriangle(Vec3 origin, Vec3 direction, Vec3 a, Vec3 b, Vec3 c)
{
    // Moeller and Trumbore 1997, Fast, minimum storage ray-triangle intersection.
    constexpr double kMiss = std::numeric_limits<double>::infinity();
    const Vec3 ab = b - a, ac = c - a, h = cross(direction, ac);
    const double det = dot(ab, h);
    if (det == 0.0) return kMiss;
    const Vec3 s = origin - a, q = cross(s, ab);
    const double u = dot(s, h) / det, v = dot(direction, q) / det, t = dot(ac, q) / det;
    return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0 ? t : kMiss;
}

} // namespace filasofia::geometry
