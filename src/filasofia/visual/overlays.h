#pragma once

#include "filasofia/visual/canvas.h"
#include "filasofia/visual/debug_draw.h"
#include "filasofia/visual/debug_text.h"
#include "filasofia/visual/imgui_surface.h"

#include <span>

namespace filasofia::visual {

struct Scene;

struct Gui::Impl {
    OverlayBackend& backend;
    Slot slot;
    GuiDef def;
    View* view; ///< nullptr: the window
    ImguiSurface surface;
    PixelArea area = {}; ///< in the window, in the last frame
    bool visible = true;
};

struct Canvas::Impl {
    OverlayBackend& backend;
    Slot slot;
    CanvasDef def;
    ImguiSurface surface;
};

/// Everything of a server that lies over the scene, or stands in it and is not a body: Guis, Canvases, debug drawings.
class Overlays {
public:
    Overlays();
    ~Overlays();

    /// Throw an Error naming the object if the Def is wrong.
    Gui& add(const GuiDef& def, View* view, Slot slot, OverlayBackend& backend, int width, int height);
    Canvas& add(const CanvasDef& def, Slot slot, OverlayBackend& backend);
    /// Return false if it is not one of ours.
    bool remove(Gui& gui);
    bool remove(Transform& canvas);
    [[nodiscard]] bool has(const Transform& canvas) const;
    /// Throws an Error if a Gui lies on the view.
    void checkRemoval(const View& view) const;
    /// Throws an Error inside a renderCallback, because its caller must stay alive until it returns.
    void checkNotCalled(const char* function) const;

    void setGuiScale(double scale); ///< in [0.5, 8]
    [[nodiscard]] double guiScale() const { return guiScale_; }
    /// Upper ones first. Returns true if one of them takes the event.
    bool handle(const event::Event& event);
    [[nodiscard]] bool wantsText() const;

    /// Calls the renderCallbacks, three times if one of them is new, and passes the result to the backend, for a
    /// picture `seconds` after the last. `views` are all views of the server, in a window of this size.
    void draw(OverlayBackend& backend, std::span<const std::unique_ptr<View>> views, int width, int height,
              double seconds);
    [[nodiscard]] DebugDraw& debug() { return *debug_; }

private:
    /// Whether there is a callback that was never called.
    [[nodiscard]] bool fresh() const;
    void callAll(int width, int height, double seconds);
    void drawGui(Gui& gui, int width, int height, double seconds);
    static void drawCanvas(Canvas& canvas, double seconds);

    std::vector<std::unique_ptr<Gui>> guis_;
    std::vector<std::unique_ptr<Canvas>> canvases_;
    std::unique_ptr<DebugDraw> debug_;
    DebugTexts debugTexts_;
    double guiScale_ = 1.0;
    bool calling_ = false; ///< a renderCallback is being called
};

} // namespace filasofia::visual
