#pragma once

#include "filasofia/visual/image.h"

#include <imgui.h>

namespace filasofia::prefab {

/// Draws a picture between two corners, with a vertex per pixel, because a Gui has no textures of its own. The colours
/// in between are those of a texture that is filtered linearly.
inline void drawImage(ImDrawList& list, ImVec2 from, ImVec2 to, const visual::Image& image)
{
    const int across = image.width, down = image.height;
    if (across < 2 || down < 2) return;
    list.PrimReserve(6 * (across - 1) * (down - 1), across * down);
    const unsigned first = list._VtxCurrentIdx;
    const ImVec2 white = ImGui::GetFontTexUvWhitePixel();
    for (int y = 0; y < down; ++y)
        for (int x = 0; x < across; ++x) {
            const auto [red, green, blue, alpha] = image.pixel(x, y);
            const float u = static_cast<float>(x) / static_cast<float>(across - 1);
            const float v = static_cast<float>(y) / static_cast<float>(down - 1);
            list.PrimWriteVtx({from.x + u * (to.x - from.x), from.y + v * (to.y - from.y)}, white,
                              IM_COL32(red, green, blue, alpha));
        }
    for (int y = 0; y + 1 < down; ++y)
        for (int x = 0; x + 1 < across; ++x) {
            const unsigned corner = first + static_cast<unsigned>(y * across + x), below = corner + unsigned(across);
            for (const unsigned each : {corner, corner + 1, below, below, corner + 1, below + 1})
                list.PrimWriteIdx(static_cast<ImDrawIdx>(each));
        }
}

} // namespace filasofia::prefab
