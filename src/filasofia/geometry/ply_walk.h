#pragma once

#include <string_view>

namespace filasofia::geometry {

/// Walks through a whole PLY file as its header announces it, and throws an Error with line or byte where something is
/// missing or is no number. assimp takes a file that ends too early for one that is complete, with zeros.
void walkPly(std::string_view bytes, std::string_view name);

} // namespace filasofia::geometry
