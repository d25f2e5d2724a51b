#include "meshes.h"

#include "arrays.h"
#include "convert.h"

#include "filasofia/core/hash.h"
#include "filasofia/core/log.h"
#include "filasofia/geometry/mesh_file.h"
#include "filasofia/geometry/mesh_pieces.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/runtime/assets.h"

#include <nanobind/stl/array.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

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

std::vector<geometry::MeshLabel> readLabelNames(nb::handle given)
{
    if (given.is_none()) return {};
    constexpr const char* kPlace = "TetMesh: label_names";
    if (!PyDict_Check(given.ptr())) failType({.name = kPlace}, "must be a dict of numbers by name", given);
    std::vector<geometry::MeshLabel> out;
    for (const auto& [name, label] : nb::borrow<nb::dict>(given)) {
        const std::string word = readArgument<std::string>(name, kPlace, "name");
        out.push_back({.label = readArgument<int>(label, kPlace, word), .name = word});
    }
    return out;
}

Tetrahedra makeTetMesh(nb::handle nodes, nb::handle tetrahedra, nb::handle labels, nb::handle names)
{
    TetMesh mesh;
    mesh.nodes = readRows<Vec3, double, 3>(nodes, "TetMesh: nodes");
    mesh.tetrahedra = readRows<geometry::Tetrahedron, int, 4>(tetrahedra, "TetMesh: tetrahedra");
    if (!labels.is_none()) mesh.labels = readRows<int, int, 1>(labels, "TetMesh: labels");
    mesh.labelNames = readLabelNames(names);
    if (const std::size_t dropped = geometry::dropUnusedNodes(mesh); dropped > 0)
        logInfo("TetMesh: ", dropped, " nodes that no tetrahedron uses were dropped");
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

auto partsOf(const TetMesh& mesh) { return std::tie(mesh.nodes, mesh.tetrahedra, mesh.labels, mesh.labelNames); }
auto partsOf(const TriangleMesh& mesh) { return std::tie(mesh.vertices, mesh.triangles, mesh.uv); }

/// Only the indices: equal meshes have equal ones, while 0.0 and -0.0 are equal numbers of different bits.
std::size_t hashOf(const std::vector<Vec3>& points, std::span<const int> indices)
{
    Hasher hasher;
    hasher.add(static_cast<std::uint64_t>(points.size()));
    hasher.addAll(indices);
    return hasher.value();
}
std::size_t hashOf(const TetMesh& mesh)
{
    return hashOf(mesh.nodes, {mesh.tetrahedra.front().data(), 4 * mesh.tetrahedra.size()});
}
std::size_t hashOf(const TriangleMesh& mesh)
{
    return hashOf(mesh.vertices, {mesh.triangles.front().data(), 3 * mesh.triangles.size()});
}

nb::dict labelNamesOf(const TetMesh& mesh)
{
    nb::dict names;
    for (const geometry::MeshLabel& each : mesh.labelNames) names[Convert<std::string>::make(each.name)] = each.label;
    return names;
}

/// What __init__ takes: pickle makes the mesh anew of it, checked like any other.
nb::tuple argumentsOf(nb::handle self, const TetMesh& mesh)
{
    return nb::make_tuple(self.attr("nodes"), self.attr("tetrahedra"), self.attr("labels"), labelNamesOf(mesh));
}
nb::tuple argumentsOf(nb::handle self, const TriangleMesh&)
{
    return nb::make_tuple(self.attr("vertices"), self.attr("triangles"), self.attr("uv"));
}

template <class Mesh> void sameForAll(nb::class_<SharedMesh<Mesh>>& bound)
{
    using Shared = SharedMesh<Mesh>;
    // Nobody changes a mesh: a copy of it is itself.
    bound.def("__copy__", [](nb::handle self) { return nb::borrow(self); });
    bound.def("__deepcopy__", [](nb::handle self, nb::handle) { return nb::borrow(self); });
    bound.def("__reduce__", [](nb::handle self) {
        return nb::make_tuple(self.type(), argumentsOf(self, *nb::cast<const Shared&>(self).mesh));
    });
    bound.def(
        "__eq__",
        [](const Shared& a, const Shared& b) { return a.mesh == b.mesh || partsOf(*a.mesh) == partsOf(*b.mesh); },
        nb::is_operator(), nb::sig("def __eq__(self, other: object, /) -> bool"));
    bound.def("__hash__", [](const Shared& self) { return hashOf(*self.mesh); });
}

void addParts(nb::class_<Tetrahedra>& tetrahedra)
{
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
        "label_names", [](const Tetrahedra& self) { return labelNamesOf(*self.mesh); },
        nb::for_getter(nb::sig("def label_names(self) -> dict[str, int]")));
}

void bindTetMesh(nb::module_& module)
{
    nb::class_<Tetrahedra> tetrahedra(module, kMeshName<TetMesh>,
                                      "A volume mesh of tetrahedra, checked and then never changed.");
    tetrahedra.def(
        "__init__",
        [](Tetrahedra* self, nb::handle nodes, nb::handle elements, nb::handle labels, nb::handle names) {
            new (self) Tetrahedra(makeTetMesh(nodes, elements, labels, names));
        },
        nb::arg("nodes").none(), nb::arg("tetrahedra").none(), nb::arg("labels") = nb::none(),
        nb::arg("label_names") = nb::none(),
        nb::sig("def __init__(self, nodes: numpy.typing.ArrayLike, tetrahedra: numpy.typing.ArrayLike, labels: "
                "numpy.typing.ArrayLike | None = None, label_names: dict[str, int] | None = None) -> None"),
        "nodes (n, 3) [m]; tetrahedra (m, 4), indices of nodes, each of positive volume; labels (m,), whole numbers; "
        "label_names, the names of some of them.");
    addParts(tetrahedra);
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
        "vertices (n, 3) [m]; triangles (m, 3), counter-clockwise seen from outside; uv (n, 2), or (3 m, 2) for the "
        "corners of the triangles if the texture has seams.");
    triangles.def_prop_ro(
        "vertices", [](nb::handle self) { return rowsOf<double, 3>(nb::cast<Triangles&>(self).mesh->vertices, self); },
        nb::for_getter(nb::sig("def vertices(self) -> numpy.typing.NDArray[numpy.float64]")), "(n, 3) [m], a view");
    triangles.def_prop_ro(
        "triangles", [](nb::handle self) { return rowsOf<int, 3>(nb::cast<Triangles&>(self).mesh->triangles, self); },
        nb::for_getter(nb::sig("def triangles(self) -> numpy.typing.NDArray[numpy.int32]")),
        "(m, 3) indices of vertices, a view");
    triangles.def_prop_ro(
        "uv", [](nb::handle self) { return rowsOf<double, 2>(nb::cast<Triangles&>(self).mesh->uv, self); },
        nb::for_getter(nb::sig("def uv(self) -> numpy.typing.NDArray[numpy.float64]")),
        "(n, 2), (3 m, 2) for the corners of triangles, or empty, a view");
    triangles.def("__repr__", [](const Triangles& self) {
        return text("TriangleMesh(", self.mesh->vertices.size(), " vertices, ", self.mesh->triangles.size(),
                    " triangles)");
    });
    sameForAll(triangles);
}

void bindClosedShapes(nb::module_& module)
{
    module.def(
        "box",
        [](nb::handle size, std::array<int, 3> cells) {
            return Triangles{geometry::shapes::box(readArgument<Vec3>(size, "box", "size"), cells)};
        },
        nb::arg("size").none(), nb::arg("cells") = std::array<int, 3>{1, 1, 1},
        nb::sig("def box(size: collections.abc.Sequence[float], cells: collections.abc.Sequence[int] = (1, 1, 1)) -> "
                "TriangleMesh"),
        "The surface of a box of edges `size` [m].");
    module.def(
        "sphere", [](double radius, int quarter) { return Triangles{geometry::shapes::sphere(radius, quarter)}; },
        nb::arg("radius"), nb::arg("quarter") = 8, "A sphere; `quarter` edges along a quarter of a great circle.");
    module.def(
        "ellipsoid",
        [](nb::handle halfAxes, int quarter) {
            return Triangles{
                geometry::shapes::ellipsoid(readArgument<Vec3>(halfAxes, "ellipsoid", "half_axes"), quarter)};
        },
        nb::arg("half_axes").none(), nb::arg("quarter") = 8,
        nb::sig("def ellipsoid(half_axes: collections.abc.Sequence[float], quarter: int = 8) -> TriangleMesh"),
        "An ellipsoid of these half axes [m] along x, y and z; `quarter` as for the sphere.");
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
        "tube",
        [](nb::handle points, double radius, int sides, bool sharp) {
            return Triangles{geometry::shapes::tube(readArgument<std::vector<Vec3>>(points, "tube", "points"), radius,
                                                    sides, sharp)};
        },
        nb::arg("points").none(), nb::arg("radius"), nb::arg("sides") = 8, nb::arg("sharp") = false,
        nb::sig("def tube(points: collections.abc.Sequence[collections.abc.Sequence[float]], radius: float, "
                "sides: int = 8, sharp: bool = False) -> TriangleMesh"),
        "A round tube of `radius` [m] along a line through `points` [m]; with `sharp`, its first end is a point. It is "
        "closed: both ends have flat caps.");
    module.def(
        "revolved",
        [](nb::handle corners, int sides) {
            return Triangles{
                geometry::shapes::revolved(readArgument<std::vector<Vec3>>(corners, "revolved", "corners"), sides)};
        },
        nb::arg("corners").none(), nb::arg("sides") = 24,
        nb::sig("def revolved(corners: collections.abc.Sequence[collections.abc.Sequence[float]], sides: int = 24) -> "
                "TriangleMesh"),
        "What a closed outline, corners [m] of the plane z = 0 with x >= 0, counter-clockwise, makes as it turns about "
        "y: rings, pipes, caps.");
    module.def(
        "arc",
        [](double radius, double from, double to, int edges) {
            nb::list points;
            for (const Vec3& p : geometry::shapes::arc(radius, from, to, edges))
                points.append(nb::make_tuple(p.x, p.y, p.z));
            return points;
        },
        nb::arg("radius"), nb::arg("start"), nb::arg("end"), nb::arg("edges") = 16,
        nb::sig("def arc(radius: float, start: float, end: float, edges: int = 16) -> "
                "list[tuple[float, float, float]]"),
        "Points [m] on a circle of `radius` [m] about the z axis, from one angle [rad] to another: the line of a "
        "curved "
        "needle.");
}

void bindFlatAndSolidShapes(nb::module_& module)
{
    module.def(
        "sheet",
        [](double width, double depth, std::array<int, 2> cells, bool printed) {
            return Triangles{geometry::shapes::sheet(width, depth, cells, printed)};
        },
        nb::arg("width"), nb::arg("depth"), nb::arg("cells") = std::array<int, 2>{10, 10}, nb::arg("printed") = false,
        nb::sig("def sheet(width: float, depth: float, cells: collections.abc.Sequence[int] = (10, 10), "
                "printed: bool = False) -> TriangleMesh"),
        "A flat sheet along x and z that faces up, two triangles per cell. A `printed` one has texture coordinates: a "
        "picture lies on it once, its lower edge at +z.");
    module.def(
        "block",
        [](nb::handle size, std::array<int, 3> cells) {
            return Tetrahedra{geometry::shapes::block(readArgument<Vec3>(size, "block", "size"), cells)};
        },
        nb::arg("size").none(), nb::arg("cells") = std::array<int, 3>{4, 4, 4},
        nb::sig("def block(size: collections.abc.Sequence[float], cells: collections.abc.Sequence[int] = (4, 4, 4)) -> "
                "TetMesh"),
        "A solid box of tetrahedra, six per cell.");
    module.def(
        "bladder",
        [](nb::handle halfAxes, double wall, std::array<int, 2> cells) {
            return Tetrahedra{
                geometry::shapes::bladder(readArgument<Vec3>(halfAxes, "bladder", "half_axes"), wall, cells)};
        },
        nb::arg("half_axes").none(), nb::arg("wall"), nb::arg("cells") = std::array<int, 2>{8, 2},
        nb::sig("def bladder(half_axes: collections.abc.Sequence[float], wall: float, "
                "cells: collections.abc.Sequence[int] = (8, 2)) -> TetMesh"),
        "A closed hollow ellipsoid of tetrahedra: `half_axes` [m] of the space inside, around that its `wall` [m]; "
        "`cells` along a quarter of a circle and through its wall.");
    module.def(
        "vessel",
        [](nb::handle points, double radius, double wall, std::array<int, 2> cells) {
            return Tetrahedra{geometry::shapes::vessel(readArgument<std::vector<Vec3>>(points, "vessel", "points"),
                                                       radius, wall, cells)};
        },
        nb::arg("points").none(), nb::arg("radius"), nb::arg("wall"), nb::arg("cells") = std::array<int, 2>{12, 2},
        nb::sig("def vessel(points: collections.abc.Sequence[collections.abc.Sequence[float]], radius: float, "
                "wall: float, cells: collections.abc.Sequence[int] = (12, 2)) -> TetMesh"),
        "A hollow vessel of tetrahedra along a line through `points` [m]: inside its `radius`, around that its `wall` "
        "[m]; `cells` around it and through its wall. Along it there is one cell per edge of the line: of two points "
        "far apart these are slivers, so give points about as far apart as the cells around it are long.");
}

void bindFiles(nb::module_& module)
{
    module.def(
        "load_tet_mesh",
        [](nb::handle file, double scale, bool join, const std::string& labels) {
            const auto name = readArgument<std::string>(file, "load_tet_mesh", "file");
            TetMesh mesh = geometry::loadTetMesh(name, scale, labels);
            if (join) mesh = geometry::withJoinedNodes(mesh, name);
            return Tetrahedra{std::make_shared<const TetMesh>(std::move(mesh))};
        },
        nb::arg("file").none(), nb::arg("scale") = 1.0, nb::arg("join") = false, nb::arg("labels") = "",
        nb::sig("def load_tet_mesh(file: str | os.PathLike[str], scale: float = 1.0, join: bool = False, labels: str "
                "= '') -> TetMesh"),
        "Reads a .msh, .mesh, .vtk, .vtu or .node/.ele file; `scale` [m] is the length of one unit of it. With `join`, "
        "nodes "
        "that lie on each other become one. `labels` names the list of whole numbers per cell of a VTK file that "
        "become the labels; without it, the first one that does not number the cells.");
    module.def(
        "load_triangle_mesh",
        [](nb::handle file, double scale) {
            return Triangles{std::make_shared<const TriangleMesh>(
                geometry::loadTriangleMesh(readArgument<std::string>(file, "load_triangle_mesh", "file"), scale))};
        },
        nb::arg("file").none(), nb::arg("scale") = 1.0,
        nb::sig("def load_triangle_mesh(file: str | os.PathLike[str], scale: float = 1.0) -> TriangleMesh"),
        "Reads an OBJ, STL, PLY, glTF, OFF, VTK (.vtk, .vtp, .vtu) or Medit (.mesh) file; `scale` [m] is the length of "
        "one "
        "unit of it.");
    module.def(
        "asset", [](const std::string& name, const std::string& installed) { return runtime::asset(name, installed); },
        nb::arg("name"), nb::arg("installed"));
}

} // namespace

void bindMeshes(nb::module_& module)
{
    bindTetMesh(module);
    bindTriangleMesh(module);
    bindClosedShapes(module);
    bindFlatAndSolidShapes(module);
    bindFiles(module);
}

} // namespace filasofia::python
