#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/event/event.h"
#include "filasofia/visual/view.h"

#include <functional>
#include <memory>

namespace filasofia::visual {

/// The function that a Gui or a Canvas calls in each of its frames. It calls ImGui (the user includes <imgui.h>,
/// version 1.86), and must not call the visual server's render(), capture() or remove().
///
/// During the call ImGui's state belongs to this Gui or Canvas; outside of it there is none. If the callback throws, or
/// ImGui asserts because of a wrong call, that is logged once and the callback is not called again. Windows, groups and
/// styles that it forgets to end are ended for it, and logged once.
using RenderCallback = std::function<void()>;

struct GuiDef {
    std::string name = "gui";
    double scale = 1.0;                 ///< [-], in [0.5, 8], size of text and spacing, times the server's guiScale()
    RenderCallback renderCallback = {}; ///< not a field of files; empty: nothing is drawn
};

constexpr auto fields(const GuiDef*)
{
    return describe("GuiDef", field("name", &GuiDef::name, "name in errors"),
                    field("scale", &GuiDef::scale, "-", closed(0.5, 8), "size of text and spacing"));
}

/// Panels, buttons and texts over a view or over the whole window, for mouse and keyboard; made by VisualServer::add.
/// Later ones lie on top. Its coordinates are pixels of the view or window, from the upper left corner. Main thread
/// only, except for setRenderCallback().
class Gui {
public:
    struct Impl;
    explicit Gui(std::unique_ptr<Impl> impl);
    ~Gui();
    Gui(const Gui&) = delete;
    Gui& operator=(const Gui&) = delete;

    [[nodiscard]] const std::string& name() const;
    [[nodiscard]] View* view() const; ///< nullptr: over the whole window

    /// Any thread. When it returns, the old callback is not running and will not run again: it waits if that callback
    /// is running, unless it is called from inside of it; then that call runs to its end.
    void setRenderCallback(RenderCallback callback);

    /// Scale of this Gui alone. Throws an Error naming the Gui if it is outside [0.5, 8].
    void setScale(double scale);

    [[nodiscard]] bool visible() const;
    /// A hidden Gui takes no events, and its callback is not called.
    void setVisible(bool visible);

    /// Passes on input, in pixels of the window. Returns true if it was for the Gui, so that nothing else should act on
    /// it. It takes effect in the following frames: press and release of a click fall into two of them, however fast
    /// the click was.
    bool handle(const event::Event& event);

    [[nodiscard]] Impl& impl() { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::visual
