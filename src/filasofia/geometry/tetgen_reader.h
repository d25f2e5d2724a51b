#pragma once

#include "filasofia/geometry/tet_mesh.h"

namespace filasofia::geometry {

/// The bytes of a file, and its name for Errors.
struct NamedBytes {
    std::string_view bytes;
    std::string_view name;
};

/// Reads the tetrahedra of a TetGen pair from its bytes, as loadTetMesh() promises for .node and .ele.
TetMesh parseTetGen(NamedBytes nodeFile, NamedBytes elementFile);

} // namespace filasofia::geometry
