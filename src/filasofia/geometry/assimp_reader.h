#pragma once

#include "filasofia/geometry/triangle_mesh.h"

#include <filesystem>

namespace filasofia::geometry {

/// Does what loadTriangleMesh() promises, with assimp; the caller has checked that the file is a regular one with a
/// known extension.
TriangleMesh readWithAssimp(const std::filesystem::path& file);

} // namespace filasofia::geometry
