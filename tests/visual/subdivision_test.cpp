#include "filasofia/visual/subdivision.h"
#include "little_scene.h"

#include "filasofia/core/error.h"
#include "filasofia/geometry/texture_seams.h"

#include <algorithm>
#include <random>

namespace subdivision_test {

using namespace filasofia;
using namespace filasofia::visual;
using Catch::Contains;

namespace {

std::vector<Float3> toFloats(const std::vector<Vec3>& positions)
{
    std::vector<Float3> floats;
    for (Vec3 p : positions) floats.push_back(toFloat3(p));
    return floats;
}

/// A flat square of n x n cells in the plane z = 0, with a boundary.
geometry::TriangleMesh square(int n)
{
    geometry::TriangleMesh mesh;
    for (int y = 0; y <= n; ++y)
        for (int x = 0; x <= n; ++x) mesh.vertices.push_back({double(x) / n, double(y) / n, 0.0});
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const int a = y * (n + 1) + x;
            mesh.triangles.push_back({a, a + 1, a + n + 2});
            mesh.triangles.push_back({a, a + n + 2, a + n + 1});
        }
    return mesh;
}

} // namespace

TEST_CASE("subdivision level 0 changes nothing")
{
    const auto mesh = sphere(1.0, 1);
    const Subdivision none(mesh, 0, "ball");
    const auto control = toFloats(mesh.vertices);
    CHECK(none.refine(control) == control);
    REQUIRE(none.indices().size() == 3 * mesh.triangles.size());
    CHECK(none.indices()[4] == std::uint32_t(mesh.triangles[1][1]));
}

TEST_CASE("each level of subdivision has four times the triangles")
{
    for (const auto& mesh : {sphere(1.0, 1), square(5)})
        for (int level = 0; level <= 3; ++level) {
            const Subdivision refined(mesh, level, "mesh");
            CHECK(refined.indices().size() == 3 * mesh.triangles.size() << (2 * level));
            CHECK(*std::max_element(refined.indices().begin(), refined.indices().end()) + 1 ==
                  std::uint32_t(refined.vertexCount()));
            CHECK(refined.refine(toFloats(mesh.vertices)).size() == std::size_t(refined.vertexCount()));
        }
}

TEST_CASE("subdividing moved points is moving subdivided points")
{
    std::mt19937 random(4);
    std::normal_distribution<double> number;
    for (int level = 1; level <= 3; ++level) {
        const auto mesh = sphere(0.1, 1);
        const Subdivision refined(mesh, level, "ball");
        const Mat3 linear{{{1.0 + 0.3 * number(random), number(random), 0.2},
                           {number(random), 0.9, number(random)},
                           {0.1, number(random), 1.1}}};
        const Vec3 shift{0.1, -0.2, 0.3};
        std::vector<Vec3> moved;
        for (Vec3 v : mesh.vertices) moved.push_back(linear * v + shift);
        const auto before = refined.refine(toFloats(mesh.vertices)), after = refined.refine(toFloats(moved));
        for (std::size_t i = 0; i < before.size(); ++i) {
            const Vec3 expected = linear * Vec3{before[i].x, before[i].y, before[i].z} + shift;
            CHECK(distance(expected, Vec3{after[i].x, after[i].y, after[i].z}) < 1e-6);
        }
    }
}

TEST_CASE("a subdivided sphere stays round and keeps its orientation")
{
    const auto mesh = sphere(1.0, 2);
    const Subdivision refined(mesh, 2, "ball");
    const auto points = refined.refine(toFloats(mesh.vertices));
    double largest = 0.0, least = 2.0;
    for (Float3 p : points) {
        const double r = std::sqrt(dot(p, p));
        largest = std::max(largest, r);
        least = std::min(least, r);
    }
    CHECK(largest < 1.0);
    CHECK(least > 0.9);
    CHECK(largest - least < 0.05);
    for (std::size_t i = 0; i < refined.indices().size(); i += 3) {
        const Float3 a = points[refined.indices()[i]], b = points[refined.indices()[i + 1]],
                     c = points[refined.indices()[i + 2]];
        CHECK(dot(cross(b - a, c - a), a) > 0.0F);
    }
}

TEST_CASE("the border of an open surface stays its border")
{
    const auto mesh = square(4);
    const auto points = Subdivision(mesh, 2, "square").refine(toFloats(mesh.vertices));
    double left = 1.0, right = 0.0;
    for (Float3 p : points) {
        left = std::min<double>(left, p.x);
        right = std::max<double>(right, p.x);
        CHECK(p.z == 0.0F);
    }
    CHECK(left == Approx(0.0).margin(1e-6));
    CHECK(right == Approx(1.0).margin(1e-6));
}

TEST_CASE("where the texture has a seam, vertices are drawn once for each side, and normals are as without")
{
    geometry::TriangleMesh mesh = square(6);
    std::vector<std::array<double, 2>> ofCorners; // the right half is elsewhere in the image
    for (const geometry::Triangle& t : mesh.triangles) {
        double middle = 0.0;
        for (const int v : t) middle += mesh.vertices[std::size_t(v)].x / 3.0;
        for (const int v : t) {
            const Vec3 p = mesh.vertices[std::size_t(v)];
            ofCorners.push_back({p.x + (middle > 0.5 ? 10.0 : 0.0), p.y});
        }
    }
    const Subdivision plain(mesh, 2, "square");
    CHECK(plain.uv().empty());
    CHECK(std::ranges::equal(plain.drawnIndices(), plain.indices()));
    setUvOfCorners(mesh, ofCorners);
    REQUIRE(perCorner(mesh));
    for (int level = 0; level <= 2; ++level) {
        const Subdivision refined(mesh, level, "square");
        const std::size_t onSeam = (6u << level) + 1, own = std::size_t(refined.vertexCount());
        std::vector<Float3> places = refined.refine(toFloats(mesh.vertices));
        refined.addCopies(places);
        REQUIRE(places.size() == own + onSeam);
        REQUIRE(refined.uv().size() == places.size());
        const auto drawn = refined.drawnIndices(), normal = refined.indices();
        REQUIRE(drawn.size() == normal.size());
        for (std::size_t i = 0; i < drawn.size(); i += 3) {
            const bool right = refined.uv()[drawn[i]][0] > 5.0F;
            for (std::size_t k = i; k < i + 3; ++k) {
                const Float3 p = places[drawn[k]];
                CHECK(p == places[normal[k]]);
                if (p.x + p.y < 0.4F || p.x + p.y > 1.6F || std::abs(p.x - p.y) > 0.6F) continue; // round corners
                // Where the seam ends at the rim, the texture has two corners, which stay sharp.
                const double off = std::abs(p.x - 0.5F) < 0.2F && std::abs(p.y - 0.5F) > 0.3F ? 0.03 : 1e-5;
                CHECK(std::abs(refined.uv()[drawn[k]][0] - p.x - (right ? 10.0 : 0.0)) < off);
                CHECK(std::abs(refined.uv()[drawn[k]][1] - p.y) < off);
            }
        }
    }
}

TEST_CASE("surfaces that cannot be subdivided are errors that name the body")
{
    geometry::TriangleMesh fan; // three triangles on one edge
    fan.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
    fan.triangles = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
    CHECK_THROWS_WITH(Subdivision(fan, 1, "body 'fan'"), Contains("body 'fan'") && Contains("(0, 1)"));
    CHECK_NOTHROW(Subdivision(fan, 0, "body 'fan'"));

    geometry::TriangleMesh twisted = square(1); // neighbours of opposite orientation
    std::swap(twisted.triangles[1][1], twisted.triangles[1][2]);
    CHECK_THROWS_WITH(Subdivision(twisted, 1, "body 'twisted'"), Contains("orientation"));

    CHECK_THROWS_AS(Subdivision(square(1), 4, "body 'square'"), Error);
    CHECK_THROWS_AS(Subdivision(square(1), -1, "body 'square'"), Error);
    CHECK_THROWS_AS(Subdivision({}, 1, "body 'nothing'"), Error);

    geometry::TriangleMesh wrong = square(1);
    wrong.triangles[0][0] = 99;
    CHECK_THROWS_AS(Subdivision(wrong, 1, "body 'wrong'"), Error);
    wrong.triangles[0] = {0, 0, 1};
    CHECK_THROWS_AS(Subdivision(wrong, 1, "body 'wrong'"), Error);
}

TEST_CASE("vertices without triangles, and triangles that meet in a point, are subdivided without harm")
{
    geometry::TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {5, 5, 5}};
    mesh.triangles = {{0, 1, 2}, {0, 3, 4}};
    for (int level = 1; level <= 3; ++level) {
        const Subdivision refined(mesh, level, "bow tie");
        CHECK(refined.indices().size() == 6u << (2 * level));
        for (Float3 p : refined.refine(toFloats(mesh.vertices))) {
            CHECK(std::isfinite(p.x));
            CHECK(std::abs(p.y) <= 5.0F);
        }
    }
}

} // namespace subdivision_test
