#include "filasofia/geometry/gmsh_reader.h"
#include "geometry/gmsh_writer.h"
#include "geometry/sample_meshes.h"

#include <map>

namespace gmsh_reader_test {

using namespace filasofia;
using namespace filasofia::geometry;
using Catch::Matchers::Contains;

namespace {

std::string errorIn(std::string_view bytes)
{
    return errorOf([&] { parseGmsh(bytes, "a.msh"); });
}

const std::string kAscii2 = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n"
                            "$EndNodes\n$Elements\n1\n7 4 2 0 1 1 2 3 4\n$EndElements\n";
const std::string kAscii4 =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
    "$EndNodes\n$Elements\n1 1 7 7\n3 1 4 1\n7 1 2 3 4\n$EndElements\n";

const std::string kAscii1 = "$NOD\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$ENDNOD\n"
                            "$ELM\n2\n6 2 3 1 3 1 2 3\n7 4 9 1 4 1 2 3 4\n$ENDELM\n";

} // namespace

TEST_CASE("a mesh comes back from every version, form and byte order, bit for bit")
{
    const TetMesh mesh = cubeMesh(3, 1);
    for (bool version4 : {false, true})
        for (GmshForm form : {GmshForm::Ascii, GmshForm::Binary, GmshForm::SwappedBinary})
            for (std::int64_t gap : {1, 1000}) {
                const TetMesh read = parseGmsh(writeGmsh(mesh, {version4, form, gap}), "a.msh");
                CHECK(read.nodes == mesh.nodes);
                CHECK(read.tetrahedra == mesh.tetrahedra);
            }
}

TEST_CASE("physical groups become labels with names, in every version, form and byte order")
{
    TetMesh mesh = cubeMesh(3, 1);
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) mesh.labels.push_back(t % 3 == 0 ? 12 : 5);
    mesh.labelNames = {{5, "wall of the gut"}, {12, "tumour"}};
    for (bool version4 : {false, true})
        for (GmshForm form : {GmshForm::Ascii, GmshForm::Binary, GmshForm::SwappedBinary}) {
            const TetMesh read = parseGmsh(writeGmsh(mesh, {version4, form}), "a.msh");
            CHECK(read.labels == mesh.labels);
            CHECK(read.labelNames == mesh.labelNames);
            CHECK(read.tetrahedra == mesh.tetrahedra);
        }
    CHECK(parseGmsh(kAscii2, "a.msh").labels.empty());
    CHECK(parseGmsh(kAscii4, "a.msh").labels.empty());
}

TEST_CASE("a volume of several physical groups has the label of the first, and the others are named")
{
    const std::string names = "$PhysicalNames\n2\n3 9 \"organ\"\n3 11 \"tumour\"\n$EndPhysicalNames\n";
    // Version 2 has its elements once for each group.
    const std::string twice = replaced(replaced(kAscii2, "$Nodes\n", names + "$Nodes\n"), "1\n7 4 2 0 1 1 2 3 4\n",
                                       "2\n7 4 2 9 1 1 2 3 4\n8 4 2 11 1 1 2 3 4\n");
    const std::string entities = "$Entities\n0 0 0 1\n1 0 0 0 1 1 1 2 9 11 0\n$EndEntities\n";
    const std::string both = replaced(kAscii4, "$Nodes\n", names + entities + "$Nodes\n");
    for (const std::string& file : {twice, both}) {
        const LogTrap log;
        const TetMesh read = parseGmsh(file, "a.msh");
        CHECK(read.labels == std::vector<int>{9});
        CHECK(log.warnings == "a.msh: volumes are in several physical groups; their tetrahedra are labelled by the "
                              "first one, and not by 'tumour': give each volume one group\n");
    }
    CHECK_THAT(errorIn(replaced(twice, "8 4 2 11", "8 4 2 9")), Contains("same side")); // given twice for one group
}

TEST_CASE("without physical groups, several geometric entities are the labels")
{
    const std::string two = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n"
                            "5 1 1 1\n$EndNodes\n$Elements\n2\n7 4 2 0 1 1 2 3 4\n8 4 2 0 3 2 5 3 4\n$EndElements\n";
    CHECK(parseGmsh(two, "a.msh").labels == std::vector{1, 3});
}

TEST_CASE("a file of Gmsh 1 is read, with its physical groups")
{
    const TetMesh mesh = parseGmsh(kAscii1, "a.msh");
    CHECK(mesh.nodes == unitTetrahedron().nodes);
    CHECK(mesh.tetrahedra == unitTetrahedron().tetrahedra);
    CHECK(mesh.labels == std::vector{9});
    CHECK(parseGmsh(replaced(kAscii1, "7 4 9", "7 4 0"), "a.msh").labels.empty());
    CHECK(parseGmsh(kAscii1 + "$X\n1 2\n$ENDX\n", "a.msh").nodes == unitTetrahedron().nodes);
    CHECK(errorIn(replaced(kAscii1, "1 4 1 2 3 4", "1 5 1 2 3 4")) ==
          "a.msh:11: a tetrahedron must have 4 nodes, got 5");
    CHECK(errorIn(replaced(kAscii1, "2 3 4\n$", "2 3 8\n$")) ==
          "a.msh:11: tetrahedron 7 names node 8, which the file does not define; 4 nodes are defined, from 1 to 4");
    CHECK_THAT(errorIn(replaced(kAscii1, "$ENDNOD", "$EndNOD")), Contains("a.msh:7: $NOD must end with $ENDNOD"));
    CHECK_THAT(errorIn(kAscii1.substr(0, kAscii1.find("$ELM"))), Contains("must have an $ELM section"));
    CHECK_THAT(errorIn(replaced(kAscii1, "$ELM\n2", "$ELM\n99")), Contains("the number of elements must be in [0, "));
    damage(kAscii1, "a.msh", [](const std::string& bytes) { return parseGmsh(bytes, "a.msh"); });
}

TEST_CASE("version 2 may be written without its minor number")
{
    for (const char* version : {"2", "2.0", "2.1"})
        CHECK(parseGmsh(replaced(kAscii2, "2.2", version), "a.msh").nodes == unitTetrahedron().nodes);
}

TEST_CASE("what is wrong with names and groups is named with its line")
{
    const auto with = [](std::string_view names) {
        return errorIn(replaced(kAscii2, "$Nodes\n", text("$PhysicalNames\n", names, "$EndPhysicalNames\n$Nodes\n")));
    };
    CHECK_THAT(with("1\n3 1 liver\n"), Contains("a.msh:6: a physical group's name must stand between quotation marks"));
    CHECK_THAT(with("2\n3 1 \"a\"\n3 2 \"a\"\n"), Contains("'a' is given twice"));
    CHECK_THAT(with("1\n3 99999999999 \"a\"\n"), Contains("must fit into 32 bits"));
    CHECK_THAT(with("99\n"), Contains("physical names"));
    const std::string parts = "$PartitionedEntities\n$EndPartitionedEntities\n";
    CHECK_THAT(errorIn(replaced(kAscii4, "$Nodes\n", parts + "$Nodes\n")), Contains("a partitioned mesh is not read"));
    const std::string volumes = "$Entities\n0 0 0 0\n$EndEntities\n";
    CHECK_THAT(errorIn(std::string(kAscii4) + volumes), Contains("$Entities must stand before $Elements"));
    CHECK_THAT(errorIn(replaced(kAscii4, "$Nodes\n", volumes + volumes + "$Nodes\n")), Contains("second $Entities"));
}

TEST_CASE("other sections are skipped, and lines may end as they do elsewhere")
{
    const std::string text =
        replaced(kAscii2, "$Nodes\n", "$PhysicalNames\n1\n3 1 \"the $Nodes of it\"\n$EndPhysicalNames\n$Nodes\n");
    CHECK(parseGmsh(text + "$NodeData\n1\n\"x\"\n$EndNodeData\n", "a.msh").nodes == unitTetrahedron().nodes);
    std::string crlf;
    for (char c : kAscii2) crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
    CHECK(parseGmsh(crlf, "a.msh").nodes == unitTetrahedron().nodes);
    CHECK(parseGmsh(kAscii4, "a.msh").tetrahedra == unitTetrahedron().tetrahedra);
}

TEST_CASE("points, lines and surfaces are passed over, and nodes of theirs alone are dropped")
{
    const std::string text =
        replaced(replaced(kAscii2, "$Nodes\n4\n", "$Nodes\n6\n9 5 5 5\n"), "$EndNodes", "8 6 6 6\n$EndNodes");
    const TetMesh mesh =
        parseGmsh(replaced(text, "1\n7 4", "4\n1 15 2 0 1 9\n2 1 2 0 1 9 1\n3 9 0 1 2 3 9 8 4\n7 4"), "a.msh");
    CHECK(mesh.nodes == unitTetrahedron().nodes);
    CHECK(mesh.tetrahedra == unitTetrahedron().tetrahedra);
}

TEST_CASE("parametric nodes of version 4 carry their parameters behind their positions")
{
    const std::string text = replaced(kAscii4, "3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n",
                                      "2 1 1 4\n1\n2\n3\n4\n0 0 0 .1 .2\n1 0 0 .1 .2\n0 1 0 .3 .4\n0 0 1 .5 .6\n");
    CHECK(parseGmsh(text, "a.msh").nodes == unitTetrahedron().nodes);
}

TEST_CASE("a wrong header is named")
{
    CHECK_THAT(errorIn("solid cube"), Contains("a.msh:1: a Gmsh file must begin with $MeshFormat"));
    CHECK_THAT(errorIn(""), Contains("must begin with $MeshFormat"));
    CHECK_THAT(errorIn(replaced(kAscii2, "2.2", "4.0")), Contains("a.msh:2: the Gmsh format must be 2 to 2.2 or 4.1"));
    CHECK_THAT(errorIn(replaced(kAscii2, "2.2 0", "2.2 2")),
               Contains("the file type must be 0 (ASCII) or 1 (binary), got 2"));
    CHECK_THAT(errorIn(replaced(kAscii2, "0 8", "0 4")), Contains("the data size must be 8, got 4"));
    std::string binary = writeGmsh(unitTetrahedron(), {false, GmshForm::Binary, 1});
    binary[binary.find('\x01')] = 7;
    CHECK_THAT(errorIn(binary), Contains("a.msh: byte 20: the byte order's number must be 1"));
}

TEST_CASE("hexahedra, prisms and pyramids are split into tetrahedra with their labels")
{
    // A cube, a prism on its right side, and a pyramid on its top.
    const std::string file =
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 6 \"tip\"\n$EndPhysicalNames\n$Nodes\n11\n"
        "1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n9 2 0 0\n10 2 0 1\n11 .5 .5 2\n"
        "$EndNodes\n$Elements\n3\n1 5 2 4 1 1 2 3 4 5 6 7 8\n2 6 2 5 1 2 9 3 6 10 7\n3 7 2 6 1 5 6 7 8 11\n"
        "$EndElements\n";
    const TetMesh mesh = parseGmsh(file, "a.msh");
    CHECK_NOTHROW(check(mesh, "a.msh"));
    std::map<int, double> volumes, counts;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        volumes[mesh.labels[t]] += signedVolume(mesh, static_cast<int>(t));
        ++counts[mesh.labels[t]];
    }
    CHECK((counts == std::map<int, double>{{4, 6}, {5, 3}, {6, 2}}));
    CHECK(volumes[4] == Approx(1.0));
    CHECK(volumes[5] == Approx(0.5));
    CHECK(volumes[6] == Approx(1.0 / 3.0));
    // Nothing is left open between them: the surface is 4 sides of the cube, 4 of the prism, 4 of the pyramid.
    double area = 0.0;
    const TriangleMesh surface = extractSurface(mesh).mesh;
    for (const Triangle& t : surface.triangles)
        area += 0.5 * length(cross(surface.vertices[t[1]] - surface.vertices[t[0]],
                                   surface.vertices[t[2]] - surface.vertices[t[0]]));
    CHECK(area == Approx(4.0 + 2.0 * 0.5 + 1.0 + std::sqrt(2.0) + 4.0 * 0.5 * std::sqrt(1.25)));
    CHECK_THAT(errorIn(replaced(file, "5 6 7 8\n2 6", "6 5 7 8\n2 6")), Contains("a tetrahedron of hexahedron 1 is "));
    CHECK_THAT(errorIn(replaced(file, "5 6 7 8 11", "5 6 7 5 11")), Contains("pyramid 3 names node 5 twice"));
}

TEST_CASE("solids of a higher order are refused by name")
{
    CHECK_THAT(errorIn(replaced(kAscii4, "3 1 4 1", "3 1 12 1")),
               Contains("a.msh:18: ") && Contains("second-order hexahedron"));
    CHECK(errorIn(replaced(kAscii2, "7 4", "7 12")) ==
          "a.msh:13: a solid element must be a tetrahedron, hexahedron, prism or pyramid (type 4 to 7) or a "
          "second-order tetrahedron (type 11), got a second-order hexahedron (type 12)");
    CHECK_THAT(errorIn(replaced(kAscii2, "7 4", "7 99")),
               Contains("the element type must be one of Gmsh's 1 to 31, got 99"));
}

TEST_CASE("a wrong number in a Gmsh file is named with its line")
{
    CHECK(errorIn(replaced(kAscii2, "2 1 0 0", "2 nan 0 0")) == "a.msh:7: a node's x must be finite, got 'nan'");
    CHECK(errorIn(replaced(kAscii2, "2 1 0 0", "2 1 -inf 0")) == "a.msh:7: a node's y must be finite, got '-inf'");
    CHECK(errorIn(replaced(kAscii2, "2 1 0 0", "2 1 0 1e999")) ==
          "a.msh:7: a node's z must fit in a double, got '1e999'");
    CHECK(errorIn(replaced(kAscii2, "2 1 0 0", "2 1 O 0")) == "a.msh:7: a node's y must be a number, got 'O'");
    CHECK(errorIn(replaced(kAscii2, "2 1 0 0", "2.5 1 0 0")) ==
          "a.msh:7: a node's number must be a whole number, got '2.5'");
    CHECK(errorIn(replaced(kAscii2, "2 1 0 0", "1 1 0 0")) == "a.msh:7: node 1 is defined twice");
    CHECK(errorIn(replaced(replaced(kAscii2, "2 1 0 0", "1 1 0 0"), "1 2 3 4\n$", "1 1 3 4\n$")) ==
          "a.msh:7: node 1 is defined twice"); // and not: tetrahedron 7 names it twice
    CHECK_THAT(
        errorIn(replaced(kAscii2, "1 2 3 4\n$", "1 2 3 5\n$")),
        Contains(
            "a.msh:13: tetrahedron 7 names node 5, which the file does not define; 4 nodes are defined, from 1 to 4"));
    CHECK_THAT(errorIn(replaced(kAscii2, "1 2 3 4\n$", "1 2 3 -4\n$")), Contains("names node -4"));
    CHECK_THAT(errorIn(replaced(kAscii2, "1 2 3 4\n$", "1 2 3 3\n$")),
               Contains("a.msh:13: tetrahedron 7 names node 3 twice"));
    CHECK_THAT(errorIn(replaced(kAscii2, "1 2 3 4\n$", "2 1 3 4\n$")),
               Contains("a.msh:13: tetrahedron 7 is inverted: its volume must be > ") &&
                   Contains("got -0.16666666666666666"));
    CHECK_THAT(errorIn(replaced(kAscii2, "4 0 0 1", "4 1 1 0")),
               Contains("a.msh:13: tetrahedron 7 is flat: its volume must be > "));
    CHECK_THAT(errorIn(replaced(kAscii2, "1\n7 4 2 0 1 1 2 3 4", "2\n7 4 2 0 1 1 2 3 4\n8 4 2 0 1 1 2 3 4")),
               Contains("a.msh:14: tetrahedra 7 and 8 lie on the same side of their common face"));
    CHECK_THAT(errorIn(replaced(kAscii4, "1 2 3 4\n$", "2 1 3 4\n$")), Contains("a.msh:19: tetrahedron 7 is inverted"));
    CHECK_THAT(errorIn(replaced(kAscii4, "0 1 0\n", "0 inf 0\n")), Contains("a.msh:13: a node's y must be finite"));
}

TEST_CASE("a wrong number in a binary Gmsh file is named with its byte")
{
    TetMesh mesh = unitTetrahedron();
    std::swap(mesh.tetrahedra[0][0], mesh.tetrahedra[0][1]);
    for (bool version4 : {false, true})
        CHECK_THAT(errorIn(writeGmsh(mesh, {version4, GmshForm::Binary, 1})),
                   Contains("a.msh: byte ") && Contains("tetrahedron 1 is inverted"));
    mesh = unitTetrahedron();
    mesh.nodes[2].y = std::numeric_limits<double>::quiet_NaN();
    CHECK_THAT(errorIn(writeGmsh(mesh, {true, GmshForm::SwappedBinary, 1})), Contains("a node's y must be finite"));
}

TEST_CASE("a file without tetrahedra, nodes or elements is refused, and so is one with two of them")
{
    CHECK(errorIn(replaced(kAscii2, "1\n7 4 2 0 1 1 2 3 4", "1\n7 2 2 0 1 1 2 3")) ==
          "a.msh: must have at least 1 tetrahedron, got 0");
    CHECK(errorIn(replaced(kAscii2, "1\n7 4 2 0 1 1 2 3 4", "0")) == "a.msh: must have at least 1 tetrahedron, got 0");
    const std::size_t elements = kAscii2.find("$Elements"), nodes = kAscii2.find("$Nodes");
    CHECK_THAT(errorIn(kAscii2.substr(0, elements)), Contains("a.msh: must have an $Elements section"));
    CHECK_THAT(errorIn(kAscii2.substr(0, nodes) + kAscii2.substr(elements)),
               Contains("a.msh: must have a $Nodes section"));
    CHECK_THAT(errorIn(kAscii2 + kAscii2.substr(nodes)), Contains("a.msh:15: the file has a second $Nodes section"));
}

TEST_CASE("a count that no file of this size could hold is refused before anything is allocated")
{
    CHECK(errorIn(replaced(kAscii2, "$Nodes\n4", "$Nodes\n10000000000")) ==
          "a.msh:5: the number of nodes must be in [0, 10] (the rest of the file holds no more), got 10000000000");
    CHECK_THAT(errorIn(replaced(kAscii2, "$Nodes\n4", "$Nodes\n-4")),
               Contains("a.msh:5: the number of nodes must be in [0, "));
    CHECK_THAT(errorIn(replaced(kAscii2, "$Elements\n1", "$Elements\n400")),
               Contains("a.msh:12: the number of elements must be in [0, "));
    CHECK_THAT(errorIn(replaced(kAscii2, "7 4 2", "7 4 2000000000")),
               Contains("a.msh:13: the number of tags must be in [0, "));
    CHECK_THAT(errorIn(replaced(kAscii4, "1 4 1 4", "1 400000000 1 4")),
               Contains("a.msh:5: the number of nodes must be in [0, "));
    CHECK_THAT(errorIn(replaced(kAscii4, "1 4 1 4", "1 5 1 5")),
               Contains("$Nodes announces 5 nodes, its blocks hold 4"));
    CHECK_THAT(errorIn(replaced(kAscii4, "1 1 7 7", "1 2 7 8")),
               Contains("$Elements announces 2 elements, its blocks hold 1"));
    CHECK_THAT(errorIn(replaced(kAscii2, "$Nodes\n4", "$Nodes\n3")),
               Contains("a.msh:9: $Nodes must end with $EndNodes"));
}

TEST_CASE("a Gmsh file cut off anywhere is refused, and any byte may be wrong: nothing but an Error comes out")
{
    std::mt19937 random(1);
    for (bool version4 : {false, true})
        for (GmshForm form : {GmshForm::Ascii, GmshForm::Binary, GmshForm::SwappedBinary}) {
            const std::string whole = writeGmsh(cubeMesh(1, 1), {version4, form, 3});
            const std::size_t end = whole.rfind("$EndElements") + std::string_view("$EndElements").size();
            for (std::size_t length = 0; length < end; ++length)
                if (!Catch::contains(errorIn(whole.substr(0, length)), "a.msh")) FAIL("cut at " << length);
            for (int i = 0; i < 500; ++i) {
                std::string wrong = whole;
                wrong[random() % wrong.size()] = static_cast<char>(random());
                try {
                    check(parseGmsh(wrong, "a.msh"), "what was read");
                } catch (const Error& error) {
                    if (!Catch::contains(error.what(), "a.msh")) FAIL(error.what());
                }
            }
        }
}

} // namespace gmsh_reader_test
