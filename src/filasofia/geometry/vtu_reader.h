#pragma once

#include "filasofia/geometry/tet_mesh.h"

#include <string>
#include <string_view>

namespace filasofia::geometry {

/// Reads the solids of a VTK XML file of an unstructured grid (text, base64 or appended data, plain or deflated) from
/// its bytes, as loadTetMesh() promises for .vtu; `name` is the file's name for Errors.
TetMesh parseVtu(std::string_view bytes, std::string_view name, const std::string& labels = {});

} // namespace filasofia::geometry
