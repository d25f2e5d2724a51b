#pragma once

#include "filasofia/record/json_shapes.h"

#include <string_view>

namespace filasofia::record {

inline constexpr std::size_t kMaximumLine = 16 << 20; ///< [bytes], of one record without its mesh
inline constexpr int kMaximumDepth = 32;              ///< of lists and objects in each other
inline constexpr int kMaximumMembers = 64;            ///< of an object; looking for one takes as long as there are

/// The value of a line that anybody may have written. Throws an Error for one that is no JSON, or beyond the limits:
/// they are looked at before anything is made of it.
Json parsed(std::string_view line);

} // namespace filasofia::record
