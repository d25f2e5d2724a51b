#include "filasofia/surface/outline.h"

#include <optional>

namespace filasofia::surface {
namespace {

using Point = std::array<double, 2>;

double across(Point a, Point b, Point c) { return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]); }

/// Where two edges cross between their ends.
std::optional<Point> crossing(Point a, Point b, Point c, Point d)
{
    const double ofC = across(a, b, c), ofD = across(a, b, d);
    if ((ofC > 0.0) == (ofD > 0.0) || ofC == ofD) return {};
    if ((across(c, d, a) > 0.0) == (across(c, d, b) > 0.0)) return {};
    const double t = ofC / (ofC - ofD);
    return Point{c[0] + t * (d[0] - c[0]), c[1] + t * (d[1] - c[1])};
}

/// The first two edges that cross, and where.
struct Cross {
    std::size_t first = 0, second = 0;
    Point place = {};
};
std::optional<Cross> firstCross(const Outline& outline)
{
    const std::size_t n = outline.size();
    for (std::size_t i = 0; i + 2 < n; ++i)
        for (std::size_t j = i + 2; j < n; ++j) {
            if (i == 0 && j + 1 == n) continue; // they share a corner
            if (const auto at = crossing(outline[i], outline[i + 1], outline[j], outline[(j + 1) % n]))
                return Cross{i, j, *at};
        }
    return {};
}

} // namespace

bool crossesItself(const Outline& outline) { return firstCross(outline).has_value(); }

std::vector<Outline> lobesOf(const Outline& outline)
{
    std::vector<Outline> lobes, open{outline};
    // Each cut leaves one crossing less. The limit is for rounding.
    for (std::size_t cuts = 0; !open.empty(); ++cuts) {
        Outline now = std::move(open.back());
        open.pop_back();
        const auto at = cuts < outline.size() * outline.size() ? firstCross(now) : std::nullopt;
        if (!at) {
            lobes.push_back(std::move(now));
            continue;
        }
        Outline inner{at->place}, outer(now.begin(), now.begin() + static_cast<std::ptrdiff_t>(at->first) + 1);
        inner.insert(inner.end(), now.begin() + static_cast<std::ptrdiff_t>(at->first) + 1,
                     now.begin() + static_cast<std::ptrdiff_t>(at->second) + 1);
        outer.push_back(at->place);
        outer.insert(outer.end(), now.begin() + static_cast<std::ptrdiff_t>(at->second) + 1, now.end());
        open.push_back(std::move(outer));
        open.push_back(std::move(inner));
    }
    return lobes;
}

AreaMoments momentsOf(const Outline& outline)
{
    AreaMoments m;
    Point first{}; // about the first corner: little is lost to rounding
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const Point o = outline.front(), &a = outline[i], &b = outline[(i + 1) % outline.size()];
        const double ax = a[0] - o[0], ay = a[1] - o[1], bx = b[0] - o[0], by = b[1] - o[1];
        const double twice = ax * by - bx * ay;
        m.area += twice / 2.0;
        first[0] += twice * (ax + bx) / 6.0;
        first[1] += twice * (ay + by) / 6.0;
        m.xx += twice * (ax * ax + ax * bx + bx * bx) / 12.0;
        m.yy += twice * (ay * ay + ay * by + by * by) / 12.0;
        m.xy += twice * (2.0 * ax * ay + ax * by + bx * ay + 2.0 * bx * by) / 24.0;
    }
    if (m.area == 0.0) return {};
    m.xx -= first[0] * first[0] / m.area;
    m.yy -= first[1] * first[1] / m.area;
    m.xy -= first[0] * first[1] / m.area;
    return m;
}

} // namespace filasofia::surface
