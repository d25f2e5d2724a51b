#pragma once

#include <imgui.h>

namespace filasofia::prefab {

/// Flags of a window that only shows something over the picture.
inline constexpr ImGuiWindowFlags kPlain = ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoTitleBar |
                                           ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoFocusOnAppearing;

} // namespace filasofia::prefab
