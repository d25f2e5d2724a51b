#include "filasofia/engine/collision/feature_pass.h"

#include "filasofia/geometry/distance.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

constexpr double kInstant = 1e-7; // [-] part of the step: times that are nearer to each other are the same

// Six times the volume of the tetrahedron of four points that move, a cubic of time, as Bezier's four numbers: if none
// differs in sign from the others, the cubic has no zero.
using Cubic = std::array<double, 4>;

bool hasZero(const Cubic& c)
{
    const auto [low, high] = std::minmax({c[0], c[1], c[2], c[3]});
    return low <= 0.0 && high >= 0.0;
}

std::array<Cubic, 2> halves(const Cubic& c)
{
    const double a = 0.5 * (c[0] + c[1]), b = 0.5 * (c[1] + c[2]), d = 0.5 * (c[2] + c[3]);
    const double e = 0.5 * (a + b), f = 0.5 * (b + d), middle = 0.5 * (e + f);
    return {Cubic{c[0], a, e, middle}, Cubic{middle, f, d, c[3]}};
}

MovedPoint operator-(const MovedPoint& a, const MovedPoint& b) { return {a.from - b.from, a.to - b.to}; }

/// (u x v) r
Cubic volumeOf(const MovedPoint& u, const MovedPoint& v, const MovedPoint& r)
{
    const Vec3 uv = cross(u.from, v.from), uV = cross(u.from, v.to), Uv = cross(u.to, v.from), UV = cross(u.to, v.to);
    return {dot(uv, r.from), (dot(uv, r.to) + dot(uV, r.from) + dot(Uv, r.from)) / 3.0,
            (dot(UV, r.from) + dot(uV, r.to) + dot(Uv, r.to)) / 3.0, dot(UV, r.to)};
}

// What meetAt(time) returns at the first zero of the cubic at which it returns something.
template <class MeetAt> auto firstAt(const Cubic& cubic, const MeetAt& meetAt, double from = 0.0, double to = 1.0)
    -> decltype(meetAt(from))
{
    if (!hasZero(cubic)) return std::nullopt;
    const double middle = 0.5 * (from + to);
    if (to - from < kInstant) return meetAt(middle);
    const auto [early, late] = halves(cubic);
    if (const auto found = firstAt(early, meetAt, from, middle)) return found;
    return firstAt(late, meetAt, middle, to);
}

} // namespace

std::optional<EdgesMeet> firstMeeting(const MovedEdge& one, const MovedEdge& two, double near)
{
    const MovedPoint u = one[1] - one[0], v = two[1] - two[0], r = two[0] - one[0];
    const Cubic cubic = volumeOf(u, v, r);
    // All zeros: both edges stay in one plane, and pass through each other only end over end.
    if (cubic == Cubic{}) return std::nullopt;
    // Whether the edges themselves meet at that time, where their lines are nearest to each other.
    return firstAt(cubic, [&](double time) -> std::optional<EdgesMeet> {
        const Vec3 ut = u.at(time), vt = v.at(time), rt = r.at(time);
        const double uu = dot(ut, ut), vv = dot(vt, vt), uv = dot(ut, vt), ur = dot(ut, rt), vr = dot(vt, rt);
        const double area = uu * vv - uv * uv;
        if (!(area > 1e-10 * uu * vv)) return std::nullopt;
        const double first = std::clamp((ur * vv - uv * vr) / area, 0.0, 1.0);
        const double second = std::clamp((ur * uv - uu * vr) / area, 0.0, 1.0);
        if (!(length(rt + second * vt - first * ut) <= near)) return std::nullopt;
        return EdgesMeet{time, first, second};
    });
}

std::optional<PointMeets> firstMeeting(const MovedPoint& point, const MovedTriangle& triangle, double near)
{
    const MovedPoint u = triangle[1] - triangle[0], v = triangle[2] - triangle[0], r = point - triangle[0];
    const Cubic cubic = volumeOf(u, v, r);
    if (cubic == Cubic{}) return std::nullopt; // it stays in the triangle's plane, and may only come over its rim
    return firstAt(cubic, [&](double time) -> std::optional<PointMeets> {
        const auto nearest = geometry::nearestOnTriangle(r.at(time), {}, u.at(time), v.at(time));
        if (!(nearest.squaredDistance <= near * near)) return std::nullopt;
        return PointMeets{time, nearest.weights};
    });
}

} // namespace filasofia::engine
