#include "filasofia/metric/hull.h"

#include "filasofia/core/sorted.h"
#include "filasofia/math/convex_hull.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace filasofia::metric {
namespace {

/// The points that lie furthest in directions spread evenly over the sphere (a Fibonacci spiral).
std::vector<Vec3> furthest(const std::vector<Vec3>& points)
{
    if (points.size() <= kDirections) return points;
    std::vector<std::size_t> chosen;
    for (std::size_t k = 0; k < kDirections; ++k) {
        const double z = 1.0 - (2.0 * static_cast<double>(k) + 1.0) / kDirections, r = std::sqrt(1.0 - z * z),
                     turn = static_cast<double>(k) * std::numbers::pi * (3.0 - std::sqrt(5.0));
        const Vec3 direction = {r * std::cos(turn), r * std::sin(turn), z};
        std::size_t best = 0;
        double largest = dot(direction, points[0]);
        for (std::size_t i = 1; i < points.size(); ++i)
            if (const double far = dot(direction, points[i]); far > largest) largest = far, best = i;
        chosen.push_back(best);
    }
    sortUnique(chosen);
    std::vector<Vec3> kept;
    for (const std::size_t i : chosen) kept.push_back(points[i]);
    return kept;
}

} // namespace

double hullVolume(const std::vector<Vec3>& all)
{
    const std::vector<Vec3> points = furthest(all);
    double volume = 0.0;
    for (const auto& [a, b, c] : convexHull(points))
        volume += dot(points[a] - points[0], cross(points[b] - points[0], points[c] - points[0])) / 6.0;
    return std::max(0.0, volume);
}

} // namespace filasofia::metric
