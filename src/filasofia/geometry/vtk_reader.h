#pragma once

#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/geometry/triangle_mesh.h"

#include <string>
#include <string_view>

namespace filasofia::geometry {

/// The array of six numbers per cell that holds the texture coordinates of the corners of triangles: VTK has no name
/// for them, and no reader of others knows ours.
inline constexpr std::string_view kUvOfCorners = "uv_of_corners";

/// Reads the solids of a legacy VTK file (an unstructured grid, versions 1 to 5.1, ASCII or binary) from its bytes, as
/// loadTetMesh() promises for .vtk; `name` is the file's name for Errors.
TetMesh parseVtk(std::string_view bytes, std::string_view name, const std::string& labels = {});

/// Reads the polygons of legacy VTK polydata or of an unstructured grid, as loadTriangleMesh() promises for .vtk.
TriangleMesh parseVtkSurface(std::string_view bytes, std::string_view name);

} // namespace filasofia::geometry
