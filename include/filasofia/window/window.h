#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/event/event.h"

#include <memory>
#include <string>

namespace filasofia::window {

struct WindowDef {
    std::string title = "Filasofia";
    int width = 960;  ///< [px], in [1, 8192], of the content
    int height = 720; ///< [px], in [1, 8192]
    bool resizable = true;
};
constexpr auto fields(const WindowDef*)
{
    return describe("WindowDef", field("title", &WindowDef::title, "what the window's frame says"),
                    field("width", &WindowDef::width, "px", closed(1, 8192), "of the content"),
                    field("height", &WindowDef::height, "px", closed(1, 8192), "of the content"),
                    field("resizable", &WindowDef::resizable, "whether a person may change the size"));
}

/// Of the content of a window.
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

    /// What a renderer draws into: the X11 Window id, as a pointer; nullptr where there is nothing to draw into.
    [[nodiscard]] virtual void* nativeWindow() const = 0;
    /// By default the X server is asked for the size of nativeWindow(), on a connection of our own. Throws an Error if
    /// there is no such window, or no server that DISPLAY names.
    [[nodiscard]] virtual WindowSize size() const;
    /// How much larger than at 96 dots per inch texts should be: in [1, 4], in quarters.
    [[nodiscard]] virtual double scale() const { return 1.0; }

    /// Hands what happened since the last call to `sink`, oldest first, as the events of event/input_events.h (their
    /// time and step are 0: the sink knows). Does not wait. What the sink throws comes through, and what it has not
    /// been given yet comes with the next call.
    virtual void poll(const event::EventSink& /*sink*/) {}

    /// A person asked to close it (poll() has seen the request). It stays open until it is destroyed.
    [[nodiscard]] virtual bool shouldClose() const { return false; }
    virtual void setTitle(const std::string& /*title*/) {}

    /// Whether keys are to come as TextInputEvents as well, as they do while somebody writes. Not from the start: an
    /// input method may swallow keys that are no text. A window without text ignores it.
    virtual void setTextInput(bool /*on*/) {}

protected:
    Window();

private:
    struct Server;
    mutable std::unique_ptr<Server> server_; ///< from the first time that the default size() is asked for
};

/// Opens a window on the X display that DISPLAY names (the renderer draws through X11, whatever the desktop). Throws
/// an Error where a field is outside its range or there is no such display. All windows are opened by one thread, and
/// signals stay the program's own.
std::unique_ptr<Window> openWindow(const WindowDef& def);

/// Whether openWindow() would find a display; where not, `why` (unless null) is one line about it. Never throws an
/// Error; same thread as openWindow().
bool displayAvailable(std::string* why = nullptr);

} // namespace filasofia::window
