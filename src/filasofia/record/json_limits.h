#pragma once

#include "filasofia/record/json_shapes.h"

#include <string_view>

namespace filasofia::record {

inline constexpr std::size_t kMaximumLine = 16 << 20; ///< [bytes], one record without its mesh
inline constexpr int kMaximumDepth = 32;              ///< nesting of lists and objects
inline constexpr int kMaximumMembers = 64;            ///< members of an object; the lookup of one takes linear time

/// Parses a line from an untrusted file. Throws an Error if it is not JSON, or beyond the limits, which are checked
/// before anything is built.
Json parsed(std::string_view line);

} // namespace filasofia::record
