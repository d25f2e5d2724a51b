#include "filasofia/geometry/mesh_file.h"
#include "filasofia/geometry/off_reader.h"
#include "filasofia/geometry/vtk_reader.h"
#include "filasofia/geometry/vtu_reader.h"
#include "geometry/sample_meshes.h"

namespace surface_file_test {

using namespace filasofia;
using namespace filasofia::geometry;
using Catch::Matchers::Contains;

namespace {

/// The square and the triangle that all files below hold.
const std::vector<Triangle> kTriangles{{0, 1, 2}, {0, 2, 3}, {0, 1, 4}};
constexpr Vec3 kTip{0.1, 0.2, 1e-3}; // no number of single precision

const std::string kOff = "# made by hand\nOFF\n5 2 0\n0 0 0\n1 0 0 255 0 0 # red\n1 1 0\n0 1 0\n.1 .2 1e-3\n"
                         "4 0 1 2 3 0.5 0.5 0.5\n3 0 1 4\n";

/// An unstructured grid: a line, a pixel, a triangle and a tetrahedron, which has a point of its own.
const std::string kGrid =
    "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 6 double\n0 0 0 1 0 0 1 1 0 0 1 0\n"
    ".1 .2 1e-3 0 0 9\nCELLS 4 17\n2 0 1\n4 0 1 3 2\n3 0 1 4\n4 0 1 2 5\nCELL_TYPES 4\n3\n8\n5\n10\n"
    "CELL_DATA 4\nSCALARS part int\nLOOKUP_TABLE default\n1 2 3 4\n";

const std::string kPolyData =
    "<VTKFile type=\"PolyData\">\n<PolyData>\n<Piece NumberOfPoints=\"5\" NumberOfPolys=\"2\" NumberOfStrips=\"0\">\n"
    "<PointData TCoords=\"uv\"><DataArray type=\"Float32\" Name=\"uv\" NumberOfComponents=\"2\" format=\"ascii\">\n"
    "0 0 1 0 1 1 0 1 .5 .25</DataArray></PointData>\n<Points><DataArray type=\"Float64\">\n"
    "0 0 0 1 0 0 1 1 0 0 1 0 .1 .2 1e-3</DataArray></Points>\n"
    "<Polys><DataArray type=\"Int32\" Name=\"connectivity\">\n0 1 2 3 0 1 4</DataArray>\n"
    "<DataArray type=\"Int32\" Name=\"offsets\">4 7</DataArray></Polys>\n</Piece></PolyData></VTKFile>\n";

const std::string kXmlGrid =
    "<VTKFile type=\"UnstructuredGrid\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"5\" NumberOfCells=\"2\">\n"
    "<Points><DataArray type=\"Float64\">0 0 0 1 0 0 1 1 0 0 1 0 .1 .2 1e-3</DataArray></Points>\n"
    "<Cells><DataArray type=\"Int32\" Name=\"connectivity\">0 1 2 3 0 1 4</DataArray>\n"
    "<DataArray type=\"Int32\" Name=\"offsets\">4 7</DataArray>\n"
    "<DataArray type=\"UInt8\" Name=\"types\">9 5</DataArray></Cells>\n</Piece></UnstructuredGrid></VTKFile>\n";

std::string errorIn(const std::string& name, const std::string& bytes)
{
    const TemporaryFile file(name, bytes);
    return errorOf([&] { loadTriangleMesh(file.path()); });
}

} // namespace

TEST_CASE("surfaces of OFF and of VTK's grids and XML polydata keep their points")
{
    const LogTrap log;
    for (const auto& [name, bytes] :
         {std::pair{"a.off", kOff}, {"a.vtk", kGrid}, {"a.vtp", kPolyData}, {"a.vtu", kXmlGrid}}) {
        const TemporaryFile file(name, bytes);
        const TriangleMesh mesh = loadTriangleMesh(file.path());
        INFO(name);
        CHECK_NOTHROW(check(mesh, name));
        CHECK(mesh.triangles == kTriangles);
        CHECK(mesh.vertices.size() == 5);
        CHECK(mesh.vertices.back() == kTip); // in double precision
    }
    CHECK_THAT(log.lines, Contains("a.vtk: 1 solids were left out: only polygons make a surface\n"));
    CHECK_THAT(log.lines, Contains("a.vtk: 1 points that no triangle uses were dropped\n"));
    CHECK(parseVtuSurface(kPolyData, "a.vtp").uv.back() == std::array{0.5, 0.25});
}

TEST_CASE("polygons of second order are read with their corners, and a warning counts them")
{
    const LogTrap log;
    const std::string file = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 6 double\n"
                             "0 0 0 1 0 0 0 1 0 .5 0 0 .5 .5 0 0 .5 0\nCELLS 1 7\n6 0 1 2 3 4 5\nCELL_TYPES 1\n22\n";
    const TriangleMesh mesh = parseVtkSurface(file, "a.vtk");
    CHECK(mesh.triangles == std::vector<Triangle>{{0, 1, 2}});
    CHECK(mesh.vertices.size() == 3);
    CHECK_THAT(log.lines, Contains("a.vtk: 1 polygons of second order were read with their corners only"));
}

TEST_CASE("what is wrong in an OFF file is named with its line")
{
    CHECK(errorOf([] { parseOff("OFX\n", "a.off"); }) ==
          "a.off:1: an OFF file must begin with OFF, COFF, NOFF, STOFF or several of these, got 'OFX'");
    CHECK(parseOff(replaced(kOff, "OFF", "STCNOFF"), "a.off").triangles == kTriangles);
    CHECK_THAT(errorIn("a.off", replaced(kOff, "OFF", "4OFF")), Contains("a.off:2: an OFF file must begin with OFF"));
    CHECK_THAT(errorIn("a.off", replaced(kOff, "OFF", "nOFF")), Contains("a.off:2: an OFF file must begin with OFF"));
    CHECK_THAT(errorIn("a.off", replaced(kOff, "OFF", "OFF BINARY")), Contains("an OFF file must be text"));
    CHECK_THAT(errorIn("a.off", replaced(kOff, "5 2 0", "500 2 0")),
               Contains("a.off:3: the number of vertices must be in [0, "));
    CHECK_THAT(errorIn("a.off", replaced(kOff, "1 1 0", "1 nan 0")), Contains("a.off:6: a vertex's y must be finite"));
    CHECK_THAT(errorIn("a.off", replaced(kOff, "3 0 1 4", "3 0 1 5")),
               Contains("a.off:10: polygon 1 must name points in [0, 5), got 5"));
    CHECK_THAT(errorIn("a.off", replaced(kOff, "3 0 1 4", "2 0 1")), Contains("must have at least 3 corners, got 2"));
    CHECK_THAT(errorIn("a.off", replaced(kOff, "3 0 1 4\n", "")), Contains("the file ends before a face's number"));
    CHECK_THAT(errorIn("a.off", "OFF\n1 0 0\n0 0 0\n"), Contains("a.off: must have at least 1 triangle, got 0"));
}

TEST_CASE("what is wrong in a surface of VTK is named with its line")
{
    CHECK_THAT(errorIn("a.vtk", replaced(kGrid, "3\n8\n5", "3\n8\n6")),
               Contains("a.vtk:11: cell 2 must be a triangle, quad, pixel or polygon (type 5, 9, 8 or 7), got VTK's "
                        "type 6 with 3 nodes"));
    CHECK_THAT(errorIn("a.vtk", replaced(kGrid, "3\n8\n5", "10\n10\n10")),
               Contains("a.vtk: must have at least 1 triangle, got 0; it has 4 solids, which make a tetrahedral mesh"));
    CHECK_THAT(errorIn("a.vtp", replaced(kPolyData, "Strips=\"0\"", "Strips=\"1\"")),
               Contains("a.vtp:3: a surface must consist of Polys, got Strips"));
    CHECK_THAT(errorIn("a.vtp", replaced(kPolyData, "0 1 4<", "0 1 5<")),
               Contains("a.vtp:8: polygon 1 must name points in [0, 5), got 5"));
    CHECK_THAT(errorIn("a.vtp", replaced(kPolyData, ".5 .25", ".5")),
               Contains("a.vtp:4: texture coordinates must be 2 numbers per point (10), got 9"));
    CHECK_THAT(errorIn("a.vtp", replaced(kPolyData, "=\"PolyData\"", "=\"ImageData\"")),
               Contains("a.vtp:1: a surface must be a VTKFile of the type PolyData or UnstructuredGrid"));
}

TEST_CASE("a surface file may be cut off anywhere and any byte may be wrong")
{
    const LogTrap log;
    damage(kOff, "a.off", [](const std::string& bytes) { return parseOff(bytes, "a.off"); });
    damage(kGrid, "a.vtk", [](const std::string& bytes) { return parseVtkSurface(bytes, "a.vtk"); });
    for (const std::string& file : {kPolyData, kXmlGrid})
        damage(file, "a.vtu", [](const std::string& bytes) { return parseVtuSurface(bytes, "a.vtu"); });
}

} // namespace surface_file_test
