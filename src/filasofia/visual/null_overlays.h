#pragma once

#include "filasofia/core/assert.h"
#include "filasofia/visual/overlay_backend.h"

#include <map>

namespace filasofia::visual {

/// Keeps what the other backends draw.
class NullOverlays final : public OverlayBackend {
public:
    struct Sheet {
        GuiPicture picture;
        PixelArea area = {};
        Pose pose = {};
        int putCalls = 0;
    };

    void putGui(Slot slot, std::shared_ptr<const GlyphSheet>) override { ++sheets[slot].putCalls; }
    void putCanvas(Slot slot, const CanvasSize&, std::shared_ptr<const GlyphSheet>) override
    {
        ++sheets[slot].putCalls;
    }
    void setGuiPicture(Slot gui, const PixelArea& area, GuiPicture picture) override
    {
        Sheet& sheet = sheets.at(gui);
        sheet.area = area;
        sheet.picture = std::move(picture);
    }
    void setCanvasPicture(Slot canvas, const Pose& world, GuiPicture picture) override
    {
        Sheet& sheet = sheets.at(canvas);
        sheet.pose = world;
        sheet.picture = std::move(picture);
    }
    void setDebug(const DebugPicture& picture) override { debug = picture; }
    void remove(Slot slot) override { FILASOFIA_ASSERT(sheets.erase(slot) == 1); }

    std::map<Slot, Sheet> sheets; ///< Guis and Canvases
    DebugPicture debug;
};

} // namespace filasofia::visual
