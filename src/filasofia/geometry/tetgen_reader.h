#pragma once

#include "filasofia/geometry/tet_mesh.h"

namespace filasofia::geometry {

/// A file's bytes and its name for Errors.
struct NamedBytes {
    std::string_view bytes;
    std::string_view name;
};

/// The tetrahedra of a TetGen pair given as bytes. What loadTetMesh() promises for .node and .ele.
TetMesh parseTetGen(NamedBytes nodeFile, NamedBytes elementFile);

} // namespace filasofia::geometry
