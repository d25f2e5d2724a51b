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
    PixelArea area = {}; ///< of the window, in the last frame
    bool visible = true;
};

struct Canvas::Impl {
    OverlayBackend& backend;
    Slot slot;
    CanvasDef def;
    ImguiSurface surface;
};

/// All of a server that is drawn over the scene or stands in it as no body: Guis, Canvases, debug drawings.
class Overlays {
public:
    Overlays();
    ~Overlays();

    /// Throw an Error naming the object where something is wrong.
    Gui& add(const GuiDef& def, View* view, Slot slot, OverlayBackend& backend, int width, int height);
    Canvas& add(const CanvasDef& def, Slot slot, OverlayBackend& backend);
    /// False where it is none of ours.
    bool remove(Gui& gui);
    bool remove(Transform& canvas);
    [[nodiscard]] bool has(const Transform& canvas) const;
    /// Throws an Error where a Gui lies on the view.
    void checkRemoval(const View& view) const;
    /// Throws an Error inside a renderCallback: what it is called from must stay until it returns.
    void checkNotCalled(const char* function) const;

    void setGuiScale(double scale); ///< in [0.5, 8]
    [[nodiscard]] double guiScale() const { return guiScale_; }
    /// The upper ones first; true where one of them takes it.
    bool handle(const event::Event& event);
    [[nodiscard]] bool wantsText() const;

    /// Calls the renderCallbacks, three times when one of them is new, and gives the backend what came out, for a
    /// picture `seconds` after the last. `views` are all of the server, in a window of this size.
    void draw(OverlayBackend& backend, std::span<const std::unique_ptr<View>> views, int width, int height,
              double seconds);
    [[nodiscard]] DebugDraw& debug() { return *debug_; }

private:
    /// There is one whose callback was never called.
    [[nodiscard]] bool fresh() const;
    void callAll(int width, int height, double seconds);
    void drawGui(Gui& gui, int width, int height, double seconds);
    static void drawCanvas(Canvas& canvas, double seconds);

    std::vector<std::unique_ptr<Gui>> guis_;
    std::vector<std::unique_ptr<Canvas>> canvases_;
    std::unique_ptr<DebugDraw> debug_;
    DebugTexts debugTexts_;
    double guiScale_ = 1.0;
    bool calling_ = false; ///< a renderCallback
};

} // namespace filasofia::visual
