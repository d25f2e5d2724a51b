#include "filasofia/geometry/gmsh_reader.h"
#include "filasofia/geometry/tetgen_reader.h"
#include "filasofia/geometry/vtk_reader.h"
#include "geometry/sample_meshes.h"

namespace second_order_test {

using namespace filasofia;
using namespace filasofia::geometry;
using Catch::Matchers::Contains;

namespace {

/// The nodes in the middle of the edges of the unit tetrahedron, in the order of VTK.
const std::string kMiddles[] = {".5 0 0", ".5 .5 0", "0 .5 0", "0 0 .5", ".5 0 .5", "0 .5 .5"};

/// One tetrahedron of second order, and a node that nothing uses.
std::string gmshFile(const std::string& middleOfFirst = kMiddles[0])
{
    std::string out = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n11\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n";
    out += "5 " + middleOfFirst + "\n";
    for (int k = 1; k < 6; ++k) out += text(5 + k, " ", kMiddles[k], "\n");
    // Gmsh has the last two edges the other way round.
    return out + "11 9 9 9\n$EndNodes\n$Elements\n1\n7 11 2 0 1 1 2 3 4 5 6 7 8 10 9\n$EndElements\n";
}

std::string vtkFile()
{
    std::string out = "# vtk DataFile Version 3.0\na title\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 10 double\n"
                      "0 0 0 1 0 0 0 1 0 0 0 1\n";
    for (const std::string& each : kMiddles) out += each + "\n";
    return out + "CELLS 1 11\n10 0 1 2 3 4 5 6 7 8 9\nCELL_TYPES 1\n24\n";
}

TetMesh tetGen()
{
    std::string nodes = "10 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n";
    for (int k = 0; k < 6; ++k) nodes += text(5 + k, " ", kMiddles[k], "\n");
    return parseTetGen({nodes, "a.node"}, {"1 10 0\n1 1 2 3 4 9 8 7 6 5 10\n", "a.ele"});
}

} // namespace

TEST_CASE("a tetrahedron of second order is read with its corners only")
{
    const LogTrap log;
    for (const TetMesh& mesh : {parseGmsh(gmshFile(), "a.msh"), parseVtk(vtkFile(), "a.vtk"), tetGen()}) {
        CHECK(mesh.nodes == unitTetrahedron().nodes); // no node in the middle of an edge stays behind
        CHECK(mesh.tetrahedra == unitTetrahedron().tetrahedra);
    }
    const std::string rest = ": 1 tetrahedra of second order were read with their corners only: 6 nodes in the middle "
                             "of edges were left out\n";
    CHECK(log.lines ==
          "a.msh" + rest + "a.msh: 1 nodes that no tetrahedron uses were dropped\na.vtk" + rest + "a.ele" + rest);
}

TEST_CASE("the warning tells how far edges of second order were bent")
{
    const LogTrap log;
    parseGmsh(gmshFile(".5 .25 0"), "a.msh");
    CHECK_THAT(log.lines, Contains("left out; 1 of them bend their edge, by up to 25 % of its length: the mesh is "
                                   "straight there now"));
}

TEST_CASE("a tetrahedron of second order in two physical groups is read once")
{
    const LogTrap log;
    // Between its two groups and one more tetrahedron, whose nodes in the middle must be known as its own.
    const std::string two = replaced(replaced(gmshFile(), "Nodes\n11\n", "Nodes\n14\n"), "11 9 9 9\n",
                                     "11 1 1 1\n12 1 .5 .5\n13 .5 1 .5\n14 .5 .5 1\n");
    const TetMesh mesh = parseGmsh(replaced(two, "1\n7 11 2 0 1 1 2 3 4 5 6 7 8 10 9\n",
                                            "3\n7 11 2 9 1 1 2 3 4 5 6 7 8 10 9\n8 11 2 11 1 1 2 3 4 5 6 7 8 10 9\n"
                                            "9 11 2 11 1 2 3 4 11 6 10 9 12 14 13\n"),
                                   "a.msh");
    CHECK(mesh.tetrahedra == std::vector<Tetrahedron>{{0, 1, 2, 3}, {1, 2, 3, 4}});
    CHECK(mesh.labels == std::vector{9, 11});
    CHECK_THAT(log.lines, Contains("labelled by the first one, and not by 11"));
    CHECK_THAT(log.lines, Contains("2 tetrahedra of second order were read with their corners only: 9 nodes in the "
                                   "middle of edges were left out\n"));
}

TEST_CASE("nodes in the middle of edges are checked as others are")
{
    const LogTrap log; // damaged files may be bent
    const auto errorIn = [](const std::string& bytes) { return errorOf([&] { parseGmsh(bytes, "a.msh"); }); };
    CHECK_THAT(errorIn(replaced(gmshFile(), "10 9\n$", "10 77\n$")),
               Contains("a.msh:20: tetrahedron 7 names node 77, which the file does not define"));
    CHECK_THAT(errorIn(replaced(gmshFile(), "10 9\n$", "10 10\n$")), Contains("tetrahedron 7 names node 10 twice"));
    damage(gmshFile(), "a.msh", [](const std::string& bytes) { return parseGmsh(bytes, "a.msh"); });
    damage(vtkFile(), "a.vtk", [](const std::string& bytes) { return parseVtk(bytes, "a.vtk"); });
}

} // namespace second_order_test
