#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/geometry/triangle_mesh.h"
#include "geometry/sample_meshes.h"

#include <limits>

namespace tet_mesh_test {

using namespace filasofia;
using namespace filasofia::geometry;
using Catch::Matchers::Contains;

TEST_CASE("the volume of a tetrahedron has the sign of its orientation")
{
    TetMesh mesh = unitTetrahedron();
    CHECK(signedVolume(mesh, 0) == Approx(1.0 / 6.0));
    std::swap(mesh.tetrahedra[0][0], mesh.tetrahedra[0][1]);
    CHECK(signedVolume(mesh, 0) == Approx(-1.0 / 6.0));
}

TEST_CASE("quality is 1 for the regular tetrahedron of any size, less for others, 0 for flat ones")
{
    TetMesh regular{{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}, {{0, 1, 3, 2}}};
    CHECK(quality(regular, 0) == Approx(1.0).epsilon(1e-14));
    for (Vec3& node : regular.nodes) node *= 1e-3;
    CHECK(quality(regular, 0) == Approx(1.0).epsilon(1e-14));
    CHECK(quality(unitTetrahedron(), 0) == Approx(std::sqrt(2.0) / std::pow(1.5, 1.5)));
    TetMesh flat = unitTetrahedron();
    flat.nodes[3] = {1, 1, 0};
    CHECK(quality(flat, 0) == 0.0);
    CHECK(quality(TetMesh{{{}, {}, {}, {}}, {{0, 1, 2, 3}}}, 0) == 0.0);
}

TEST_CASE("every face of a tetrahedron looks outwards and lies opposite its node")
{
    const TetMesh mesh = unitTetrahedron();
    for (int i = 0; i < 4; ++i) {
        const auto [a, b, c] = kTetrahedronFaces[i];
        CHECK(a + b + c + i == 6);
        const Vec3 normal = cross(mesh.nodes[b] - mesh.nodes[a], mesh.nodes[c] - mesh.nodes[a]);
        CHECK(dot(normal, mesh.nodes[i] - mesh.nodes[a]) < 0.0);
    }
}

TEST_CASE("a sound mesh passes the check")
{
    CHECK_NOTHROW(check(unitTetrahedron(), "one"));
    CHECK_NOTHROW(check(cubeMesh(4, 1), "cube"));
}

TEST_CASE("the check of a tetrahedral mesh names what is wrong")
{
    TetMesh mesh = cubeMesh(2, 1);
    const auto message = [&] { return errorOf([&] { check(mesh, "liver"); }); };
    SECTION("no tetrahedra")
    {
        mesh.tetrahedra.clear();
        CHECK(message() == "liver: must have at least 1 tetrahedron, got 0");
    }
    SECTION("a number that is not finite")
    {
        mesh.nodes[5].y = std::numeric_limits<double>::quiet_NaN();
        CHECK_THAT(message(), Contains("liver: node 5 must be finite"));
        mesh.nodes[5].y = std::numeric_limits<double>::infinity();
        CHECK_THAT(message(), Contains("liver: node 5 must be finite"));
    }
    SECTION("an index out of range")
    {
        mesh.tetrahedra[3][2] = 27;
        CHECK(message() == "liver: tetrahedron 3 names node 27; it must be in [0, 27)");
        mesh.tetrahedra[3][2] = -1;
        CHECK(message() == "liver: tetrahedron 3 names node -1; it must be in [0, 27)");
    }
    SECTION("a node named twice")
    {
        mesh.tetrahedra[3][2] = mesh.tetrahedra[3][0];
        CHECK_THAT(message(), Contains("tetrahedron 3 names node 0 twice"));
    }
    SECTION("an inverted one")
    {
        std::swap(mesh.tetrahedra[4][1], mesh.tetrahedra[4][2]);
        CHECK_THAT(message(), Contains("tetrahedron 4 is inverted: its volume must be > ") && !Contains("other"));
        for (const std::size_t t : {6, 9}) std::swap(mesh.tetrahedra[t][1], mesh.tetrahedra[t][2]);
        CHECK_THAT(message(), Contains("tetrahedron 4 is inverted: ") && Contains("; 2 others are faulty, too"));
    }
    SECTION("a flat one")
    {
        mesh = unitTetrahedron();
        mesh.nodes[3] = {0.3, 0.3, 1e-13};
        CHECK_THAT(message(), Contains("tetrahedron 0 is flat: its volume must be > "));
        mesh.nodes[3].z = 2e-11; // thin, and still above the bound
        CHECK_NOTHROW(check(mesh, "liver"));
    }
    SECTION("numbers whose volume overflows")
    {
        mesh = unitTetrahedron();
        for (Vec3& node : mesh.nodes) node *= 1e200;
        CHECK(message() == "liver: node 1 must have coordinates within 1e+20 m of the origin, got 1e+200 0 0");
    }
    SECTION("a node in no tetrahedron")
    {
        mesh.nodes.push_back({});
        CHECK(message() == "liver: node 27 must be in at least one tetrahedron, got none");
    }
    SECTION("a tetrahedron listed twice")
    {
        const auto [a, b, c, d] = mesh.tetrahedra[2];
        mesh.tetrahedra.push_back({b, c, a, d});
        CHECK_THAT(message(), Contains("tetrahedra 2 and 48 lie on the same side of their common face"));
    }
}

TEST_CASE("nodes that no tetrahedron uses are dropped, and the others keep their order")
{
    TetMesh mesh = unitTetrahedron();
    const TetMesh whole = mesh;
    CHECK(dropUnusedNodes(mesh) == 0);
    CHECK((mesh.nodes == whole.nodes && mesh.tetrahedra == whole.tetrahedra));
    mesh.nodes.insert(mesh.nodes.begin() + 2, Vec3{7, 7, 7});
    mesh.nodes.push_back({8, 8, 8});
    for (int& node : mesh.tetrahedra[0]) node += node >= 2 ? 1 : 0;
    CHECK(dropUnusedNodes(mesh) == 2);
    CHECK((mesh.nodes == whole.nodes && mesh.tetrahedra == whole.tetrahedra));
    mesh.nodes.push_back({8, 8, 8});
    mesh.tetrahedra[0][1] = 9; // no such node: for check() to tell
    CHECK(dropUnusedNodes(mesh) == 0);
    CHECK(mesh.nodes.size() == 5);
}

TEST_CASE("the check of a triangle mesh names what is wrong")
{
    TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {2, 1, 3}}, {}};
    const auto message = [&] { return errorOf([&] { check(mesh, "skin"); }); };
    CHECK(message().empty());
    SECTION("no triangles")
    {
        mesh.triangles.clear();
        CHECK(message() == "skin: must have at least 1 triangle, got 0");
    }
    SECTION("a number that is not finite")
    {
        mesh.vertices[3].z = std::numeric_limits<double>::quiet_NaN();
        CHECK_THAT(message(), Contains("skin: vertex 3 must be finite"));
    }
    SECTION("an index out of range")
    {
        mesh.triangles[1][1] = 4;
        CHECK(message() == "skin: triangle 1 names vertex 4; it must be in [0, 4)");
    }
    SECTION("a vertex named twice")
    {
        mesh.triangles[1] = {2, 3, 2};
        CHECK_THAT(message(), Contains("skin: triangle 1 names a vertex twice"));
    }
    SECTION("texture coordinates that are too few or none")
    {
        mesh.uv.resize(3);
        CHECK_THAT(message(),
                   Contains("skin: uv must be empty or have one pair for each of 4 vertices or of 6 corners, got 3"));
        mesh.uv.resize(4);
        mesh.uv[2][1] = std::numeric_limits<double>::infinity();
        CHECK_THAT(message(), Contains("skin: uv of vertex 2 must be finite"));
    }
}

TEST_CASE("a tetrahedron given twice is refused wherever its neighbours stand in the list")
{
    const TetMesh block = cubeMesh(3, 1);
    for (std::size_t i = 0; i < block.tetrahedra.size(); ++i) {
        TetMesh mesh = block;
        mesh.tetrahedra.push_back(block.tetrahedra[i]);
        CHECK_THROWS_WITH(check(mesh, "mesh"), Contains(text("tetrahedra ", i, " and ", block.tetrahedra.size())) &&
                                                   Contains("lie on the same side"));
    }
}

} // namespace tet_mesh_test
