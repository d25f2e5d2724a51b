#include "filasofia/math/convex_hull.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <utility>

namespace filasofia {
namespace {

using Triangle = std::array<int, 3>;

double volumeOf(Vec3 a, Vec3 b, Vec3 c, Vec3 d) { return dot(b - a, cross(c - a, d - a)) / 6.0; }

/// The numbers of the points, four that span a volume first; none if there are no such four.
std::vector<int> tetrahedronFirst(const std::vector<Vec3>& p, double tiny)
{
    std::vector<int> order(p.size());
    std::iota(order.begin(), order.end(), 0);
    const auto bring = [&](std::size_t place, const auto& measure) {
        const auto best = std::max_element(order.begin() + static_cast<std::ptrdiff_t>(place), order.end(),
                                           [&](int a, int b) { return measure(p[a]) < measure(p[b]); });
        std::swap(order[place], *best);
        return measure(p[order[place]]);
    };
    const Vec3 a = p[0];
    bring(1, [&](Vec3 x) { return distance(x, a); });
    const Vec3 b = p[order[1]];
    bring(2, [&](Vec3 x) { return length(cross(b - a, x - a)); });
    const Vec3 c = p[order[2]];
    if (!(bring(3, [&](Vec3 x) { return std::abs(volumeOf(a, b, c, x)); }) > tiny)) return {};
    return order;
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

std::vector<Triangle> convexHull(const std::vector<Vec3>& points)
{
    if (points.size() < 4) return {};
    double size = 0.0;
    for (const Vec3& point : points) size = std::max(size, distance(point, points[0]));
    std::vector<int> order = tetrahedronFirst(points, 1e-12 * size * size * size);
    if (order.empty()) return {};
    std::vector<Vec3> p = points;
    jitter(p, size);
    if (volumeOf(p[order[0]], p[order[1]], p[order[2]], p[order[3]]) > 0.0) std::swap(order[1], order[2]);

    // Add one point after another: the faces that see it are replaced by a cone from it to their rim.
    std::vector<Triangle> faces;
    for (const auto& [a, b, c] : {Triangle{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}})
        faces.push_back({order[a], order[b], order[c]});
    for (std::size_t i = 4; i < order.size(); ++i) {
        std::map<std::pair<int, int>, int> edges; // edges of the faces that see the point
        std::vector<Triangle> kept;
        for (const Triangle& face : faces) {
            if (volumeOf(p[face[0]], p[face[1]], p[face[2]], p[order[i]]) <= 0.0) {
                kept.push_back(face);
                continue;
            }
            for (std::size_t k = 0; k < 3; ++k) ++edges[{face[k], face[(k + 1) % 3]}];
        }
        if (kept.size() == faces.size()) continue;
        for (const auto& [edge, count] : edges)
            if (!edges.contains({edge.second, edge.first})) kept.push_back({edge.first, edge.second, order[i]});
        faces = std::move(kept);
    }
    return faces;
}

} // namespace filasofia
