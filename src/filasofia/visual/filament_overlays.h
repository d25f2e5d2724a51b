#pragma once

#include "filasofia/visual/filament_canvas.h"
#include "filasofia/visual/filament_debug.h"

#include <filament/Renderer.h>

#include <map>

namespace filasofia::visual {

/// Options that clear to black of this opacity.
inline filament::Renderer::ClearOptions clearTo(float opacity)
{
    filament::Renderer::ClearOptions options;
    options.clear = true;
    options.clearColor = {0.0F, 0.0F, 0.0F, opacity};
    return options;
}

/// Draws Guis, Canvases and debug drawings with Filament.
class FilamentOverlays final : public OverlayBackend {
public:
    FilamentOverlays(filament::Engine& engine, filament::Renderer& renderer, filament::Scene& scene,
                     MaterialPool& pool);

    void putGui(Slot slot, std::shared_ptr<const GlyphSheet> glyphs) override;
    void putCanvas(Slot slot, const CanvasSize& size, std::shared_ptr<const GlyphSheet> glyphs) override;
    void setGuiPicture(Slot gui, const PixelArea& area, GuiPicture picture) override;
    void setCanvasPicture(Slot canvas, const Pose& world, GuiPicture picture) override;
    void setDebug(const DebugPicture& picture) override;
    void remove(Slot slot) override;

    /// Within a frame, before the scene's views.
    void drawCanvases();
    /// Within a frame, after the scene's views.
    void drawGuis(int windowWidth, int windowHeight);

private:
    struct PlacedGui {
        std::unique_ptr<FilamentGui> gui;
        PixelArea area;
    };

    filament::Engine& engine_;
    filament::Renderer& renderer_;
    filament::Scene& scene_;
    MaterialPool& pool_;
    FilamentDebug inside_, onTop_;
    std::map<Slot, std::unique_ptr<FilamentCanvas>> canvases_;
    std::map<Slot, PlacedGui> guis_; ///< in the order in which they were made: later ones lie on top
};

} // namespace filasofia::visual
