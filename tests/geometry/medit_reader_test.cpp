#include "filasofia/geometry/medit_reader.h"
#include "filasofia/geometry/mesh_file.h"
#include "geometry/sample_meshes.h"

namespace medit_reader_test {

using namespace filasofia;
using namespace filasofia::geometry;
using Catch::Matchers::Contains;

namespace {

// As MMG writes: what a mesh needs between what it does not.
const std::string kFile = "MeshVersionFormatted 2\n\nDimension 3\n\nVertices\n5\n0 0 0 0\n1 0 0 1\n0 1 0 0\n0 0 1 0\n"
                          "1 1 1 0\n\nCorners\n1\n2\nRequiredVertices 1\n2\nTriangles # the outside\n2\n1 3 2 7\n"
                          "1 2 4 7\n\nEdges\n1\n1 2 3\n\nTetrahedra\n2\n1 2 3 4 5\n5 4 3 2 6\n"
                          "\nNormals\n1\n0 0 -1e3\nNormalAtVertices\n1\n1 1\nEnd\n";

std::string errorIn(const std::string& bytes)
{
    return errorOf([&] { parseMedit(bytes, "a.mesh"); });
}

} // namespace

TEST_CASE("the solids of a Medit file are read, with their references as labels")
{
    const TemporaryFile file("a.mesh", kFile);
    const TetMesh mesh = loadTetMesh(file.path());
    CHECK_NOTHROW(check(mesh, "a.mesh"));
    CHECK(mesh.nodes == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}});
    CHECK(mesh.tetrahedra == std::vector<Tetrahedron>{{0, 1, 2, 3}, {4, 3, 2, 1}});
    CHECK(mesh.labels == std::vector{5, 6});
    const std::string bare = replaced(replaced(kFile, "3 4 5\n", "3 4 0\n"), "3 2 6", "3 2 0");
    CHECK(parseMedit(bare, "a.mesh").labels.empty());
}

TEST_CASE("hexahedra, prisms and pyramids of a Medit file are split")
{
    // A cube, a prism on its right side, and a pyramid on its top.
    const TetMesh mesh = parseMedit("MeshVersionFormatted 1\nDimension\n3\nVertices\n11\n0 0 0 0\n1 0 0 0\n1 1 0 0\n"
                                    "0 1 0 0\n0 0 1 0\n1 0 1 0\n1 1 1 0\n0 1 1 0\n2 0 0 0\n2 0 1 0\n.5 .5 2 0\n"
                                    "Hexahedra\n1\n1 2 3 4 5 6 7 8 1\nPrisms\n1\n2 9 3 6 10 7 2\n"
                                    "Pyramids\n1\n5 6 7 8 11 3\nEnd\n",
                                    "a.mesh");
    CHECK_NOTHROW(check(mesh, "a.mesh"));
    CHECK(mesh.tetrahedra.size() == 11);
    CHECK(volumeOf(mesh) == Approx(1.0 + 0.5 + 1.0 / 3.0));
}

TEST_CASE("the triangles and quadrilaterals of a Medit file are a surface")
{
    const LogTrap log;
    const TemporaryFile file("a.mesh", replaced(kFile, "Edges\n", "Quadrilaterals\n1\n1 4 5 3 0\nEdges\n"));
    const TriangleMesh mesh = loadTriangleMesh(file.path());
    CHECK(mesh.triangles == std::vector<Triangle>{{0, 2, 1}, {0, 1, 3}, {0, 3, 4}, {0, 4, 2}});
    CHECK_THAT(log.lines, Contains("a.mesh: 2 solids were left out: only polygons make a surface"));
    CHECK_THAT(errorOf([] { parseMeditSurface(replaced(kFile, "1 2 4 7", "1 2 6 7"), "a.mesh"); }),
               Contains("a.mesh:21: polygon 2 must name points in [1, 6), got 6"));
}

TEST_CASE("what is wrong in a Medit file is named with its line")
{
    CHECK_THAT(errorIn("solid cube"), Contains("a.mesh:1: a Medit file must begin with MeshVersionFormatted"));
    CHECK_THAT(errorIn(replaced(kFile, "Dimension 3", "Dimension 2")), Contains("a.mesh:3: the dimension must be 3"));
    CHECK_THAT(errorIn(replaced(kFile, "1 0 0 1", "1 nan 0 1")), Contains("a.mesh:8: a vertex's y must be finite"));
    CHECK_THAT(errorIn(replaced(kFile, "1 2 3 4 5", "1 2 3 9 5")),
               Contains("a.mesh:29: tetrahedron 1 names node 9, which the file does not define"));
    CHECK_THAT(errorIn(replaced(kFile, "1 2 3 4 5", "2 1 3 4 5")), Contains("a.mesh:29: tetrahedron 1 is inverted"));
    CHECK_THAT(errorIn(replaced(kFile, "1 2 3 4 5", "1 2 3 4 99999999999")), Contains("must fit into 32 bits"));
    CHECK_THAT(errorIn(replaced(kFile, "Tetrahedra\n2", "Tetrahedra\n1")),
               Contains("a.mesh:30: a section must begin here, got '5'"));
    CHECK_THAT(errorIn(replaced(kFile, "Tetrahedra\n2", "Tetrahedra\n900")),
               Contains("a.mesh:28: the number of elements must be in [0, "));
    CHECK_THAT(errorIn(replaced(kFile, "Tetrahedra", "TetrahedraP2")),
               Contains("a.mesh:27: elements must be of first order, got 'tetrahedrap2'"));
    CHECK_THAT(errorIn(replaced(kFile, "Edges", "Vertices")), Contains("a second section vertices"));
    CHECK_THAT(errorIn("MeshVersionFormatted 2\nDimension 3\nEnd"), Contains("must have a section Vertices"));
    CHECK_THAT(errorIn(kFile.substr(0, kFile.find("Tetra"))), Contains("a.mesh: must have at least 1 tetrahedron"));
}

TEST_CASE("a Medit file may be cut off anywhere and any byte may be wrong")
{
    const LogTrap log;
    damage(kFile, "a.mesh", [](const std::string& bytes) { return parseMedit(bytes, "a.mesh"); });
    damage(kFile, "a.mesh", [](const std::string& bytes) { return parseMeditSurface(bytes, "a.mesh"); });
}

} // namespace medit_reader_test
