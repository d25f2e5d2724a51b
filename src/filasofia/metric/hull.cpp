#include "filasofia/metric/hull.h"

#include "filasofia/core/sorted.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>

namespace filasofia::metric {
namespace {

using Face = std::array<std::size_t, 3>; // counter-clockwise seen from outside

double signedVolume(Vec3 a, Vec3 b, Vec3 c, Vec3 d) { return dot(cross(b - a, c - a), d - a) / 6.0; }

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

/// Moves four points that span a volume to the front; false if there are none.
bool beginWithTetrahedron(std::vector<Vec3>& p, double tiny)
{
    const auto bring = [&p](std::size_t place, auto measure) {
        std::size_t best = place;
        for (std::size_t i = place; i < p.size(); ++i)
            if (measure(p[i]) > measure(p[best])) best = i;
        const double value = measure(p[best]);
        std::swap(p[place], p[best]);
        return value;
    };
    bring(1, [&](Vec3 x) { return distance(x, p[0]); });
    bring(2, [&](Vec3 x) { return length(cross(p[1] - p[0], x - p[0])); });
    if (bring(3, [&](Vec3 x) { return std::abs(signedVolume(p[0], p[1], p[2], x)); }) <= tiny) return false;
    return true;
}

/// Moves every point by about 1e-9 of the size, the same in every call, so that no four points lie in a plane and
/// rounding never decides which faces see a point. A single misjudged face would fold the surface.
void jitter(std::vector<Vec3>& points, double size)
{
    std::uint32_t state = 1;
    for (Vec3& point : points)
        for (int k = 0; k < 3; ++k) {
            state = state * 1664525u + 1013904223u; // Numerical Recipes
            point[k] += 1e-9 * size * (static_cast<double>(state) / 4294967296.0 - 0.5);
        }
}

} // namespace

double hullVolume(const std::vector<Vec3>& all)
{
    std::vector<Vec3> points = furthest(all);
    if (points.size() < 4) return 0.0;
    double size = 0.0;
    for (const Vec3& point : points) size = std::max(size, distance(point, points[0]));
    if (!beginWithTetrahedron(points, 1e-12 * size * size * size)) return 0.0;
    jitter(points, size);
    if (signedVolume(points[0], points[1], points[2], points[3]) > 0.0) std::swap(points[1], points[2]);

    // Add one point after another: the faces that see it are replaced by a cone from it to their rim.
    std::vector<Face> faces = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
    for (std::size_t i = 4; i < points.size(); ++i) {
        std::map<std::pair<std::size_t, std::size_t>, int> edges; // edges of the faces that see the point
        std::vector<Face> kept;
        for (const Face& face : faces) {
            if (signedVolume(points[face[0]], points[face[1]], points[face[2]], points[i]) <= 0.0) {
                kept.push_back(face);
                continue;
            }
            for (std::size_t k = 0; k < 3; ++k) ++edges[{face[k], face[(k + 1) % 3]}];
        }
        if (kept.size() == faces.size()) continue;
        for (const auto& [edge, count] : edges)
            if (!edges.contains({edge.second, edge.first})) kept.push_back({edge.first, edge.second, i});
        faces = std::move(kept);
    }
    double volume = 0.0;
    for (const Face& face : faces) volume -= signedVolume(points[face[0]], points[face[1]], points[face[2]], points[0]);
    return std::max(0.0, volume);
}

} // namespace filasofia::metric
