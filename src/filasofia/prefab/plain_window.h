#pragma once

#include <imgui.h>

#include <string>

namespace filasofia::prefab {

/// Flags of a window that only shows something over the picture.
inline constexpr ImGuiWindowFlags kPlain = ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoTitleBar |
                                           ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoFocusOnAppearing;

inline void line(const std::string& text) { ImGui::TextUnformatted(text.c_str(), text.c_str() + text.size()); }

} // namespace filasofia::prefab
