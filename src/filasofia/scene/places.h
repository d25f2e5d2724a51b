#pragma once

#include "filasofia/scene/scene_def.h"

#include <string_view>

namespace filasofia::scene {

/// Where a member stands or, if that is not known, what it is in; empty if neither is.
std::string placeOf(const Places& places, std::string path);

/// Throws the Error of a member again, with its place before it.
[[noreturn]] void failAtPlace(const Places& places, const std::string& path, std::string_view error);
/// The same for an Error whose first word is the member's path: "lights[0].on must be ...", "lights[0]: give ...".
[[noreturn]] void failAtPlace(const Places& places, std::string_view error);

} // namespace filasofia::scene
