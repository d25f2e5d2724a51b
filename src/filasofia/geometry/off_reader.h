#pragma once

#include "filasofia/geometry/triangle_mesh.h"

#include <string_view>

namespace filasofia::geometry {

/// Reads the polygons of an OFF file from its bytes, as loadTriangleMesh() promises for .off; `name` is the file's name
/// for Errors.
TriangleMesh parseOff(std::string_view bytes, std::string_view name);

} // namespace filasofia::geometry
