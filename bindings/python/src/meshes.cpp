#include "meshes.h"

#include "arrays.h"
#include "scalars.h"

#include "filasofia/core/error.h"
#include "filasofia/geometry/mesh_file.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/runtime/assets.h"

#include <nanobind/stl/array.h>

namespace filasofia::python {
namespace {

using geometry::TetMesh;
using geometry::TriangleMesh;
using Tetrahedra = SharedMesh<TetMesh>;
using Triangles = SharedMesh<TriangleMesh>;

template <class Mesh> SharedMesh<Mesh> shared(Mesh mesh, const char* name)
{
    check(mesh, name);
    return {std::make_shared<const Mesh>(std::move(mesh))};
}

Tetrahedra makeTetMesh(nb::handle nodes, nb::handle tetrahedra, nb::handle labels)
{
    TetMesh mesh;
    mesh.nodes = readRows<Vec3, double, 3>(nodes, "TetMesh: nodes");
    mesh.tetrahedra = readRows<geometry::Tetrahedron, int, 4>(tetrahedra, "TetMesh: tetrahedra");
    if (!labels.is_none()) mesh.labels = readRows<int, int, 1>(labels, "TetMesh: labels");
    return shared(std::move(mesh), "TetMesh");
}

Triangles makeTriangleMesh(nb::handle vertices, nb::handle triangles, nb::handle uv)
{
    TriangleMesh mesh;
    mesh.vertices = readRows<Vec3, double, 3>(vertices, "TriangleMesh: vertices");
    mesh.triangles = readRows<geometry::Triangle, int, 3>(triangles, "TriangleMesh: triangles");
    if (!uv.is_none()) mesh.uv = readRows<std::array<double, 2>, double, 2>(uv, "TriangleMesh: uv");
    return shared(std::move(mesh), "TriangleMesh");
}

Vec3 sizeOf(nb::handle value, const char* function)
{
    const Where object{.name = function};
    double v[3] = {};
    readNumbers(value, {.outer = &object, .name = "size"}, "must be 3 numbers", v, 3);
    return {v[0], v[1], v[2]};
}

std::string fileOf(nb::handle value, const char* function)
{
    const Where object{.name = function};
    return readText(value, {.outer = &object, .name = "file"});
}

template <class Bound> void sameForAll(Bound& bound)
{
    // Nobody changes a mesh: a copy of it is itself.
    bound.def("__copy__", [](nb::handle self) { return nb::borrow(self); });
    bound.def("__deepcopy__", [](nb::handle self, nb::handle) { return nb::borrow(self); });
}

void bindTetMesh(nb::module_& module)
{
    nb::class_<Tetrahedra> tetrahedra(module, kMeshName<TetMesh>,
                                      "A volume mesh of tetrahedra, checked and then never changed.");
    tetrahedra.def(
        "__init__",
        [](Tetrahedra* self, nb::handle nodes, nb::handle elements, nb::handle labels) {
            new (self) Tetrahedra(makeTetMesh(nodes, elements, labels));
        },
        nb::arg("nodes").none(), nb::arg("tetrahedra").none(), nb::arg("labels") = nb::none(),
        nb::sig("def __init__(self, nodes: numpy.typing.ArrayLike, tetrahedra: numpy.typing.ArrayLike, labels: "
                "numpy.typing.ArrayLike | None = None) -> None"),
        "nodes (n, 3) [m]; tetrahedra (m, 4), indices of nodes, each of positive volume; labels (m,), whole numbers.");
    tetrahedra.def_prop_ro(
        "nodes", [](nb::handle self) { return rowsOf<double, 3>(nb::cast<Tetrahedra&>(self).mesh->nodes, self); },
        nb::for_getter(nb::sig("def nodes(self) -> numpy.typing.NDArray[numpy.float64]")), "(n, 3) [m], a view");
    tetrahedra.def_prop_ro(
        "tetrahedra",
        [](nb::handle self) { return rowsOf<int, 4>(nb::cast<Tetrahedra&>(self).mesh->tetrahedra, self); },
        nb::for_getter(nb::sig("def tetrahedra(self) -> numpy.typing.NDArray[numpy.int32]")),
        "(m, 4) indices of nodes, a view");
    tetrahedra.def_prop_ro(
        "labels", [](nb::handle self) { return rowsOf<int, 1>(nb::cast<Tetrahedra&>(self).mesh->labels, self); },
        nb::for_getter(nb::sig("def labels(self) -> numpy.typing.NDArray[numpy.int32]")), "(m,) or empty, a view");
    tetrahedra.def_prop_ro(
        "label_names",
        [](const Tetrahedra& self) {
            nb::dict names;
            for (const geometry::MeshLabel& each : self.mesh->labelNames)
                names[nb::str(each.name.c_str())] = each.label;
            return names;
        },
        nb::for_getter(nb::sig("def label_names(self) -> dict[str, int]")));
    tetrahedra.def("__repr__", [](const Tetrahedra& self) {
        return text("TetMesh(", self.mesh->nodes.size(), " nodes, ", self.mesh->tetrahedra.size(), " tetrahedra)");
    });
    sameForAll(tetrahedra);
}

void bindTriangleMesh(nb::module_& module)
{
    nb::class_<Triangles> triangles(module, kMeshName<TriangleMesh>,
                                    "A surface mesh of triangles, checked and then never changed.");
    triangles.def(
        "__init__",
        [](Triangles* self, nb::handle vertices, nb::handle faces, nb::handle uv) {
            new (self) Triangles(makeTriangleMesh(vertices, faces, uv));
        },
        nb::arg("vertices").none(), nb::arg("triangles").none(), nb::arg("uv") = nb::none(),
        nb::sig("def __init__(self, vertices: numpy.typing.ArrayLike, triangles: numpy.typing.ArrayLike, uv: "
                "numpy.typing.ArrayLike | None = None) -> None"),
        "vertices (n, 3) [m]; triangles (m, 3), counter-clockwise seen from outside; uv (n, 2).");
    triangles.def_prop_ro(
        "vertices", [](nb::handle self) { return rowsOf<double, 3>(nb::cast<Triangles&>(self).mesh->vertices, self); },
        nb::for_getter(nb::sig("def vertices(self) -> numpy.typing.NDArray[numpy.float64]")), "(n, 3) [m], a view");
    triangles.def_prop_ro(
        "triangles", [](nb::handle self) { return rowsOf<int, 3>(nb::cast<Triangles&>(self).mesh->triangles, self); },
        nb::for_getter(nb::sig("def triangles(self) -> numpy.typing.NDArray[numpy.int32]")),
        "(m, 3) indices of vertices, a view");
    triangles.def_prop_ro(
        "uv", [](nb::handle self) { return rowsOf<double, 2>(nb::cast<Triangles&>(self).mesh->uv, self); },
        nb::for_getter(nb::sig("def uv(self) -> numpy.typing.NDArray[numpy.float64]")), "(n, 2) or empty, a view");
    triangles.def("__repr__", [](const Triangles& self) {
        return text("TriangleMesh(", self.mesh->vertices.size(), " vertices, ", self.mesh->triangles.size(),
                    " triangles)");
    });
    sameForAll(triangles);
}

void bindShapes(nb::module_& module)
{
    module.def(
        "box",
        [](nb::handle size, std::array<int, 3> cells) {
            return Triangles{geometry::shapes::box(sizeOf(size, "box"), cells)};
        },
        nb::arg("size").none(), nb::arg("cells") = std::array<int, 3>{1, 1, 1},
        nb::sig("def box(size: collections.abc.Sequence[float], cells: collections.abc.Sequence[int] = (1, 1, 1)) -> "
                "TriangleMesh"),
        "The surface of a box of edges `size` [m].");
    module.def(
        "sphere", [](double radius, int quarter) { return Triangles{geometry::shapes::sphere(radius, quarter)}; },
        nb::arg("radius"), nb::arg("quarter") = 8, "A sphere; `quarter` edges along a quarter of a great circle.");
    module.def(
        "capsule",
        [](double radius, double length, int quarter) {
            return Triangles{geometry::shapes::capsule(radius, length, quarter)};
        },
        nb::arg("radius"), nb::arg("length"), nb::arg("quarter") = 8,
        "Half spheres around the ends of a line along y.");
    module.def(
        "cylinder",
        [](double radius, double length, int quarter) {
            return Triangles{geometry::shapes::cylinder(radius, length, quarter)};
        },
        nb::arg("radius"), nb::arg("length"), nb::arg("quarter") = 8, "A cylinder along y.");
    module.def(
        "sheet",
        [](double width, double depth, std::array<int, 2> cells) {
            return Triangles{geometry::shapes::sheet(width, depth, cells)};
        },
        nb::arg("width"), nb::arg("depth"), nb::arg("cells") = std::array<int, 2>{10, 10},
        nb::sig("def sheet(width: float, depth: float, cells: collections.abc.Sequence[int] = (10, 10)) -> "
                "TriangleMesh"),
        "A flat sheet along x and z that faces up, two triangles per cell.");
    module.def(
        "block",
        [](nb::handle size, std::array<int, 3> cells) {
            return Tetrahedra{geometry::shapes::block(sizeOf(size, "block"), cells)};
        },
        nb::arg("size").none(), nb::arg("cells") = std::array<int, 3>{4, 4, 4},
        nb::sig("def block(size: collections.abc.Sequence[float], cells: collections.abc.Sequence[int] = (4, 4, 4)) -> "
                "TetMesh"),
        "A solid box of tetrahedra, six per cell.");
}

void bindFiles(nb::module_& module)
{
    module.def(
        "load_tet_mesh",
        [](nb::handle file, double scale) {
            return Tetrahedra{
                std::make_shared<const TetMesh>(geometry::loadTetMesh(fileOf(file, "load_tet_mesh"), scale))};
        },
        nb::arg("file").none(), nb::arg("scale") = 1.0,
        nb::sig("def load_tet_mesh(file: str | os.PathLike[str], scale: float = 1.0) -> TetMesh"),
        "Reads a .msh, .vtk, .vtu or .node/.ele file; `scale` [m] is the length of one unit of it.");
    module.def(
        "load_triangle_mesh",
        [](nb::handle file, double scale) {
            return Triangles{std::make_shared<const TriangleMesh>(
                geometry::loadTriangleMesh(fileOf(file, "load_triangle_mesh"), scale))};
        },
        nb::arg("file").none(), nb::arg("scale") = 1.0,
        nb::sig("def load_triangle_mesh(file: str | os.PathLike[str], scale: float = 1.0) -> TriangleMesh"),
        "Reads an OBJ, STL, PLY or glTF file; `scale` [m] is the length of one unit of it.");
    module.def(
        "asset", [](const std::string& name, const std::string& installed) { return runtime::asset(name, installed); },
        nb::arg("name"), nb::arg("installed"));
}

} // namespace

void bindMeshes(nb::module_& module)
{
    bindTetMesh(module);
    bindTriangleMesh(module);
    bindShapes(module);
    bindFiles(module);
}

} // namespace filasofia::python
