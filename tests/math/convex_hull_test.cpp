#include "filasofia/math/convex_hull.h"

#include <map>
#include <random>
#include <set>

namespace convex_hull_test {

using namespace filasofia;

namespace {

double volumeOf(Vec3 a, Vec3 b, Vec3 c, Vec3 d) { return dot(b - a, cross(c - a, d - a)) / 6.0; }

/// The volume inside, which is positive if the triangles face outwards.
double volumeIn(const std::vector<std::array<int, 3>>& hull, const std::vector<Vec3>& p)
{
    double sum = 0.0;
    for (const auto& [a, b, c] : hull) sum -= volumeOf(p[a], p[b], p[c], {});
    return sum;
}

/// Whether each edge has two triangles, which pass it in opposite directions.
bool isClosed(const std::vector<std::array<int, 3>>& hull)
{
    std::map<std::pair<int, int>, int> edges;
    for (const auto& t : hull)
        for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
    for (const auto& [edge, count] : edges)
        if (count != 1 || !edges.contains({edge.second, edge.first})) return false;
    return true;
}

} // namespace

TEST_CASE("the hull of points is closed, faces outwards and has every point inside")
{
    std::mt19937 random(3);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    for (int round = 0; round < 20; ++round) {
        std::vector<Vec3> points;
        for (int i = 0; i < 60; ++i) points.push_back({any(random), 0.5 * any(random), 3.0 + any(random)});
        const auto hull = convexHull(points);
        CHECK(isClosed(hull));
        double outside = 0.0;
        std::set<int> corners;
        for (const auto& [a, b, c] : hull) {
            corners.insert({a, b, c});
            for (const Vec3 p : points) outside = std::max(outside, volumeOf(points[a], points[b], points[c], p));
        }
        CHECK(outside < 1e-7);
        CHECK(volumeIn(hull, points) > 0.1);
        CHECK(hull.size() == 2 * corners.size() - 4); // Euler
    }
}

TEST_CASE("the hull of a cube with points on its sides is the cube, and of a plane nothing")
{
    std::vector<Vec3> points;
    for (int i = 0; i < 27; ++i) points.push_back({0.5 * (i % 3), 0.5 * (i / 3 % 3), 0.5 * (i / 9)});
    CHECK(isClosed(convexHull(points)));
    CHECK(volumeIn(convexHull(points), points) == Approx(1.0).epsilon(1e-8));
    for (Vec3& p : points) p.z = 0.25;
    CHECK(convexHull(points).empty());
    CHECK(convexHull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}).empty());
    CHECK(convexHull(std::vector<Vec3>(9, Vec3{1, 2, 3})).empty());
}

} // namespace convex_hull_test
