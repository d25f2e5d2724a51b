#pragma once

#include <filesystem>
#include <string>

namespace filasofia::geometry {

/// Reads the whole file. Throws an Error naming the file if it is missing, is not a regular file, is empty or cannot be
/// read.
std::string readFile(const std::filesystem::path& file);

} // namespace filasofia::geometry
