#pragma once

#include "filasofia/visual/debug_shapes.h"
#include "filasofia/visual/imgui_surface.h"

#include <map>
#include <optional>
#include <span>

namespace filasofia::visual {

/// The place of a scene's point in a view, in [px] from its upper left corner; nothing if the point is behind the
/// camera or beyond its far plane.
std::optional<std::array<double, 2>> projected(const View& view, int width, int height, Vec3 point);

/// Draws texts at places in the scene, with an otherwise invisible Gui over each view.
class DebugTexts {
public:
    void draw(OverlayBackend& backend, std::span<const DebugText> texts, std::span<const std::unique_ptr<View>> views,
              int width, int height, double scale);

private:
    struct Sheet {
        explicit Sheet() : surface({.object = "debug texts"}) {}
        ImguiSurface surface;
    };
    std::map<Slot, Sheet> sheets_; ///< by the view's slot; made when there is a text to draw
};

} // namespace filasofia::visual
