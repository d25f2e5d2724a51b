#pragma once

#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/geometry/triangle_mesh.h"

#include <filesystem>

namespace filasofia::geometry {

/// Reads the tetrahedra of a Gmsh .msh (2.2 or 4.1, ASCII or binary) or TetGen .node/.ele pair (either name), checked;
/// other elements (points, lines, triangles) are passed over, and nodes that only they use are dropped.
/// Throws an Error naming the file, the line or element, and the bound.
TetMesh loadTetMesh(const std::filesystem::path& file);

/// Reads a triangle mesh from OBJ, STL, PLY or glTF (.gltf, .glb): all meshes of the file in one, vertices at the same
/// place joined, polygons triangulated. Throws an Error naming the file and what is wrong with it.
TriangleMesh loadTriangleMesh(const std::filesystem::path& file);

} // namespace filasofia::geometry
