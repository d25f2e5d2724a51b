#pragma once

#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/geometry/triangle_mesh.h"

#include <filesystem>

namespace filasofia::geometry {

/// Reads the tetrahedra of a Gmsh .msh (2.2 or 4.1, ASCII or binary) or TetGen .node/.ele pair (either name), checked;
/// other elements (points, lines, triangles, quadrangles) are passed over, and nodes that no tetrahedron uses are
/// dropped; the rest keep their order. Second-order tetrahedra, hexahedra, prisms and pyramids are refused.
/// `scale` [m], > 0, is how long one unit of the file is: 1e-3 for millimetres.
/// Throws an Error naming the file, the line (ASCII) or byte (binary) and element, and the bound.
TetMesh loadTetMesh(const std::filesystem::path& file, double scale = 1.0);

/// Reads a triangle mesh from OBJ, STL, PLY or glTF (.gltf, .glb): all meshes of the file in one, where the file's
/// nodes place them, vertices at exactly the same place joined and numbered in the order in which triangles use them,
/// polygons triangulated. Coordinates pass through single precision. Where joining gives a vertex several texture
/// coordinates the first one counts, and a part without any gets (0, 0). Triangles that name a vertex twice after
/// joining are dropped; a warning in the log counts what was dropped.
/// `scale` [m], > 0, is how long one unit of the file is.
/// Throws an Error naming the file and what is wrong with it.
TriangleMesh loadTriangleMesh(const std::filesystem::path& file, double scale = 1.0);

} // namespace filasofia::geometry
