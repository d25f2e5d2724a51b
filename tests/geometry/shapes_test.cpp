#include "filasofia/geometry/shapes.h"

#include "filasofia/core/error.h"
#include "filasofia/geometry/mass_properties.h"
#include "filasofia/geometry/surface.h"

#include <numbers>

namespace shapes_test {

using namespace filasofia;
using namespace filasofia::geometry;

namespace {

constexpr double kPi = std::numbers::pi;

/// The volume inside; throws an Error unless the surface passes check(), is closed and not inside out.
double volumeOf(const std::shared_ptr<const TriangleMesh>& mesh)
{
    check(*mesh, "shape");
    return massProperties(*mesh, "shape").volume;
}

/// True if every triangle faces away from the centre, as it must, since all shapes here are convex.
bool facesOutwards(const TriangleMesh& mesh)
{
    return std::ranges::all_of(mesh.triangles, [&](const Triangle& t) {
        const Vec3 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
        return dot(cross(b - a, c - a), a + b + c) > 0.0;
    });
}

} // namespace

TEST_CASE("a box has the volume of its edges, whatever its cells")
{
    for (const std::array<int, 3> cells : {std::array{1, 1, 1}, {3, 2, 5}}) {
        const auto box = shapes::box({0.02, 0.03, 0.05}, cells);
        CHECK(volumeOf(box) == Approx(0.02 * 0.03 * 0.05));
        CHECK(facesOutwards(*box));
        const int faces = cells[0] * cells[1] + cells[1] * cells[2] + cells[2] * cells[0];
        CHECK(static_cast<int>(box->triangles.size()) == 4 * faces);
        CHECK(static_cast<int>(box->vertices.size()) == 2 * faces + 2); // by Euler's formula for a closed surface
    }
}

TEST_CASE("a tube is closed, faces outwards, has the volume of its line times its section, and may be sharp")
{
    std::vector<Vec3> arc;
    for (int i = 0; i <= 60; ++i) arc.push_back({0.02 * std::cos(kPi * i / 60), 0.02 * std::sin(kPi * i / 60), 0.0});
    const double section = kPi * 1e-6, whole = kPi * 0.02;
    for (const bool sharp : {false, true}) {
        const auto tube = shapes::tube(arc, 1e-3, 48, sharp);
        const double lost = sharp ? 2.0 / 3.0 * whole / 60 : 0.0; // a cone in place of the first edge
        CHECK(volumeOf(tube) == Approx(section * (whole - lost)).epsilon(4e-3));
        CHECK(static_cast<int>(tube->vertices.size()) == (sharp ? 60 : 61) * 48 + 2);
        for (const Vec3& v : tube->vertices) CHECK(std::abs(v.z) <= 1e-3 + 1e-15);
    }
    CHECK(shapes::tube(arc, 1e-3, 3, true)->vertices.size() == 60u * 3 + 2);
    CHECK_THROWS_WITH(shapes::tube({{}}, 1e-3), "tube: points must have at least 2 entries, got 1");
    CHECK_THROWS_WITH(shapes::tube({{}, {}}, 1e-3),
                      "tube: points[0] and points[1] must be apart, their distance is 0 m");
    CHECK_THROWS_WITH(shapes::tube({{}, {1, 0, 0}}, 0), "tube: radius must be > 0 m, got 0");
    CHECK_THROWS_WITH(shapes::tube({{}, {1, 0, 0}}, 1, 2), "tube: sides must be in [3, 500], got 2");
    CHECK_THROWS_WITH(shapes::tube({{}, {1, 0, 0}, {0, 0, 0}}, 0.1),
                      "tube: the line must turn by less than 174 degrees at points[1]");
}

TEST_CASE("a vessel is hollow, open at both ends, of good tetrahedra that fit together, and as large as its wall")
{
    const double inner = 4e-3, wall = 1e-3, radius = 0.03;
    const auto line = shapes::arc(radius, 0.0, 0.5 * kPi, 24);
    CHECK(line.size() == 25);
    CHECK(distance(line.back(), {0.0, radius, 0.0}) < 1e-15);
    const auto vessel = shapes::vessel(line, inner, wall, {48, 2});
    CHECK_NOTHROW(check(*vessel, "vessel"));
    CHECK(vessel->nodes.size() == 25u * 48 * 3);
    CHECK(vessel->tetrahedra.size() == 24u * 48 * 2 * 6);
    double volume = 0.0;
    for (int t = 0; t < static_cast<int>(vessel->tetrahedra.size()); ++t) volume += signedVolume(*vessel, t);
    const double section = kPi * ((inner + wall) * (inner + wall) - inner * inner);
    CHECK(volume == Approx(section * 0.5 * kPi * radius).epsilon(6e-3));
    // Its boundary is closed, and has the topology of a torus: inside, outside and two rims.
    CHECK(extractSurface(*vessel).mesh.triangles.size() == 2u * 2 * 48 * 24 + 2u * 2 * 48 * 2);
    CHECK_THROWS_WITH(shapes::vessel(line, 4e-3, 0.0), "vessel: wall must be > 0 m, got 0");
    CHECK_THROWS_WITH(shapes::vessel(line, 4e-3, 1e-3, {7, 1}), "vessel: cells[0] must be even, got 7");
    CHECK_THROWS_WITH(shapes::vessel(line, 4e-3, 1e-3, {8, 0}), "vessel: cells[1] must be in [1, 100], got 0");
    CHECK_THROWS_WITH(shapes::vessel(shapes::arc(3e-3, 0, 1, 8), 4e-3, 1e-3),
                      "vessel: the line turns too sharply at points[1] or points[2] for a vessel that is 0.005 m in "
                      "radius");
    CHECK_THROWS_WITH(shapes::arc(0.0, 0, 1), "arc: radius must be > 0 m, got 0");
}

TEST_CASE("round shapes are closed, face outwards, and come as near to their volume as they are fine")
{
    const double r = 0.01, l = 0.04;
    double lacks[3] = {1, 1, 1};
    for (const int quarter : {1, 2, 3, 6, 12, 24}) {
        const std::shared_ptr<const TriangleMesh> each[] = {shapes::sphere(r, quarter), shapes::capsule(r, l, quarter),
                                                            shapes::cylinder(r, l, quarter)};
        const double volumes[] = {4.0 / 3.0 * kPi * r * r * r, 4.0 / 3.0 * kPi * r * r * r + kPi * r * r * l,
                                  kPi * r * r * l};
        for (int i = 0; i < 3; ++i) {
            const double lack = 1.0 - volumeOf(each[i]) / volumes[i];
            INFO("shape " << i << ", quarter " << quarter << ", lack " << lack);
            CHECK(facesOutwards(*each[i]));
            CHECK(lack > 0.0); // vertices lie on the round surface, flat triangles inside it
            CHECK(lack < lacks[i]);
            CHECK(lack * quarter * quarter < 1.6); // second order
            lacks[i] = lack;
        }
        CHECK(static_cast<int>(each[0]->triangles.size()) == 8 * quarter * quarter);
    }
    for (const double lack : lacks) CHECK(lack < 3e-3);
}

TEST_CASE("the vertices of round shapes lie on the round surface, and both ends are alike")
{
    const auto sphere = shapes::sphere(0.01), capsule = shapes::capsule(0.01, 0.04),
               cylinder = shapes::cylinder(0.01, 0.04);
    for (const Vec3& v : sphere->vertices) CHECK(length(v) == Approx(0.01));
    const Vec3 axes{0.01, 0.02, 0.03};
    const auto ellipsoid = shapes::ellipsoid(axes, 12);
    for (const Vec3& v : ellipsoid->vertices)
        CHECK(length(Vec3{v.x / axes.x, v.y / axes.y, v.z / axes.z}) == Approx(1));
    CHECK(facesOutwards(*ellipsoid));
    CHECK(volumeOf(ellipsoid) == Approx(4.0 / 3.0 * kPi * axes.x * axes.y * axes.z).epsilon(1.6 / (12 * 12)));
    for (const Vec3& v : capsule->vertices) CHECK(length(v - Vec3{0, v.y > 0 ? 0.02 : -0.02, 0}) == Approx(0.01));
    double low = 0.0, high = 0.0;
    for (const Vec3& v : cylinder->vertices) {
        CHECK((std::hypot(v.x, v.z) < 1e-9 || std::hypot(v.x, v.z) == Approx(0.01)));
        low = std::min(low, v.y);
        high = std::max(high, v.y);
    }
    CHECK(low == Approx(-0.02));
    CHECK(high == Approx(0.02));
}

TEST_CASE("an outline that turns about y makes a closed ring or, from the axis on, a solid one")
{
    const auto ring = shapes::revolved({{0.02, 0, 0}, {0.03, 0, 0}, {0.03, 0.04, 0}, {0.02, 0.04, 0}}, 64);
    const auto cone = shapes::revolved({{0, -0.02, 0}, {0.03, -0.02, 0}, {0, 0.02, 0}}, 64);
    CHECK(facesOutwards(*cone));
    CHECK(volumeOf(ring) == Approx(kPi * (9e-4 - 4e-4) * 0.04).epsilon(2e-3));
    CHECK(volumeOf(cone) == Approx(kPi * 9e-4 * 0.04 / 3.0).epsilon(2e-3));
    CHECK(ring->vertices.size() == 4 * 64);
    CHECK(cone->vertices.size() == 64 + 2); // one on the axis for each corner that is there
    CHECK(cone->triangles.size() == 2 * 64);
    CHECK_THROWS_WITH(shapes::revolved({{0, 0, 0}, {1, 0, 0}}),
                      "revolved: corners must have at least 3 entries, got 2");
    CHECK_THROWS_WITH(shapes::revolved({{0, 0, 0}, {1, 0, 0}, {-1, 1, 0}}),
                      "revolved: corners[2].x must be >= 0 m, got -1");
    CHECK_THROWS_WITH(shapes::revolved({{0, 0, 0}, {1, 0, 2}, {1, 1, 0}}), "revolved: corners[1].z must be 0 m, got 2");
    CHECK_THROWS_WITH(shapes::revolved({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}}), Catch::Contains("counter-clockwise"));
    CHECK_THROWS_WITH(shapes::revolved({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, 2),
                      "revolved: sides must be in [3, 500], got 2");
}

TEST_CASE("a picture lies once on a printed sheet, and on no other")
{
    CHECK(shapes::sheet(0.1, 0.2, {4, 6})->uv.empty());
    const auto sheet = shapes::sheet(0.1, 0.2, {4, 6}, true);
    REQUIRE(sheet->uv.size() == sheet->vertices.size());
    for (std::size_t i = 0; i < sheet->uv.size(); ++i) {
        CHECK(sheet->uv[i][0] == Approx(sheet->vertices[i].x / 0.1 + 0.5).margin(1e-12));
        CHECK(sheet->uv[i][1] == Approx(0.5 - sheet->vertices[i].z / 0.2).margin(1e-12));
    }
}

TEST_CASE("no triangle of a sphere is a splinter")
{
    const auto sphere = shapes::sphere(1.0, 12);
    for (const Triangle& t : sphere->triangles) {
        const Vec3 a = sphere->vertices[t[0]], b = sphere->vertices[t[1]], c = sphere->vertices[t[2]];
        const double longest = std::max({length(b - a), length(c - b), length(a - c)});
        CHECK(length(cross(b - a, c - a)) >
              0.4 * longest * longest); // twice the area; 0.87 for an equilateral triangle
    }
}

TEST_CASE("a block fills its box with tetrahedra that meet face to face")
{
    for (const std::array<int, 3> cells : {std::array{1, 1, 1}, {2, 2, 2}, {3, 4, 5}}) {
        const auto block = shapes::block({0.03, 0.02, 0.05}, cells);
        check(*block, "block");
        double volume = 0.0;
        for (std::size_t t = 0; t < block->tetrahedra.size(); ++t) volume += signedVolume(*block, static_cast<int>(t));
        CHECK(volume == Approx(0.03 * 0.02 * 0.05));
        CHECK(static_cast<int>(block->tetrahedra.size()) == 6 * cells[0] * cells[1] * cells[2]);
        // An inner face that did not coincide with its neighbour's would count as boundary.
        const TriangleMesh surface = extractSurface(*block).mesh;
        const int faces = cells[0] * cells[1] + cells[1] * cells[2] + cells[2] * cells[0];
        CHECK(static_cast<int>(surface.triangles.size()) == 4 * faces);
        CHECK(facesOutwards(surface));
    }
}

TEST_CASE("a shape that cannot be names its argument, the bound and the value")
{
    CHECK_THROWS_WITH(shapes::box({0.01, 0, 0.01}), "box: size.y must be > 0 m, got 0");
    CHECK_THROWS_WITH(shapes::box({0.01, 0.01, 0.01}, {1, 1, 0}), "box: cells[2] must be in [1, 500], got 0");
    CHECK_THROWS_WITH(shapes::sphere(-1), "sphere: radius must be > 0 m, got -1");
    CHECK_THROWS_WITH(shapes::sphere(1, 501), "sphere: quarter must be in [1, 500], got 501");
    CHECK_THROWS_WITH(shapes::ellipsoid({1, -1, 1}), "ellipsoid: halfAxes.y must be > 0 m, got -1");
    CHECK_THROWS_WITH(shapes::capsule(1, std::nan("")), "capsule: length must be > 0 m, got nan");
    CHECK_THROWS_WITH(shapes::capsule(0, 1), "capsule: radius must be > 0 m, got 0");
    CHECK_THROWS_WITH(shapes::cylinder(1, 0), "cylinder: length must be > 0 m, got 0");
    CHECK_THROWS_WITH(shapes::cylinder(1, 1, 0), "cylinder: quarter must be in [1, 500], got 0");
    CHECK_THROWS_WITH(shapes::block({1, 1, -1}), "block: size.z must be > 0 m, got -1");
    CHECK_THROWS_WITH(shapes::block({1, 1, 1}, {201, 1, 1}), "block: cells[0] must be in [1, 200], got 201");
    CHECK_THROWS_WITH(shapes::block({1, 1, 1}, {200, 200, 200}),
                      "block: cells must make at most 3000000 tetrahedra, got 48000000");
    CHECK_THROWS_WITH(shapes::bladder({1, 1, 1}, 0.1, {100, 100}),
                      "bladder: cells must make at most 3000000 tetrahedra, got 24000000");
    std::vector<Vec3> line;
    for (int i = 0; i < 12; ++i) line.push_back({1.0 * i, 0, 0});
    CHECK_THROWS_WITH(shapes::vessel(line, 0.1, 0.1, {500, 100}),
                      "vessel: cells must make at most 3000000 tetrahedra, got 3300000");
}

} // namespace shapes_test
