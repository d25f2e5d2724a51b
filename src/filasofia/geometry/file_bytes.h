#pragma once

#include <filesystem>
#include <string>

namespace filasofia::geometry {

/// The whole file. Throws an Error naming it where it is missing, is no regular file, is empty or cannot be read.
std::string readFile(const std::filesystem::path& file);

} // namespace filasofia::geometry
