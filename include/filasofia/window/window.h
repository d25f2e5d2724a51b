#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/event/event.h"

#include <memory>
#include <string>

namespace filasofia::window {

struct WindowDef {
    std::string title = "Filasofia";
    int width = 960;  ///< [px], in [1, 8192], width of the content
    int height = 720; ///< [px], in [1, 8192], height of the content
    bool resizable = true;
};
constexpr auto fields(const WindowDef*)
{
    return describe("WindowDef", field("title", &WindowDef::title, "the text in the window's title bar"),
                    field("width", &WindowDef::width, "px", closed(1, 8192), "width of the content"),
                    field("height", &WindowDef::height, "px", closed(1, 8192), "height of the content"),
                    field("resizable", &WindowDef::resizable, "whether the user may change the size"));
}

/// The size of a window's content.
struct WindowSize {
    int width = 0;  ///< [px], > 0
    int height = 0; ///< [px], > 0

    friend constexpr bool operator==(const WindowSize&, const WindowSize&) = default;
};

/// What the simulation needs of a window, whatever library opens it (SDL here; GLFW or Qt in somebody's application).
/// A window belongs to the thread that opened it.
///
/// A derived class must provide nativeWindow() only. All else has a default: the size is the X server's, nothing comes
/// from a person, and the run ends by Simulation::finish() or Ctrl-C. examples/13_glfw is an adapter to copy.
class Window {
public:
    virtual ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    /// The render target: the X11 Window id, as a pointer; nullptr if the window cannot be drawn into.
    [[nodiscard]] virtual void* nativeWindow() const = 0;
    /// The default asks the X server for the size of nativeWindow(), on a connection of its own. Throws an Error if
    /// there is no such window, or no server that DISPLAY names.
    [[nodiscard]] virtual WindowSize size() const;
    /// The factor by which text should be larger than at 96 dots per inch: in [1, 4], in steps of 0.25.
    [[nodiscard]] virtual double scale() const { return 1.0; }

    /// Passes the events since the last call to `sink`, oldest first, as the types of event/input_events.h (their time
    /// and step are 0; the sink sets them). Does not wait. If the sink throws, the exception is passed on, and the
    /// remaining events come with the next call.
    virtual void poll(const event::EventSink& /*sink*/) {}

    /// True if the user asked to close the window (and poll() has seen the request). It stays open until it is
    /// destroyed.
    [[nodiscard]] virtual bool shouldClose() const { return false; }
    virtual void setTitle(const std::string& /*title*/) {}

    /// Turns TextInputEvents in addition to key events on or off; they are on while the user types text. They are off
    /// at first, because an input method may swallow keys that are not text. A window without text input ignores the
    /// call.
    virtual void setTextInput(bool /*on*/) {}

protected:
    Window();

private:
    struct Server;
    mutable std::unique_ptr<Server> server_; ///< from the first time that the default size() is asked for
};

/// Opens a window on the X display that DISPLAY names (the renderer draws through X11 on every desktop). Throws an
/// Error if a field is outside its range, there is no such display, or another thread has such a window open. The
/// program keeps its own signal handlers.
std::unique_ptr<Window> openWindow(const WindowDef& def);

/// True if openWindow() would find a display; if not, `why` (unless null) gets the reason in one line. Never throws an
/// Error; must be called on the same thread as openWindow().
bool displayAvailable(std::string* why = nullptr);

} // namespace filasofia::window
