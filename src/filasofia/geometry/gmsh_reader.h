#pragma once

#include "filasofia/geometry/tet_mesh.h"

namespace filasofia::geometry {

/// The tetrahedra of a Gmsh file (2.2 or 4.1, ASCII or binary) given as its bytes; `name` is the file's, for Errors.
/// What loadTetMesh() promises for .msh.
TetMesh parseGmsh(std::string_view bytes, std::string_view name);

} // namespace filasofia::geometry
