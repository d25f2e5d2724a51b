#pragma once

#include "filasofia/geometry/tet_mesh.h"

namespace filasofia::geometry {

/// Reads the tetrahedra of a Gmsh file (1, 2 to 2.2 or 4.1, ASCII or binary) from its bytes, as loadTetMesh() promises
/// for .msh; `name` is the file's name for Errors.
TetMesh parseGmsh(std::string_view bytes, std::string_view name);

} // namespace filasofia::geometry
