#pragma once

#include "filasofia/geometry/triangle_mesh.h"

#include <filesystem>
#include <optional>
#include <string>

namespace filasofia::geometry {

/// Does what loadTriangleMesh() promises, with assimp; the caller has checked that the file is a regular one with a
/// known extension. `text`: what is read in the place of the file's content.
TriangleMesh readWithAssimp(const std::filesystem::path& file, const std::optional<std::string>& text = {});

} // namespace filasofia::geometry
