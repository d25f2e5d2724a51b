#pragma once

#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/geometry/triangle_mesh.h"

#include <string>
#include <string_view>

namespace filasofia::geometry {

/// Reads the solids of a VTK XML file of an unstructured grid (text, base64 or appended data, plain or deflated) from
/// its bytes, as loadTetMesh() promises for .vtu; `name` is the file's name for Errors.
TetMesh parseVtu(std::string_view bytes, std::string_view name, const std::string& labels = {});

/// Reads the polygons of a VTK XML file of polydata or of an unstructured grid, as loadTriangleMesh() promises for .vtp
/// and .vtu.
TriangleMesh parseVtuSurface(std::string_view bytes, std::string_view name);

} // namespace filasofia::geometry
