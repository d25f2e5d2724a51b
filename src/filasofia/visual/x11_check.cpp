#include "filasofia/visual/x11_check.h"

#include "filasofia/core/error.h"

#include <X11/Xlib.h>

#include <memory>

namespace filasofia::visual {
namespace {

bool gErrorSeen = false; // Xlib has one error handler per process, which takes no context

int noteError(Display*, XErrorEvent*)
{
    gErrorSeen = true;
    return 0;
}

bool windowExists(Display* display, Window window)
{
    gErrorSeen = false;
    const XErrorHandler before = XSetErrorHandler(noteError);
    XWindowAttributes attributes;
    const bool found = XGetWindowAttributes(display, window, &attributes) != 0;
    XSync(display, False);
    XSetErrorHandler(before);
    return found && !gErrorSeen;
}

} // namespace

void checkX11Window(void* nativeWindow)
{
    if (!nativeWindow) fail("visual server: nativeWindow: the window backend needs an X11 window, got none");
    const auto close = [](Display* open) { XCloseDisplay(open); };
    const std::unique_ptr<Display, decltype(close)> display(XOpenDisplay(nullptr), close);
    if (!display) fail("visual server: no X display can be opened (DISPLAY); without a screen use Backend::Headless");
    int opcode = 0, event = 0, error = 0;
    if (!XQueryExtension(display.get(), "GLX", &opcode, &event, &error))
        fail("visual server: the X display has no OpenGL (GLX)");
    const auto window = static_cast<Window>(reinterpret_cast<std::uintptr_t>(nativeWindow));
    if (!windowExists(display.get(), window))
        fail("visual server: nativeWindow: there is no X11 window ", static_cast<unsigned long>(window));
}

} // namespace filasofia::visual
