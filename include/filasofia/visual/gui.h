#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/event/event.h"
#include "filasofia/visual/view.h"

#include <functional>
#include <memory>

namespace filasofia::visual {

/// What a Gui or a Canvas calls in each of its frames: it calls ImGui (the user includes <imgui.h>, version 1.86) and
/// nothing of the visual server's render(), capture() or remove().
///
/// ImGui's state is this Gui's or Canvas's own during the call, and there is none outside of it. What the callback
/// throws, and what ImGui asserts about how it was called, is logged once; then the callback is not called again.
/// Windows, groups and styles that it forgets to end are ended for it, and logged once.
using RenderCallback = std::function<void()>;

struct GuiDef {
    std::string name = "gui";
    double scale = 1.0;                 ///< [-], in [0.5, 8], size of texts and spaces, times the server's guiScale()
    RenderCallback renderCallback = {}; ///< not a field of files; empty: nothing is drawn
};

constexpr auto fields(const GuiDef*)
{
    return describe("GuiDef", field("name", &GuiDef::name, "name in errors"),
                    field("scale", &GuiDef::scale, "-", closed(0.5, 8), "size of texts and spaces"));
}

/// Panels, buttons and texts over a view, or over the whole window, for mouse and keyboard; made by VisualServer::add.
/// Later ones lie on top. Its coordinates are pixels of the view or window, from its upper left corner. Main thread
/// only, but for setRenderCallback().
class Gui {
public:
    struct Impl;
    explicit Gui(std::unique_ptr<Impl> impl);
    ~Gui();
    Gui(const Gui&) = delete;
    Gui& operator=(const Gui&) = delete;

    [[nodiscard]] const std::string& name() const;
    [[nodiscard]] View* view() const; ///< nullptr: over the whole window

    /// Any thread. When it returns the old callback is not running and will not run again: it waits for one that does,
    /// except when called from inside that callback, which then runs to its end.
    void setRenderCallback(RenderCallback callback);

    /// Of this Gui alone. Throws an Error naming the Gui where it is out of [0.5, 8].
    void setScale(double scale);

    [[nodiscard]] bool visible() const;
    /// A hidden one takes no events, and its callback is not called.
    void setVisible(bool visible);

    /// What a person did, in pixels of the window. True: it is for the Gui, and nothing else should act on it. Acts on
    /// the following frames: a click has its press and its release in two of them, however fast it was.
    bool handle(const event::Event& event);

    [[nodiscard]] Impl& impl() { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::visual
