#include "filasofia/window/window.h"

#include "filasofia/core/error.h"

#include <X11/Xlib.h>

#include <cstdint>

namespace filasofia::window {
namespace {

bool gErrorSeen = false; // Xlib's error handler is one for the process and takes no context

int noteError(Display*, XErrorEvent*)
{
    gErrorSeen = true;
    return 0;
}

} // namespace

/// A connection to the X server.
struct Window::Server {
    Display* display = XOpenDisplay(nullptr);

    Server() = default;
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;
    ~Server()
    {
        if (display) XCloseDisplay(display);
    }
};

Window::Window() = default;
Window::~Window() = default;

WindowSize Window::size() const
{
    const auto id = reinterpret_cast<std::uintptr_t>(nativeWindow());
    if (!server_) server_ = std::make_unique<Server>();
    if (!server_->display) fail("window: size: no X display can be opened (DISPLAY)");
    // A window that is gone would end the process.
    gErrorSeen = false;
    const XErrorHandler before = XSetErrorHandler(noteError);
    XWindowAttributes attributes;
    const bool found = id != 0 && XGetWindowAttributes(server_->display, id, &attributes) != 0;
    XSync(server_->display, False);
    XSetErrorHandler(before);
    if (!found || gErrorSeen) fail("window: size: there is no X11 window ", id);
    return {attributes.width, attributes.height};
}

} // namespace filasofia::window
