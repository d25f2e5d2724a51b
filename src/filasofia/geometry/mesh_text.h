#pragma once

#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/geometry/triangle_mesh.h"

#include <string>

/// Meshes as the text of a file that loadTetMesh() and loadTriangleMesh() read back with the same bits.
namespace filasofia::geometry {

/// A Gmsh file, version 2.2, with labels as physical groups and their names.
std::string gmshText(const TetMesh& mesh);

/// Legacy polydata of VTK, with texture coordinates if there are any.
std::string vtkText(const TriangleMesh& mesh);

} // namespace filasofia::geometry
