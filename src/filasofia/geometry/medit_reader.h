#pragma once

#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/geometry/triangle_mesh.h"

#include <string_view>

namespace filasofia::geometry {

/// Reads the solids of a Medit file (text) from its bytes, as loadTetMesh() promises for .mesh; `name` is the file's
/// name for Errors.
TetMesh parseMedit(std::string_view bytes, std::string_view name);

/// Reads its triangles and quadrilaterals, as loadTriangleMesh() promises for .mesh.
TriangleMesh parseMeditSurface(std::string_view bytes, std::string_view name);

} // namespace filasofia::geometry
