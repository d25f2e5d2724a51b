#include "filasofia/visual/filament_overlays.h"

#include "filasofia/core/assert.h"

namespace filasofia::visual {
FilamentOverlays::FilamentOverlays(filament::Engine& engine, filament::Renderer& renderer, filament::Scene& scene,
                                   MaterialPool& pool)
    : engine_(engine), renderer_(renderer), scene_(scene), pool_(pool), inside_(engine, scene, pool, false),
      onTop_(engine, scene, pool, true)
{
}

void FilamentOverlays::putGui(Slot slot, std::shared_ptr<const GlyphSheet> glyphs)
{
    PlacedGui& placed = guis_[slot];
    if (!placed.gui) placed.gui = std::make_unique<FilamentGui>(engine_, pool_);
    placed.gui->setGlyphs(std::move(glyphs));
}

void FilamentOverlays::putCanvas(Slot slot, const CanvasSize& size, std::shared_ptr<const GlyphSheet> glyphs)
{
    auto& canvas = canvases_[slot];
    canvas = std::make_unique<FilamentCanvas>(engine_, scene_, pool_, size);
    canvas->setGlyphs(std::move(glyphs));
}

void FilamentOverlays::setGuiPicture(Slot gui, const PixelArea& area, GuiPicture picture)
{
    PlacedGui& placed = guis_.at(gui);
    placed.area = area;
    placed.gui->setPicture(std::move(picture));
}

void FilamentOverlays::setCanvasPicture(Slot canvas, const Pose& world, GuiPicture picture)
{
    canvases_.at(canvas)->setPicture(world, std::move(picture));
}

void FilamentOverlays::setDebug(const DebugPicture& picture)
{
    inside_.set(picture.inside);
    onTop_.set(picture.onTop);
}

void FilamentOverlays::remove(Slot slot) { FILASOFIA_ASSERT(guis_.erase(slot) + canvases_.erase(slot) == 1); }

void FilamentOverlays::drawCanvases()
{
    if (canvases_.empty()) return;
    renderer_.setClearOptions(clearTo(0.0F)); // a canvas is cleared to transparent, the window to black
    for (auto& [slot, canvas] : canvases_) canvas->draw(renderer_);
    renderer_.setClearOptions(clearTo(1.0F));
}

void FilamentOverlays::drawGuis(int windowWidth, int windowHeight)
{
    for (auto& [slot, placed] : guis_) {
        const PixelArea& area = placed.area;
        if (placed.gui->empty() || area.right > windowWidth || area.bottom > windowHeight)
            continue; // the window has just been resized
        placed.gui->setViewport(
            {area.left, windowHeight - area.bottom, std::uint32_t(area.width()), std::uint32_t(area.height())});
        renderer_.render(&placed.gui->view());
    }
}

} // namespace filasofia::visual
