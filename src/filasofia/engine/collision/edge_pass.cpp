#include "filasofia/engine/collision/edge_pass.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

constexpr double kInstant = 1e-7; // [-] part of the step: times that are nearer to each other are the same

// What is linear in time, at the start and at the end.
struct Moving {
    Vec3 from, to;
    [[nodiscard]] Vec3 at(double t) const { return from + t * (to - from); }
};

// Six times the volume of the tetrahedron of both edges, a cubic of time, as Bezier's four numbers: if none differs in
// sign from the others, the cubic has no zero.
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

struct PassQuery {
    Moving u, v, r; // both edges, and from the start of the first to that of the second
    double near;

    // Whether the edges themselves meet at that time, where their lines are nearest to each other.
    [[nodiscard]] bool meetAt(double t) const
    {
        const Vec3 ut = u.at(t), vt = v.at(t), rt = r.at(t);
        const double uu = dot(ut, ut), vv = dot(vt, vt), uv = dot(ut, vt), ur = dot(ut, rt), vr = dot(vt, rt);
        const double area = uu * vv - uv * uv;
        if (!(area > 1e-10 * uu * vv)) return false;
        const double first = std::clamp((ur * vv - uv * vr) / area, 0.0, 1.0);
        const double second = std::clamp((ur * uv - uu * vr) / area, 0.0, 1.0);
        return length(rt + second * vt - first * ut) <= near;
    }

    [[nodiscard]] bool search(const Cubic& cubic, double from, double to) const
    {
        if (!hasZero(cubic)) return false;
        const double middle = 0.5 * (from + to);
        if (to - from < kInstant) return meetAt(middle);
        const auto [early, late] = halves(cubic);
        return search(early, from, middle) || search(late, middle, to);
    }
};

} // namespace

bool passesThrough(const MovedEdge& one, const MovedEdge& two, double near)
{
    const Moving u{one.from[1] - one.from[0], one.to[1] - one.to[0]};
    const Moving v{two.from[1] - two.from[0], two.to[1] - two.to[0]};
    const Moving r{two.from[0] - one.from[0], two.to[0] - one.to[0]};
    const Vec3 uv = cross(u.from, v.from), uV = cross(u.from, v.to), Uv = cross(u.to, v.from), UV = cross(u.to, v.to);
    const Cubic cubic{dot(uv, r.from), (dot(uv, r.to) + dot(uV, r.from) + dot(Uv, r.from)) / 3.0,
                      (dot(UV, r.from) + dot(uV, r.to) + dot(Uv, r.to)) / 3.0, dot(UV, r.to)};
    // All zeros: both edges stay in one plane, and pass through each other only end over end.
    if (cubic == Cubic{}) return false;
    return PassQuery{u, v, r, near}.search(cubic, 0.0, 1.0);
}

} // namespace filasofia::engine
