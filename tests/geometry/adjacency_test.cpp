#include "filasofia/geometry/adjacency.h"
#include "geometry/sample_meshes.h"

#include <set>

namespace adjacency_test {

using namespace filasofia;
using namespace filasofia::geometry;

namespace {

// Two cubes side by side that share nothing, and a third that shares one corner node with the second.
TetMesh threeCubes()
{
    TetMesh mesh;
    for (double shift : {0.0, 5.0, 6.0}) {
        const TetMesh cube = cubeMesh(1, 1);
        const int first = static_cast<int>(mesh.nodes.size());
        for (Vec3 node : cube.nodes) mesh.nodes.push_back(node + Vec3{shift, shift, shift});
        for (auto [a, b, c, d] : cube.tetrahedra)
            mesh.tetrahedra.push_back({first + a, first + b, first + c, first + d});
    }
    for (Tetrahedron& t : mesh.tetrahedra)
        for (int& node : t)
            if (node == 16) node = 15; // the third cube's first corner is the second cube's last
    return mesh;
}

} // namespace

TEST_CASE("edges are those of the tetrahedra, once each and ascending")
{
    const TetMesh mesh = cubeMesh(3, 2);
    std::set<std::array<int, 2>> expected;
    for (const Tetrahedron& t : mesh.tetrahedra)
        for (int a : t)
            for (int b : t)
                if (a < b) expected.insert({a, b});
    CHECK(edges(mesh) == std::vector<std::array<int, 2>>(expected.begin(), expected.end()));
    CHECK(edges(unitTetrahedron()).size() == 6);
}

TEST_CASE("a node's neighbours are the other ends of its edges, ascending")
{
    const TetMesh mesh = cubeMesh(3, 3);
    std::vector<std::set<int>> expected(mesh.nodes.size());
    for (auto [a, b] : edges(mesh)) expected[a].insert(b), expected[b].insert(a);
    const CompressedRows rows = nodeNeighbours(mesh);
    REQUIRE(rows.size() == static_cast<int>(mesh.nodes.size()));
    for (int i = 0; i < rows.size(); ++i)
        CHECK(std::vector<int>(rows[i].begin(), rows[i].end()) ==
              std::vector<int>(expected[i].begin(), expected[i].end()));
}

TEST_CASE("the tetrahedra around a node are those that use it, ascending")
{
    const TetMesh mesh = cubeMesh(2, 4);
    const CompressedRows rows = tetrahedraAroundNodes(mesh);
    REQUIRE(rows.size() == static_cast<int>(mesh.nodes.size()));
    for (int i = 0; i < rows.size(); ++i) {
        std::vector<int> expected;
        for (int t = 0; t < static_cast<int>(mesh.tetrahedra.size()); ++t)
            if (std::ranges::count(mesh.tetrahedra[t], i) > 0) expected.push_back(t);
        CHECK(std::vector<int>(rows[i].begin(), rows[i].end()) == expected);
    }
}

TEST_CASE("face neighbours share the three nodes of the face, and what has none is the surface")
{
    const TetMesh mesh = cubeMesh(3, 5);
    const std::vector<std::array<int, 4>> neighbours = faceNeighbours(mesh);
    REQUIRE(neighbours.size() == mesh.tetrahedra.size());
    std::size_t alone = 0;
    for (int t = 0; t < static_cast<int>(mesh.tetrahedra.size()); ++t)
        for (int side = 0; side < 4; ++side) {
            const int other = neighbours[t][side];
            if (other < 0) {
                ++alone;
                continue;
            }
            CHECK(other != t);
            for (int place : kTetrahedronFaces[side])
                CHECK(std::ranges::count(mesh.tetrahedra[other], mesh.tetrahedra[t][place]) == 1);
            CHECK(std::ranges::count(neighbours[other], t) == 1);
        }
    CHECK(alone == extractSurface(mesh).mesh.triangles.size());
    CHECK(alone == 6 * 9 * 2);
}

TEST_CASE("pieces hang together by shared nodes, and are numbered by their first tetrahedron")
{
    const TetMesh mesh = threeCubes();
    const Components pieces = connectedComponents(mesh);
    CHECK(pieces.count == 2);
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) CHECK(pieces.ofTetrahedron[t] == (t < 6 ? 0 : 1));
    CHECK(pieces.ofNode[0] == 0);
    CHECK(pieces.ofNode[15] == 1);
    CHECK(pieces.ofNode[16] == -1); // no tetrahedron uses it any more
    CHECK(pieces.ofNode[23] == 1);
    CHECK(connectedComponents(TetMesh{}).count == 0);
}

TEST_CASE("the surface of a cube is closed, looks outwards, holds its volume and leaves the inner nodes out")
{
    for (int n : {1, 2, 4}) {
        const TetMesh mesh = cubeMesh(n, 6);
        const Surface surface = extractSurface(mesh);
        CHECK_NOTHROW(check(surface.mesh, "surface"));
        CHECK(isClosedManifold(surface.mesh));
        CHECK(surface.mesh.triangles.size() == static_cast<std::size_t>(12 * n * n));
        CHECK(surface.nodes.size() == static_cast<std::size_t>(6 * n * n + 2));
        CHECK(std::ranges::is_sorted(surface.nodes));
        CHECK(volumeInside(surface.mesh) == Approx(1.0).epsilon(1e-13));
        CHECK(volumeOf(mesh) == Approx(1.0).epsilon(1e-13));
        for (std::size_t i = 0; i < surface.nodes.size(); ++i)
            CHECK(surface.mesh.vertices[i] == mesh.nodes[surface.nodes[i]]);
    }
}

TEST_CASE("the surface lists its triangles in the order of the tetrahedra")
{
    const TetMesh mesh = unitTetrahedron();
    const Surface surface = extractSurface(mesh);
    CHECK(surface.nodes == std::vector<int>{0, 1, 2, 3});
    CHECK(surface.mesh.triangles == std::vector<Triangle>(kTetrahedronFaces.begin(), kTetrahedronFaces.end()));
}

} // namespace adjacency_test
