#pragma once

#include <string>
#include <string_view>

namespace filasofia::geometry {

/// Checks what an OBJ file says of vertices and faces, and returns its lines in the words that assimp reads right: it
/// would drop a vertex whose number begins with a point, and read 1,5 as 1.5 and 0x10 as 0. `name` is the file's name
/// for Errors, which name the line and the value: numbers must be finite, a face must name vertices that exist, and all
/// its corners the same kinds of them.
std::string checkedObj(std::string_view bytes, std::string_view name);

} // namespace filasofia::geometry
