#pragma once

#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/geometry/triangle_mesh.h"

#include <memory>

/// Simple bodies without files. All are centred on the origin or follow a line; surfaces are closed, but for the sheet,
/// and face outwards, and the vertices of round shapes lie on the exact surface. Each function throws an Error naming
/// the shape, the argument, its bound and its value.
namespace filasofia::geometry::shapes {

/// A box of edges `size` [m], each > 0; every face has the given number of cells, in [1, 500], along its axes, two
/// triangles per cell.
std::shared_ptr<const TriangleMesh> box(Vec3 size, std::array<int, 3> cells = {1, 1, 1});

/// A sphere of `radius` [m], > 0, with `quarter` edges, in [1, 500], along a quarter of a great circle: 8 quarter^2
/// triangles.
std::shared_ptr<const TriangleMesh> sphere(double radius, int quarter = 8);

/// An ellipsoid of these half axes [m], each > 0, along x, y and z; `quarter` as for the sphere.
std::shared_ptr<const TriangleMesh> ellipsoid(Vec3 halfAxes, int quarter = 8);

/// Half spheres of `radius` [m], > 0, around both ends of a line of `length` [m], > 0, along y, joined by a cylinder;
/// `quarter` as for the sphere.
std::shared_ptr<const TriangleMesh> capsule(double radius, double length, int quarter = 8);

/// A cylinder of `radius` [m], > 0, and `length` [m], > 0, along y; `quarter` as for the sphere.
std::shared_ptr<const TriangleMesh> cylinder(double radius, double length, int quarter = 8);

/// What a closed outline, `corners` [m] of the plane z = 0 with x >= 0, counter-clockwise, at least three, makes as it
/// turns about y, with `sides` in [3, 500] around it: rings, pipes, caps.
std::shared_ptr<const TriangleMesh> revolved(const std::vector<Vec3>& corners, int sides = 24);

/// A round tube of `radius` [m], > 0, along the line through `points` [m], at least two, with `sides` in [3, 500]
/// around it. Its ends are flat; with `sharp`, the first one is a point.
std::shared_ptr<const TriangleMesh> tube(const std::vector<Vec3>& points, double radius, int sides = 8,
                                         bool sharp = false);

/// A flat sheet of edges `width` along x and `depth` along z [m], each > 0, that faces up, with the given number of
/// cells, in [1, 500], along each, two triangles per cell. All diagonals are parallel: a shell of it bends most
/// exactly. A `printed` one has texture coordinates: a picture lies on it once, its lower edge at +z.
std::shared_ptr<const TriangleMesh> sheet(double width, double depth, std::array<int, 2> cells = {10, 10},
                                          bool printed = false);

/// A solid box of edges `size` [m], each > 0, with the given number of cells, in [1, 200], along each axis and six
/// tetrahedra per cell; no solid here may have more than 3 million. Neighbouring cells mirror each other, so an even
/// number of cells has no preferred direction.
std::shared_ptr<const TetMesh> block(Vec3 size, std::array<int, 3> cells = {4, 4, 4});

/// A hollow vessel along the line through `points` [m], at least two: inside, its `radius` [m], > 0, and around that a
/// `wall` [m], > 0. Its `cells` are those around it, an even number in [4, 500], and through its wall, in [1, 100];
/// along it there is one per edge of the line. Both ends are open.
std::shared_ptr<const TetMesh> vessel(const std::vector<Vec3>& points, double radius, double wall,
                                      std::array<int, 2> cells = {12, 2});

/// A hollow ellipsoid around the origin, closed on all sides, as a bladder is: `halfAxes` [m] of the space inside, each
/// > 0, and around that a `wall` [m], > 0. Its `cells` are those along a quarter of a circle around it, in [1, 100],
/// and through its wall, in [1, 100].
std::shared_ptr<const TetMesh> bladder(Vec3 halfAxes, double wall, std::array<int, 2> cells = {8, 2});

/// Points on a circle of `radius` [m], > 0, about the z axis, from one angle [rad] against the x axis to another, with
/// `edges` in [1, 100000] between them: the line of a curved needle, for a tube or a vessel.
std::vector<Vec3> arc(double radius, double from, double to, int edges = 16);

} // namespace filasofia::geometry::shapes
