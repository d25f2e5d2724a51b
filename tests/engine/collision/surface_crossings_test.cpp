#include "engine/collision/scene.h"

#include "filasofia/engine/collision/surface_crossings.h"

#include <set>
#include <tuple>

namespace filasofia::engine::surface_crossings_test {
namespace {

using Key = std::tuple<std::array<int, 2>, std::array<int, 2>, geometry::Triangle>; // surfaces, edge, triangle

/// Six times the signed volume of a tetrahedron.
double volume(Vec3 a, Vec3 b, Vec3 c, Vec3 d) { return dot(cross(b - a, c - a), d - a); }

/// A reference for findSurfaceCrossings(): every edge against every triangle by the signs of five volumes.
std::set<Key> bruteForce(const Scene& scene, int first, int second)
{
    std::set<Key> found;
    const auto test = [&](int edges, int triangles) {
        const CollisionSurface &e = scene.surfaces[static_cast<std::size_t>(edges)],
                               &t = scene.surfaces[static_cast<std::size_t>(triangles)];
        for (const std::array<int, 2>& edge : e.shape->edges)
            for (const geometry::Triangle& triangle : t.shape->triangles) {
                const Vec3 p = e.x[edge[0]], q = e.x[edge[1]];
                const Vec3 a = t.x[triangle[0]], b = t.x[triangle[1]], c = t.x[triangle[2]];
                if (volume(a, b, c, p) * volume(a, b, c, q) >= 0.0) continue;
                const double ab = volume(p, q, a, b), bc = volume(p, q, b, c), ca = volume(p, q, c, a);
                if ((ab > 0.0) == (bc > 0.0) && (bc > 0.0) == (ca > 0.0))
                    found.insert({{edges, triangles}, edge, triangle});
            }
    };
    test(first, second);
    if (first != second) test(second, first);
    return found;
}

std::vector<SurfaceCrossing> crossingsOf(Scene& scene, int first, int second, int threads = 1)
{
    scene.find();
    WorkerPool pool(threads);
    std::vector<SurfaceCrossing> found;
    if (std::ranges::find(scene.scratch.surfacePairs, std::array{first, second}) == scene.scratch.surfacePairs.end())
        return found; // their boxes are apart
    const auto at = [&](int i) { return &scene.surfaces[static_cast<std::size_t>(i)]; };
    findSurfaceCrossings({{at(first), at(second)}, {first, second}, 0.0}, pool, scene.scratch, found);
    return found;
}

std::set<Key> keysOf(const std::vector<SurfaceCrossing>& crossings)
{
    std::set<Key> keys;
    for (const SurfaceCrossing& each : crossings) keys.insert({each.surfaces, each.edge, each.triangle});
    CHECK(keys.size() == crossings.size());
    return keys;
}

Pose randomPose(std::mt19937& random, double reach)
{
    std::normal_distribution<double> number;
    const double w = number(random), x = number(random), y = number(random);
    return {randomVector(random, reach), normalized(Quat{w, x, y, number(random)})};
}

} // namespace

TEST_CASE("edges through triangles are those that brute force finds")
{
    std::mt19937 random(5);
    std::size_t crossings = 0, apart = 0;
    for (int trial = 0; trial < 200; ++trial) {
        Scene scene;
        scene.add(lumpMesh(0.01, 8, 0.3, random), {.proximity = 0.5e-3});
        const Pose pose = randomPose(random, 0.02);
        switch (trial % 3) {
        case 0:
            scene.add(lumpMesh(0.008, 6, 0.2, random), {.proximity = 0.5e-3}, pose);
            break;
        case 1:
            scene.add(sheetMesh(0.01, 5), {.proximity = 0.5e-3}, pose);
            break;
        default:
            scene.add(boxMesh({0.01, 0.002, 0.005}, 2), {.proximity = 0.5e-3}, pose);
        }
        const std::vector<SurfaceCrossing> found = crossingsOf(scene, 0, 1);
        REQUIRE(keysOf(found) == bruteForce(scene, 0, 1));
        crossings += found.size();
        apart += found.empty();
        const std::vector<SurfaceCrossing> byThree = crossingsOf(scene, 0, 1, 3);
        REQUIRE(std::ranges::equal(found, byThree, {}, &SurfaceCrossing::place, &SurfaceCrossing::place));
    }
    CHECK(crossings > 1000);
    CHECK(apart > 50);
}

TEST_CASE("the depth of a crossing in a closed surface is that of the edge inside it")
{
    Scene scene;
    scene.add(boxMesh({0.01, 0.01, 0.01}), {.proximity = 1e-3});
    geometry::TriangleMesh line;
    SECTION("a long edge that grazes the box's edge")
    {
        line.vertices = {{0.0, 0.0201, 0}, {0.0201, 0.0, 0}}; // 0.05 mm above it, on both sides
        for (Vec3& each : line.vertices) each -= Vec3{0.15e-3, 0.15e-3, 0};
        scene.add(line, {.segments = {{0, 1}}, .proximity = 1e-3});
        const std::vector<SurfaceCrossing> found = crossingsOf(scene, 0, 1);
        REQUIRE(found.size() == 2);
        CHECK(found.front().depth == Approx(0.1e-3));
        CHECK(!found.front().through);
    }
    SECTION("an edge that ends inside")
    {
        line.vertices = {{0.001, 0.002, 0.05}, {0.001, 0.002, 0.007}};
        scene.add(line, {.segments = {{0, 1}}, .proximity = 1e-3});
        const std::vector<SurfaceCrossing> found = crossingsOf(scene, 0, 1);
        REQUIRE(found.size() == 1);
        CHECK(found.front().depth == Approx(0.003));
        CHECK(!found.front().through);
    }
    SECTION("a line of short edges that ends inside")
    {
        std::vector<std::array<int, 2>> segments;
        for (int i = 0; i <= 12; ++i) line.vertices.push_back({0.001, 0.002, 0.0145 - 1e-3 * i}); // the last at 2.5 mm
        for (int i = 0; i < 12; ++i) segments.push_back({i, i + 1});
        scene.add(line, {.segments = segments, .proximity = 1e-3});
        const std::vector<SurfaceCrossing> found = crossingsOf(scene, 0, 1);
        REQUIRE(found.size() == 1);
        CHECK(found.front().depth == Approx(0.0075));
        CHECK(!found.front().through);
    }
    SECTION("an edge that passes right through")
    {
        line.vertices = {{0.001, 0.002, 0.05}, {0.003, 0.001, -0.03}};
        scene.add(line, {.segments = {{0, 1}}, .proximity = 1e-3});
        const std::vector<SurfaceCrossing> found = crossingsOf(scene, 0, 1);
        REQUIRE(found.size() == 2);
        for (const SurfaceCrossing& each : found) {
            CHECK(each.through);
            CHECK(each.depth > 7e-3);
        }
    }
}

TEST_CASE("the depth of a crossing in a sheet is that of the edge's shorter part")
{
    Scene scene;
    scene.add(sheetMesh(0.02, 1), {.proximity = 1e-3});
    geometry::TriangleMesh line;
    line.vertices = {{1e-3, 2e-3, 5e-3}, {1e-3, 2e-3, -0.2e-3}};
    scene.add(line, {.segments = {{0, 1}}, .proximity = 1e-3});
    const std::vector<SurfaceCrossing> found = crossingsOf(scene, 0, 1);
    REQUIRE(found.size() == 1);
    CHECK(found.front().surfaces == std::array{1, 0});
    CHECK(found.front().depth == Approx(0.2e-3));
    CHECK(distance(found.front().place, {1e-3, 2e-3, 0}) < 1e-12);
    CHECK(found.front().through);
}

TEST_CASE("a sheet folded through itself crosses itself, and a flat or gently bent one does not")
{
    for (const double angle : {0.0, 0.3, 3.5}) { // [rad] by which the sheet is rolled up over its length
        CAPTURE(angle);
        Scene scene;
        constexpr double half = 0.02;
        scene.add(sheetMesh(half, 20), {.proximity = 0.5e-3, .self = true});
        for (Vec3& x : scene.surfaces[0].x)
            if (angle > 0.0) {
                const double turn = angle * (x.x / half), radius = half / angle;
                const double lift = turn > 0.0 ? 1.0 : 1.0 + 0.2 * (-turn - std::numbers::pi);
                x = {radius * std::sin(turn), x.y, radius * (1.0 - std::cos(turn)) * lift};
            }
        const std::vector<SurfaceCrossing> found = crossingsOf(scene, 0, 0);
        CHECK(keysOf(found).size() == found.size());
        CHECK(found.empty() == (angle < 3.0));
    }
}

TEST_CASE("a vertex that is not finite crosses nothing")
{
    Scene scene;
    scene.add(boxMesh({0.01, 0.01, 0.01}), {.proximity = 0.5e-3});
    scene.add(boxMesh({0.01, 0.01, 0.01}), {.proximity = 0.5e-3}, {{0.005, 0.004, 0.003}, {}});
    REQUIRE(!crossingsOf(scene, 0, 1).empty());
    for (Vec3& x : scene.surfaces[1].x) x.x = std::nan("");
    CHECK(crossingsOf(scene, 0, 1).empty());
}

} // namespace filasofia::engine::surface_crossings_test
