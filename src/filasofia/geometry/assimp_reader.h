#pragma once

#include "filasofia/geometry/triangle_mesh.h"

#include <filesystem>

namespace filasofia::geometry {

/// What loadTriangleMesh() promises, through assimp; the file is known to be a regular one with a known extension.
TriangleMesh readWithAssimp(const std::filesystem::path& file);

} // namespace filasofia::geometry
