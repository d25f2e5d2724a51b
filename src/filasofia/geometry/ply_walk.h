#pragma once

#include <string_view>

namespace filasofia::geometry {

/// Reads a whole PLY file as its header announces it, and throws an Error with line or byte if something is missing or
/// is not a number. assimp takes a file that ends too early for a complete one, and fills it with zeros.
void walkPly(std::string_view bytes, std::string_view name);

} // namespace filasofia::geometry
