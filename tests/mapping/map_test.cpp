#include "filasofia/geometry/mass_properties.h"
#include "filasofia/geometry/mesh_file.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/geometry/texture_seams.h"
#include "filasofia/mapping/map.h"
#include "filasofia/math/mat3.h"

namespace map_test {

using namespace filasofia;
using namespace filasofia::mapping;

namespace {

const std::string kMeshes = FILASOFIA_SOURCE_DIR "/assets/meshes/";

frame::SoftBodyFrame bodyAt(const geometry::TetMesh& mesh, const Mat3& a, Vec3 b)
{
    frame::SoftBodyFrame body;
    for (const Vec3& node : mesh.nodes) body.positions.push_back(a * node + b);
    return body;
}

} // namespace

TEST_CASE("a body's own boundary is mapped node by node")
{
    const geometry::TetMesh mesh = geometry::loadTetMesh(kMeshes + "bunny_756.msh");
    const MappedSurface mapped = mapBoundary(mesh);
    REQUIRE(std::holds_alternative<IdentityMap>(mapped.map));
    std::vector<Vec3> vertices(mapped.surface.vertices.size());
    apply(mapped.map, bodyAt(mesh, Mat3::identity(), {}), vertices);
    CHECK(vertices == mapped.surface.vertices);
}

TEST_CASE("a surface whose vertices are nodes is mapped by identity, whatever their order")
{
    const geometry::TetMesh mesh = geometry::loadTetMesh(kMeshes + "bunny_756.msh");
    geometry::TriangleMesh surface{{mesh.nodes[7], mesh.nodes[3], mesh.nodes[100]}, {{0, 1, 2}}, {}};
    const MappedSurface mapped = mapSurface(mesh, surface);
    REQUIRE(std::holds_alternative<IdentityMap>(mapped.map));
    CHECK(std::get<IdentityMap>(mapped.map).nodes == std::vector<int>{7, 3, 100});
}

TEST_CASE("a surface beside the mesh follows an affine deformation exactly")
{
    const geometry::TetMesh mesh = geometry::loadTetMesh(kMeshes + "bunny_1492.msh");
    const geometry::TriangleMesh surface = geometry::loadTriangleMesh(kMeshes + "bunny.obj");
    const MappedSurface mapped = mapSurface(mesh, surface);
    REQUIRE(std::holds_alternative<BarycentricMap>(mapped.map));

    const Mat3 a{{{1.2, 0.3, 0}, {-0.1, 0.8, 0.2}, {0, 0.4, 1.1}}};
    const Vec3 b{0.5, -1, 2};
    std::vector<Vec3> vertices(surface.vertices.size());
    apply(mapped.map, bodyAt(mesh, a, b), vertices);
    double worst = 0.0;
    for (std::size_t i = 0; i < vertices.size(); ++i)
        worst = std::max(worst, distance(vertices[i], a * surface.vertices[i] + b));
    CHECK(worst < 1e-12);
}

TEST_CASE("a rod is drawn as a closed tube that turns outwards and goes through its nodes")
{
    std::vector<Vec3> line;
    for (int i = 0; i <= 40; ++i) line.push_back({0.02 * std::cos(0.1 * i), 0.02 * std::sin(0.1 * i), 1e-3 * i});
    constexpr double radius = 1e-3;
    const MappedSurface mapped = mapTube(line, radius);
    geometry::check(mapped.surface, "tube");
    CHECK(nodesNeeded(mapped.map) == 41);
    double length = 0.0;
    for (std::size_t i = 0; i < 40; ++i) length += distance(line[i], line[i + 1]);
    const double polygon = 6.0 * std::sin(M_PI / 6.0) * radius * radius; // area of a dodecagon
    CHECK_THAT(geometry::enclosedVolume(mapped.surface), Catch::WithinRel(polygon * length, 0.01));
    for (std::size_t i = 0; i <= 40; ++i) // every fourth ring is around a node
        for (std::size_t side = 0; side < 12; ++side)
            CHECK_THAT(distance(mapped.surface.vertices[48 * i + side], line[i]), Catch::WithinAbs(radius, 1e-12));

    frame::SoftBodyFrame moved;
    for (Vec3 node : line) moved.positions.push_back(2.0 * node + Vec3{1, 0, 0});
    std::vector<Vec3> vertices(mapped.surface.vertices.size());
    apply(mapped.map, moved, vertices);
    CHECK_THAT(distance(vertices[48 * 7], moved.positions[7]), Catch::WithinAbs(radius, 1e-12));
    CHECK(vertices.back() == moved.positions.back());
}

TEST_CASE("the tube around a rod turns with the rod's directors, between the middles of its edges")
{
    std::vector<Vec3> line;
    for (int i = 0; i <= 10; ++i) line.push_back({2e-3 * i, 0, 0});
    constexpr double radius = 1e-3, turn = 0.4; // [rad] from edge to edge
    const MappedSurface mapped = mapTube(line, radius);
    frame::SoftBodyFrame body{.positions = line};
    const auto turnedBy = [](double angle) { return Vec3{0, std::cos(angle), std::sin(angle)}; };
    for (int edge = 0; edge < 10; ++edge) body.directors.push_back(turnedBy(turn * edge));
    std::vector<Vec3> vertices(mapped.surface.vertices.size());
    apply(mapped.map, body, vertices);
    for (std::size_t edge = 0; edge < 10; ++edge) {
        const Vec3 middle = 0.5 * (line[edge] + line[edge + 1]);
        CHECK(distance(vertices[12 * (4 * edge + 2)], middle + radius * body.directors[edge]) < 1e-12);
    }
    for (std::size_t node = 1; node < 10; ++node) // in the middle between the angles of its two edges
        CHECK(distance(vertices[48 * node], line[node] + radius * turnedBy(turn * (double(node) - 0.5))) < 1e-12);
    body.cutEdges = {4};
    apply(mapped.map, body, vertices);
    CHECK(distance(vertices[48 * 4], line[4] + radius * body.directors[3]) < 1e-12); // ends have their own edge's
    CHECK(distance(vertices[48 * 5], line[5] + radius * body.directors[5]) < 1e-12);
}

TEST_CASE("the pattern of a rod lies where the rod is straight")
{
    std::vector<Vec3> line; // along the diagonal, then across
    for (int i = 0; i <= 10; ++i) line.push_back({1e-3 * i, i < 5 ? 1e-3 * i : 1e-2 - 1e-3 * i, 0});
    for (const bool closed : {false, true}) {
        const MappedSurface mapped = mapTube(line, 1e-3, closed);
        REQUIRE(mapped.pattern.size() == mapped.surface.vertices.size());
        double before = 0.0;
        for (std::size_t node = 0; node < 10; ++node) {
            for (std::size_t side = 0; side < 12; ++side) {
                const double angle = M_PI / 6.0 * static_cast<double>(side);
                CHECK(distance(mapped.pattern[48 * node + side],
                               Vec3{before, 1e-3 * std::cos(angle), 1e-3 * std::sin(angle)}) < 1e-15);
            }
            before += distance(line[node], line[node + 1]);
        }
        if (!closed) CHECK(distance(mapped.pattern.back(), Vec3{before, 0, 0}) < 1e-15);
    }
}

TEST_CASE("a ring is drawn as a tube without ends that does not pinch, however its line winds")
{
    std::vector<Vec3> line;
    for (int i = 0; i < 60; ++i) {
        const double s = 2.0 * M_PI * i / 60;
        line.push_back({0.02 * std::cos(s), 0.02 * std::sin(s), 0.01 * std::sin(2.0 * s) + 0.004 * std::cos(3.0 * s)});
    }
    constexpr double radius = 5e-4;
    const MappedSurface mapped = mapTube(line, radius, true);
    geometry::check(mapped.surface, "tube");
    double length = 0.0;
    for (std::size_t i = 0; i < 60; ++i) length += distance(line[i], line[(i + 1) % 60]);
    const double polygon = 6.0 * std::sin(M_PI / 6.0) * radius * radius;
    CHECK_THAT(geometry::enclosedVolume(mapped.surface), Catch::WithinRel(polygon * length, 0.01));
    CHECK(mapped.surface.vertices.size() == 12 * 240);
}

TEST_CASE("a rod that is cut is drawn as tubes with ends, and what is between them has no area")
{
    for (const bool closed : {false, true}) {
        std::vector<Vec3> line;
        const int nodes = 40;
        for (int i = 0; i < nodes; ++i) {
            const double s = 2.0 * M_PI * i / (closed ? nodes : 2.0 * nodes);
            line.push_back({0.05 * std::cos(s), 0.05 * std::sin(s), 0});
        }
        constexpr double radius = 1e-3;
        MappedSurface mapped = mapTube(line, radius, closed);
        frame::SoftBodyFrame body{.positions = line};
        body.cutEdges = {9, 20, 21}; // node 21 is alone
        geometry::TriangleMesh& tube = mapped.surface;
        apply(mapped.map, body, tube.vertices);
        double length = 0.0;
        for (int i = 0; i < (closed ? nodes : nodes - 1); ++i)
            if (i != 9 && i != 20 && i != 21) length += distance(line[i], line[(i + 1) % nodes]);
        const double polygon = 6.0 * std::sin(M_PI / 6.0) * radius * radius;
        CHECK_THAT(geometry::enclosedVolume(tube), Catch::WithinRel(polygon * length, 0.01));
        // Within a gap all triangles are flat; the caps lie across the ends.
        double gap = 0.0, caps = 0.0;
        for (const auto& [a, b, c] : tube.triangles) {
            const Vec3 x = tube.vertices[a], y = tube.vertices[b], z = tube.vertices[c];
            const double area = 0.5 * filasofia::length(cross(y - x, z - x));
            const Vec3 middle = 1.0 / 3.0 * (x + y + z), inGap = 0.5 * (line[9] + line[10]);
            if (distance(middle, inGap) < 0.4 * distance(line[9], line[10])) gap += area;
            if (distance(middle, line[9]) < 0.9 * radius) caps += area;
        }
        CHECK(gap < 1e-15);
        CHECK_THAT(caps, Catch::WithinRel(polygon, 1e-9));
        for (std::size_t side = 0; side < 12; ++side) {
            CHECK_THAT(distance(tube.vertices[48 * 9 + side], line[9]), Catch::WithinAbs(radius, 1e-12));
            CHECK_THAT(distance(tube.vertices[48 * 10 + side], line[10]), Catch::WithinAbs(radius, 1e-12));
            CHECK(tube.vertices[48 * 21 + side] == line[21]);
        }
        body.cutEdges.clear();
        std::vector<Vec3> whole(tube.vertices.size());
        apply(mapped.map, body, whole);
        CHECK(whole == mapTube(line, radius, closed).surface.vertices);
    }
}

TEST_CASE("a rigid map is the element's pose")
{
    const Pose second{{1, 2, 3}, axisAngle({0, 1, 0}, 0.5)};
    CHECK(apply(RigidMap{1}, frame::RigidBodyFrame{BodyId{1}, {Pose{}, second}}) == second);
}

TEST_CASE("creases get a vertex for each side, and only creases do")
{
    const auto box = geometry::shapes::box({1, 2, 3}, {2, 2, 2});
    const geometry::TriangleMesh sharp = mapping::withCreases(*box, 0.6);
    CHECK(sharp.vertices.size() == 6 * 9); // every face has its own vertices
    REQUIRE(sharp.triangles.size() == box->triangles.size());
    for (std::size_t t = 0; t < sharp.triangles.size(); ++t)
        for (int corner : {0, 1, 2})
            CHECK(sharp.vertices[sharp.triangles[t][corner]] == box->vertices[box->triangles[t][corner]]);
    CHECK(mapping::withCreases(*box, 2.0).vertices.size() == box->vertices.size());

    const auto sphere = geometry::shapes::sphere(0.01);
    CHECK(mapping::withCreases(*sphere, 0.6).vertices.size() == sphere->vertices.size());
    const auto can = geometry::shapes::cylinder(0.01, 0.04, 8);
    CHECK(mapping::withCreases(*can, 0.6).vertices.size() == can->vertices.size() + 2 * 32); // the rims of both ends

    geometry::TriangleMesh pictured = *box;
    for (std::size_t v = 0; v < pictured.vertices.size(); ++v) pictured.uv.push_back({static_cast<double>(v), 0.0});
    const geometry::TriangleMesh both = mapping::withCreases(pictured, 0.6);
    REQUIRE(both.uv.size() == both.vertices.size());
    for (std::size_t t = 0; t < both.triangles.size(); ++t)
        for (int corner : {0, 1, 2})
            CHECK(both.uv[both.triangles[t][corner]] == pictured.uv[pictured.triangles[t][corner]]);

    geometry::TriangleMesh seams = *box;
    for (int i = 0; i < static_cast<int>(3 * box->triangles.size()); ++i) seams.uv.push_back({i / 10.0, 0.0});
    CHECK(mapping::withCreases(seams, 0.6).uv == seams.uv);
    // Every corner of a tetrahedron with creases is a vertex.
    geometry::TriangleMesh sharpest{
        {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}, {}};
    for (int i = 0; i < 12; ++i) sharpest.uv.push_back({i / 10.0, 0.0});
    const geometry::TriangleMesh facets = mapping::withCreases(sharpest, 0.6);
    REQUIRE(facets.vertices.size() == 12);
    for (std::size_t i = 0; i < 12; ++i) CHECK(facets.uv[facets.triangles[i / 3][i % 3]] == sharpest.uv[i]);
}

} // namespace map_test
