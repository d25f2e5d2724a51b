#include "filasofia/geometry/vtk_reader.h"

#include "filasofia/core/log.h"

#include "geometry/sample_meshes.h"

#include <bit>
#include <cstring>

namespace vtk_reader_test {

using namespace filasofia;
using namespace filasofia::geometry;
using Catch::Matchers::Contains;

namespace {

std::string errorIn(std::string_view bytes)
{
    return errorOf([&] { parseVtk(bytes, "a.vtk"); });
}

struct VtkForm {
    bool version5 = false, binary = false;
};
constexpr VtkForm kForms[] = {{false, false}, {false, true}, {true, false}, {true, true}};

/// Writes what VTK would write: a triangle, then the tetrahedra, with two lists of values before the labels.
class VtkWriter {
public:
    explicit VtkWriter(VtkForm form) : form_(form) {}

    std::string write(const TetMesh& mesh)
    {
        const std::size_t cells = mesh.tetrahedra.size() + 1, nodes = 4 * mesh.tetrahedra.size() + 3;
        out_ = text("# vtk DataFile Version ", form_.version5 ? "5.1" : "3.0", "\na title with POINTS in it\n",
                    form_.binary ? "BINARY" : "ASCII", "\nDATASET UNSTRUCTURED_GRID\nPOINTS ", mesh.nodes.size(),
                    " double\n");
        for (const Vec3& p : mesh.nodes) put(p.x), put(p.y), put(p.z);
        out_ += "\nMETADATA\nINFORMATION 1\nNAME x LOCATION y\nDATA 1 2 3\n\n";
        if (form_.version5) {
            out_ += text("CELLS ", cells + 1, " ", nodes, "\nOFFSETS vtktypeint64\n");
            put(std::int64_t{0});
            for (std::size_t i = 0; i < cells; ++i) put(static_cast<std::int64_t>(3 + 4 * i));
            out_ += "\nCONNECTIVITY vtktypeint64\n";
            cellsOf<std::int64_t>(mesh, false);
        } else {
            out_ += text("CELLS ", cells, " ", nodes + cells, "\n");
            cellsOf<std::int32_t>(mesh, true);
        }
        out_ += text("\nCELL_TYPES ", cells, "\n");
        put(std::int32_t{5});
        for (std::size_t i = 1; i < cells; ++i) put(std::int32_t{10});
        out_ += text("\nPOINT_DATA ", mesh.nodes.size(), "\nVECTORS v float\n");
        for (std::size_t i = 0; i < 3 * mesh.nodes.size(); ++i) put(0.5f);
        out_ += text("\nCELL_DATA ", cells, "\nFIELD FieldData 1\nquality 1 ", cells, " float\n");
        for (std::size_t i = 0; i < cells; ++i) put(0.25f);
        out_ += "\nSCALARS part int 1\nLOOKUP_TABLE default\n";
        put(std::int32_t{-1});
        for (int label : mesh.labels) put(std::int32_t{label});
        return out_ + "\n";
    }

private:
    template <class Number> void put(Number number)
    {
        if (!form_.binary) {
            out_ += text(number, '\n');
            return;
        }
        char raw[sizeof number];
        std::memcpy(raw, &number, sizeof number);
        if (std::endian::native == std::endian::little) std::reverse(raw, raw + sizeof number);
        out_.append(raw, sizeof number);
    }
    template <class Number> void cellsOf(const TetMesh& mesh, bool counts)
    {
        if (counts) put(Number{3});
        for (int node : {0, 1, 2}) put(static_cast<Number>(node));
        for (const Tetrahedron& t : mesh.tetrahedra) {
            if (counts) put(Number{4});
            for (int node : t) put(static_cast<Number>(node));
        }
    }

    VtkForm form_;
    std::string out_;
};

const std::string kHead = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\n";
const std::string kFile = kHead + "POINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n";

} // namespace

TEST_CASE("a mesh with labels comes back from every version and form of VTK's files, bit for bit")
{
    const TetMesh mesh = labelledCube(3);
    for (const VtkForm form : kForms) {
        const TetMesh read = parseVtk(VtkWriter(form).write(mesh), "a.vtk");
        CHECK(read.nodes == mesh.nodes);
        CHECK(read.tetrahedra == mesh.tetrahedra);
        CHECK(read.labels == mesh.labels);
    }
    CHECK(parseVtk(kFile, "a.vtk").labels.empty());
    CHECK(parseVtk(kFile, "a.vtk").tetrahedra == unitTetrahedron().tetrahedra);
    const std::string broken = kFile + "CELL_DATA 1\nSCALARS e float\nLOOKUP_TABLE default\n0.5\n";
    CHECK(parseVtk(broken, "a.vtk").labels.empty()); // no whole number
}

TEST_CASE(
    "one list of several becomes the labels of a VTK file: the named one, or the first that does not number cells")
{
    const TetMesh mesh = labelledCube(2);
    const std::size_t cells = mesh.tetrahedra.size() + 1;
    std::string id = "\nSCALARS id int 1\nLOOKUP_TABLE default\n",
                zone = "\nSCALARS zone short 1\nLOOKUP_TABLE default\n";
    std::vector<int> zones;
    for (std::size_t i = 0; i < cells; ++i) {
        id += text(i, ' ');
        zone += text(i % 4, ' ');
        if (i > 0) zones.push_back(static_cast<int>(i % 4));
    }
    const std::string part = "\nSCALARS part int 1", plain = VtkWriter({}).write(mesh);
    const std::string numbered = replaced(plain, part, id + part), three = replaced(plain, part, id + zone + part);
    const auto logOf = [](const std::string& file, std::vector<int>& labels) {
        std::string log;
        setLogSink([&](LogLevel, std::string_view line) { log += text(line, '\n'); });
        labels = parseVtk(file, "a.vtk").labels;
        setLogSink({});
        return log;
    };
    std::vector<int> labels;
    CHECK(logOf(plain, labels).empty());
    CHECK(labels == mesh.labels);
    CHECK(logOf(numbered, labels) == "a.vtk: labels are 'part'; passed over, as each cell has its own number: 'id'\n");
    CHECK(labels == mesh.labels);
    CHECK(logOf(three, labels) ==
          "a.vtk: labels are 'zone', the first of 'zone', 'part'; name another one with labels; "
          "passed over, as each cell has its own number: 'id'\n");
    CHECK(labels == zones);
    const std::string alone = numbered.substr(0, numbered.find(part));
    CHECK(logOf(alone, labels) == "a.vtk: no labels: 'id' gives each cell its own number; name it (labels) if these "
                                  "are labels\n");
    CHECK(labels.empty());
    CHECK(parseVtk(three, "a.vtk", "part").labels == mesh.labels);
    CHECK(parseVtk(alone, "a.vtk", "id").labels.size() == mesh.tetrahedra.size());
    CHECK(errorOf([&] { parseVtk(three, "a.vtk", "organ"); }) ==
          "a.vtk: labels must name a list of whole numbers per cell, got 'organ', which the file does not have; its "
          "lists: 'id', 'zone', 'part'");
    CHECK_THAT(errorOf([&] { parseVtk(three, "a.vtk", "quality"); }),
               Contains("got 'quality', whose numbers are no whole ones; its lists: 'id', "));
    CHECK_THAT(errorOf([&] { parseVtk(kFile, "a.vtk", "part"); }), Contains("its lists: none"));
}

TEST_CASE("the solids of VTK's files are split, however a wedge is turned")
{
    // A voxel, a hexahedron above it, and beside each of them a wedge, one as VTK has it and one as others do.
    const std::string points = "POINTS 16 float\n0 0 0 1 0 0 0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1\n"
                               "0 0 2 1 0 2 1 1 2 0 1 2 2 0 0 2 0 1 2 0 2 .5 .5 3\n";
    const std::string cells = "CELLS 5 38\n8 0 1 2 3 4 5 6 7\n8 4 5 7 6 8 9 10 11\n6 1 12 3 5 13 7\n6 5 7 13 9 10 14\n"
                              "5 8 9 10 11 15\nCELL_TYPES 5\n11 12 13 13 14\n";
    const TetMesh mesh = parseVtk(kHead + points + cells, "a.vtk");
    CHECK_NOTHROW(check(mesh, "a.vtk"));
    CHECK(mesh.tetrahedra.size() == 6 + 6 + 3 + 3 + 2);
    CHECK(volumeOf(mesh) == Approx(1.0 + 1.0 + 0.5 + 0.5 + 1.0 / 3.0));
    CHECK(volumeInside(extractSurface(mesh).mesh) == Approx(volumeOf(mesh))); // nothing is open between them
    CHECK_THAT(errorIn(kHead + points + replaced(cells, "11 12", "11 25")),
               Contains("cell 1 must be a tetrahedron of 4 or 10 nodes, or a hexahedron, voxel, wedge or pyramid") &&
                   Contains("got VTK's type 25 with 8 nodes"));
    CHECK_THAT(errorIn(kHead + points + replaced(cells, "5 8 9 10 11 15", "5 8 9 10 8 15")),
               Contains("a.vtk:13: pyramid 4 names node 8 twice"));
}

TEST_CASE("polygons of VTK's polydata become triangles, with their texture coordinates")
{
    const std::string head = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\n";
    const std::string points = "POINTS 5 double\n0 0 0 1 0 0 1 1 0 0 1 0 0.1 0.2 1e-3\n";
    const std::string lines = "VERTICES 1 2\n1 0\nLINES 1 3\n2 0 1\n", polygons = "POLYGONS 2 9\n4 0 1 2 3\n3 0 1 4\n";
    const std::string data = "CELL_DATA 4\nSCALARS part int\nLOOKUP_TABLE default\n1 2 3 4\nPOINT_DATA 5\n"
                             "TEXTURE_COORDINATES uv 2 float\n0 0 1 0 1 1 0 1 .5 .25\n";
    const std::string file = head + points + lines + polygons + data;
    const TriangleMesh mesh = parseVtkSurface(file, "a.vtk");
    CHECK_NOTHROW(check(mesh, "a.vtk"));
    CHECK(mesh.triangles == std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 1, 4}});
    CHECK(mesh.vertices.back() == Vec3{0.1, 0.2, 1e-3}); // in double precision
    CHECK(mesh.uv.back() == std::array{0.5, 0.25});
    const std::string version5 =
        replaced(head, "3.0", "5.1") + points +
        "POLYGONS 3 7\nOFFSETS vtktypeint64\n0 4 7\nCONNECTIVITY vtktypeint64\n0 1 2 3 0 1 4\n";
    CHECK(parseVtkSurface(version5, "a.vtk").triangles == mesh.triangles);

    const auto error = [](const std::string& bytes) { return errorOf([&] { parseVtkSurface(bytes, "a.vtk"); }); };
    CHECK_THAT(error(replaced(kFile, "UNSTRUCTURED_GRID", "STRUCTURED_GRID")),
               Contains("a.vtk:4: the file must hold a DATASET POLYDATA or UNSTRUCTURED_GRID"));
    CHECK_THAT(error(head + points + lines), Contains("a.vtk: must have a POLYGONS section with polygons, found none"));
    CHECK_THAT(error(head + points + "TRIANGLE_STRIPS 1 4\n3 0 1 2\n"), Contains("must consist of POLYGONS"));
    CHECK_THAT(error(replaced(file, "3 0 1 4", "3 0 1 5")),
               Contains("a.vtk:13: polygon 1 must name points in [0, 5), got 5"));
    CHECK_THAT(error(replaced(file, "POLYGONS 2 9\n4 0 1 2 3\n3 0 1 4", "POLYGONS 1 3\n2 0 1")),
               Contains("polygon 0 must have at least 3 corners, got 2"));
    CHECK_THAT(error(replaced(file, "POINT_DATA 5", "POINT_DATA 4")),
               Contains("must have one value per point (5), got 4"));
    CHECK(parseVtkSurface(replaced(file, "3 0 1 4", "3 0 1 1"), "a.vtk").triangles.size() ==
          2); // dropped, with a warning
}

TEST_CASE("arrays of strings and bits, as PyVista writes, are passed over")
{
    const auto fields = [](const std::string& strings, const std::string& bits) {
        return "FIELD FieldData 2\n_PYVISTA_USER_DICT 1 3 string\n" + strings + "flags 2 5 bit\n" + bits + "\n";
    };
    const std::string text = fields("{%22a%22: POINTS 1}\n\nlast one\n", "0 1 0 1 1 0 1 1 0 1");
    CHECK(parseVtk(replaced(kFile, "POINTS", text + "POINTS"), "a.vtk").nodes == unitTetrahedron().nodes);
    CHECK(parseVtk(kFile + "CELL_DATA 1\nFIELD f 1\nnames 1 1 string\nliver\n", "a.vtk").labels.empty());
    CHECK_THAT(errorIn(replaced(kFile, "POINTS", "FIELD f 1\nx 1 99999 string\na\nPOINTS")),
               Contains("a.vtk:6: an array of 1 by 99999 values must fit into the rest of the file"));
    CHECK_THAT(errorIn(replaced(kFile, "POINTS", "FIELD f 1\nx 1 -1 bit\nPOINTS")), Contains("1 by -1 values must"));
    CHECK_THAT(errorIn(kFile + "CELL_DATA 1\nFIELD f 1\nnames 1 2 string\nliver\n"), Contains("ends before a value"));

    // Strings of fewer than 64 bytes, of 300 and of none have numbers of one, two and one bytes before them.
    const std::string strings = std::string("\xC2") + "ab" + "\x81\x2C" + std::string(300, 'x') + "\xC0" + "\n";
    const std::string binary = VtkWriter({true, true}).write(labelledCube(1));
    const std::string with = replaced(binary, "POINTS 8", fields(strings, "ab") + "POINTS 8");
    CHECK(parseVtk(with, "a.vtk").tetrahedra == labelledCube(1).tetrahedra);
    damage(with, "a.vtk", [](const std::string& bytes) { return parseVtk(bytes, "a.vtk"); });
}

TEST_CASE("what is wrong in a VTK file is named with its line or byte")
{
    CHECK_THAT(errorIn("solid cube"), Contains("a.vtk:1: a legacy VTK file must begin with '# vtk DataFile Version '"));
    CHECK_THAT(errorIn(replaced(kFile, "ASCII", "TEXT")), Contains("a.vtk:3: the third line must be ASCII or BINARY"));
    CHECK_THAT(errorIn(replaced(kFile, "UNSTRUCTURED_GRID", "POLYDATA")),
               Contains("a.vtk:4: the file must hold a DATASET UNSTRUCTURED_GRID"));
    CHECK_THAT(errorIn(replaced(kFile, "float", "string")),
               Contains("a.vtk:5: a type of numbers must be char to double, got 'string'"));
    CHECK_THAT(errorIn(replaced(kFile, "0 0 0 1", "0 nan 0 1")), Contains("a.vtk:6: a point's y must be finite"));
    CHECK_THAT(errorIn(replaced(kFile, "POINTS 4", "POINTS 400000000000")),
               Contains("the number of points must be in [0, "));
    CHECK_THAT(errorIn(replaced(kFile, "CELLS 1 5", "CELLS 1 4")),
               Contains("a.vtk:8: a cell's number of nodes must be in [0, 3]"));
    CHECK_THAT(errorIn(replaced(kFile, "4 0 1 2 3", "4 0 1 2 9")), Contains("a.vtk:8: tetrahedron 0 names node 9"));
    CHECK_THAT(errorIn(replaced(kFile, "4 0 1 2 3", "4 1 0 2 3")), Contains("a.vtk:8: tetrahedron 0 is inverted"));
    CHECK_THAT(errorIn(replaced(kFile, "CELL_TYPES 1\n10", "CELL_TYPES 2\n10 10")),
               Contains("CELL_TYPES must have one type per cell (1), got 2"));
    CHECK_THAT(errorIn(kHead), Contains("a.vtk: must have a POINTS section with points"));
    CHECK_THAT(errorIn(replaced(kFile, "CELL_TYPES 1\n10\n", "")), Contains("must have CELLS and CELL_TYPES"));
    CHECK_THAT(errorIn(kFile + kFile.substr(kHead.size())), Contains("second POINTS section"));
    CHECK_THAT(errorIn(kFile + "CELL_DATA 2\n"), Contains("CELL_DATA must have one value per cell (1), got 2"));
    CHECK_THAT(errorIn(kFile + "WOBBLE x\n"), Contains("a section must be one of VTK's, got 'wobble'"));
    CHECK_THAT(errorIn(kFile + "CELL_DATA 1\nVECTORS v float\n1 2\n"),
               Contains("a.vtk:14: the file ends before a value"));
    CHECK_THAT(errorIn(kFile + "FIELD f 1\nx 99999999999 99999999999 int\n"), Contains("must be in [0, "));
    TetMesh mesh = unitTetrahedron();
    mesh.labels = {1};
    std::swap(mesh.tetrahedra[0][0], mesh.tetrahedra[0][1]);
    for (const VtkForm form : {VtkForm{false, true}, VtkForm{true, true}})
        CHECK_THAT(errorIn(VtkWriter(form).write(mesh)),
                   Contains("a.vtk: byte ") && Contains("tetrahedron 1 is inverted"));
}

TEST_CASE("a VTK file may be cut off anywhere and any byte may be wrong: nothing but a mesh or an Error comes out")
{
    for (const VtkForm form : kForms)
        damage(VtkWriter(form).write(labelledCube(1)), "a.vtk",
               [](const std::string& bytes) { return parseVtk(bytes, "a.vtk"); });
}

} // namespace vtk_reader_test
