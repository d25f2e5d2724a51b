#pragma once

#include <filesystem>
#include <string_view>

namespace filasofia::geometry {

/// Throws an Error if a PLY, STL or glTF file is cut off or announces more than it can hold: assimp allocates the
/// announced size before it looks for the data; and if a number of a text is none, which assimp would read up to the
/// first strange letter. `extension` is lower case, with its dot.
void checkAnnouncedSizes(const std::filesystem::path& file, std::string_view extension, std::string_view bytes);

} // namespace filasofia::geometry
