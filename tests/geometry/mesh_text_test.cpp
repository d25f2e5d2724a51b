#include "filasofia/geometry/mesh_text.h"

#include "filasofia/geometry/gmsh_reader.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/geometry/texture_seams.h"
#include "filasofia/geometry/vtk_reader.h"
#include "geometry/sample_meshes.h"

#include <numbers>

namespace mesh_text_test {

using namespace filasofia;
using namespace filasofia::geometry;

TEST_CASE("tetrahedra written as Gmsh's text come back bit for bit, with labels and their names")
{
    TetMesh mesh = labelledCube(3);
    for (Vec3& each : mesh.nodes) each = std::numbers::pi / 7.0 * each + Vec3{1e-300, -0.0, 1.0 / 3.0};
    mesh.labelNames = {{mesh.labels.front(), "left kidney"}};
    const TetMesh read = parseGmsh(gmshText(mesh), "a.msh");
    CHECK(read.nodes == mesh.nodes);
    CHECK(read.tetrahedra == mesh.tetrahedra);
    CHECK(read.labels == mesh.labels);
    CHECK(read.labelNames == mesh.labelNames);
    mesh.labels.clear(), mesh.labelNames.clear();
    CHECK(parseGmsh(gmshText(mesh), "a.msh").labels.empty());
}

TEST_CASE("triangles written as VTK's text come back bit for bit, with texture coordinates")
{
    TriangleMesh mesh = *shapes::sphere(1.0 / 3.0);
    for (const Vec3 each : mesh.vertices) mesh.uv.push_back({each.x / 7.0, each.y});
    for (const bool textured : {true, false}) {
        if (!textured) mesh.uv.clear();
        const TriangleMesh read = parseVtkSurface(vtkText(mesh), "a.vtk");
        CHECK(read.vertices == mesh.vertices);
        CHECK(read.triangles == mesh.triangles);
        CHECK(read.uv == mesh.uv);
    }
    for (std::size_t i = 0; i < 3 * mesh.triangles.size(); ++i) mesh.uv.push_back({1.0 / (3.0 + double(i)), double(i)});
    REQUIRE(perCorner(mesh));
    CHECK(parseVtkSurface(vtkText(mesh), "a.vtk").uv == mesh.uv);
    CHECK_THAT(errorOf([&] {
                   parseVtkSurface(vtkText(mesh) + "FIELD x 1\nuv_of_corners 6 1 double\n1 2 3 4 5 6\n", "a.vtk");
               }),
               Catch::Matchers::Contains("a.vtk: texture coordinates of corners must be one pair for each corner of "
                                         "triangles (") &&
                   Catch::Matchers::EndsWith("), got 3"));
}

} // namespace mesh_text_test
