#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/geometry/mesh_file.h"
#include "filasofia/geometry/mesh_pieces.h"
#include "filasofia/geometry/shapes.h"

#include <array>
#include <memory>
#include <string>
#include <variant>
#include <vector>

/// The functions that make meshes (geometry/shapes.h, geometry/mesh_file.h) as objects of a scene file, each named
/// after its function.
namespace filasofia::scene {

using TrianglePtr = std::shared_ptr<const geometry::TriangleMesh>;
using TetPtr = std::shared_ptr<const geometry::TetMesh>;

struct BoxShape {
    Vec3 size = {};
    std::array<int, 3> cells = {1, 1, 1};
    [[nodiscard]] TrianglePtr make() const { return geometry::shapes::box(size, cells); }
};
struct SphereShape {
    double radius = 0.0;
    int quarter = 8;
    [[nodiscard]] TrianglePtr make() const { return geometry::shapes::sphere(radius, quarter); }
};
struct EllipsoidShape {
    Vec3 halfAxes = {};
    int quarter = 8;
    [[nodiscard]] TrianglePtr make() const { return geometry::shapes::ellipsoid(halfAxes, quarter); }
};
struct CapsuleShape {
    double radius = 0.0;
    double length = 0.0;
    int quarter = 8;
    [[nodiscard]] TrianglePtr make() const { return geometry::shapes::capsule(radius, length, quarter); }
};
struct CylinderShape {
    double radius = 0.0;
    double length = 0.0;
    int quarter = 8;
    [[nodiscard]] TrianglePtr make() const { return geometry::shapes::cylinder(radius, length, quarter); }
};
struct TubeShape {
    std::vector<Vec3> points = {};
    double radius = 0.0;
    int sides = 8;
    bool sharp = false;
    [[nodiscard]] TrianglePtr make() const { return geometry::shapes::tube(points, radius, sides, sharp); }
};
struct RevolvedShape {
    std::vector<Vec3> corners = {};
    int sides = 24;
    [[nodiscard]] TrianglePtr make() const { return geometry::shapes::revolved(corners, sides); }
};
struct SheetShape {
    double width = 0.0;
    double depth = 0.0;
    std::array<int, 2> cells = {10, 10};
    bool printed = false;
    [[nodiscard]] TrianglePtr make() const { return geometry::shapes::sheet(width, depth, cells, printed); }
};
struct BlockShape {
    Vec3 size = {};
    std::array<int, 3> cells = {4, 4, 4};
    [[nodiscard]] TetPtr make() const { return geometry::shapes::block(size, cells); }
};
struct VesselShape {
    std::vector<Vec3> points = {};
    double radius = 0.0;
    double wall = 0.0;
    std::array<int, 2> cells = {12, 2};
    [[nodiscard]] TetPtr make() const { return geometry::shapes::vessel(points, radius, wall, cells); }
};
struct BladderShape {
    Vec3 halfAxes = {};
    double wall = 0.0;
    std::array<int, 2> cells = {8, 2};
    [[nodiscard]] TetPtr make() const { return geometry::shapes::bladder(halfAxes, wall, cells); }
};
/// A surface file in another unit than metres.
struct ScaledSurface {
    std::string file = {};
    double scale = 1.0;
    [[nodiscard]] TrianglePtr make() const
    {
        return std::make_shared<const geometry::TriangleMesh>(geometry::loadTriangleMesh(file, scale));
    }
};
/// The same for tetrahedra.
struct ScaledTetrahedra {
    std::string file = {};
    double scale = 1.0;
    std::string labels = {};
    bool join = false;
    [[nodiscard]] TetPtr make() const
    {
        geometry::TetMesh mesh = geometry::loadTetMesh(file, scale, labels);
        if (join) mesh = geometry::withJoinedNodes(mesh, file);
        return std::make_shared<const geometry::TetMesh>(std::move(mesh));
    }
};

/// What a surface may be made of, and what a soft body may.
using SurfaceShape = std::variant<BoxShape, SphereShape, EllipsoidShape, CapsuleShape, CylinderShape, TubeShape,
                                  RevolvedShape, SheetShape, ScaledSurface>;
using SoftShape =
    std::variant<BlockShape, VesselShape, BladderShape, ScaledTetrahedra, SheetShape, BoxShape, SphereShape,
                 EllipsoidShape, CapsuleShape, CylinderShape, TubeShape, RevolvedShape, ScaledSurface>;

constexpr auto fields(const BoxShape*)
{
    return describe("box", field("size", &BoxShape::size, "m", positive(), "edges"),
                    field("cells", &BoxShape::cells, "-", closed(1, 500), "cells along each edge"));
}
constexpr auto fields(const SphereShape*)
{
    using T = SphereShape;
    return describe("sphere", field("radius", &T::radius, "m", positive(), "radius"),
                    field("quarter", &T::quarter, "-", closed(1, 500), "edges along a quarter of a great circle"));
}
constexpr auto fields(const EllipsoidShape*)
{
    using T = EllipsoidShape;
    return describe("ellipsoid", field("halfAxes", &T::halfAxes, "m", positive(), "along x, y and z"),
                    field("quarter", &T::quarter, "-", closed(1, 500), "edges along a quarter of a great circle"));
}
constexpr auto fields(const CapsuleShape*)
{
    using T = CapsuleShape;
    return describe("capsule", field("radius", &T::radius, "m", positive(), "radius"),
                    field("length", &T::length, "m", positive(), "length of the line inside, along y"),
                    field("quarter", &T::quarter, "-", closed(1, 500), "edges along a quarter of a circle"));
}
constexpr auto fields(const CylinderShape*)
{
    using T = CylinderShape;
    return describe("cylinder", field("radius", &T::radius, "m", positive(), "radius"),
                    field("length", &T::length, "m", positive(), "length, along y"),
                    field("quarter", &T::quarter, "-", closed(1, 500), "edges along a quarter of a circle"));
}
constexpr auto fields(const TubeShape*)
{
    using T = TubeShape;
    return describe("tube", field("points", &T::points, "m", finite(), "the line along its middle"),
                    field("radius", &T::radius, "m", positive(), "radius"),
                    field("sides", &T::sides, "-", closed(3, 500), "edges around it"),
                    field("sharp", &T::sharp, "the first end is a point"));
}
constexpr auto fields(const RevolvedShape*)
{
    using T = RevolvedShape;
    return describe("revolved",
                    field("corners", &T::corners, "m", finite(), "outline in the plane z = 0, counter-clockwise"),
                    field("sides", &T::sides, "-", closed(3, 500), "edges around y"));
}
constexpr auto fields(const SheetShape*)
{
    using T = SheetShape;
    return describe("sheet", field("width", &T::width, "m", positive(), "edge along x"),
                    field("depth", &T::depth, "m", positive(), "edge along z"),
                    field("cells", &T::cells, "-", closed(1, 500), "cells along each edge"),
                    field("printed", &T::printed, "it has texture coordinates: a picture lies on it once"));
}
constexpr auto fields(const BlockShape*)
{
    return describe("block", field("size", &BlockShape::size, "m", positive(), "edges"),
                    field("cells", &BlockShape::cells, "-", closed(1, 200), "cells along each edge"));
}
constexpr auto fields(const VesselShape*)
{
    using T = VesselShape;
    return describe("vessel", field("points", &T::points, "m", finite(), "the line along its middle"),
                    field("radius", &T::radius, "m", positive(), "radius inside"),
                    field("wall", &T::wall, "m", positive(), "thickness of its wall"),
                    field("cells", &T::cells, "-", closed(1, 500), "cells around it, an even number, and through it"));
}
constexpr auto fields(const BladderShape*)
{
    using T = BladderShape;
    return describe(
        "bladder", field("halfAxes", &T::halfAxes, "m", positive(), "half axes of the space inside"),
        field("wall", &T::wall, "m", positive(), "thickness of its wall"),
        field("cells", &T::cells, "-", closed(1, 100), "cells per quarter of a circle, and through its wall"));
}
constexpr auto fields(const ScaledSurface*)
{
    using T = ScaledSurface;
    return describe("surface", field("file", &T::file, "a surface file"),
                    field("scale", &T::scale, "-", within(positive(), 1e9), "metres per unit of the file"));
}
constexpr auto fields(const ScaledTetrahedra*)
{
    using T = ScaledTetrahedra;
    return describe("tetrahedra", field("file", &T::file, "a mesh file"),
                    field("scale", &T::scale, "-", within(positive(), 1e9), "metres per unit of the file"),
                    field("labels", &T::labels, "which list of numbers per cell of a VTK file are labels"),
                    field("join", &T::join, "nodes that lie on each other become one"));
}

} // namespace filasofia::scene
