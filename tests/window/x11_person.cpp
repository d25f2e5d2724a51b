#include "window/x11_person.h"

#include <X11/Xlib.h>
#include <X11/Xutil.h>

#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace filasofia::window {

ScopedVariable::ScopedVariable(const char* name, const char* value) : name_(name)
{
    if (const char* before = std::getenv(name)) before_ = std::make_unique<std::string>(before);
    if (value) {
        setenv(name, value, 1);
    } else {
        unsetenv(name);
    }
}

ScopedVariable::~ScopedVariable()
{
    if (before_) {
        setenv(name_.c_str(), before_->c_str(), 1);
    } else {
        unsetenv(name_.c_str());
    }
}

VirtualDisplay::VirtualDisplay()
{
    int channel[2];
    if (pipe(channel) != 0) throw std::runtime_error("no pipe");
    const std::string descriptor = std::to_string(channel[1]);
    process_ = fork();
    if (process_ == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL); // a test that crashes must leave no server behind
        close(channel[0]);
        // With -noreset the server does not restart, unresponsive for a moment, whenever the last window closes. With
        // -displayfd it takes the first free display and writes its number when it is ready.
        execlp("Xvfb", "Xvfb", "-displayfd", descriptor.c_str(), "-screen", "0", "1024x768x24", "-dpi", "96",
               "-noreset", "-nolisten", "tcp", static_cast<char*>(nullptr));
        _exit(127);
    }
    close(channel[1]);
    std::string number;
    for (char letter = 0; read(channel[0], &letter, 1) == 1 && letter != '\n';) number += letter;
    close(channel[0]);
    if (number.empty()) throw std::runtime_error("Xvfb does not start: install xvfb (scripts/setup.sh)");
    variable_ = std::make_unique<ScopedVariable>("DISPLAY", (":" + number).c_str());
}

VirtualDisplay::~VirtualDisplay()
{
    kill(process_, SIGTERM);
    waitpid(process_, nullptr, 0);
}

struct Person::Impl {
    Display* display = XOpenDisplay(nullptr);
    Window window = 0;

    void send(XEvent event, long mask) const
    {
        event.xany.display = display;
        event.xany.window = window;
        XSendEvent(display, window, False, mask, &event);
        XSync(display, False);
    }
};

Person::Person(void* nativeWindow) : impl_(std::make_unique<Impl>())
{
    if (!impl_->display) throw std::runtime_error("no X display");
    impl_->window = static_cast<Window>(reinterpret_cast<std::uintptr_t>(nativeWindow));
}

Person::~Person() { XCloseDisplay(impl_->display); }

void Person::moveMouse(int x, int y)
{
    XWarpPointer(impl_->display, None, impl_->window, 0, 0, 0, 0, x, y);
    XSync(impl_->display, False);
}

void Person::button(int number, bool pressed)
{
    XEvent event = {};
    event.xbutton.type = pressed ? ButtonPress : ButtonRelease;
    event.xbutton.root = DefaultRootWindow(impl_->display);
    event.xbutton.button = static_cast<unsigned>(number);
    event.xbutton.same_screen = True;
    impl_->send(event, ButtonPressMask);
}

void Person::key(const char* name, bool pressed)
{
    XEvent event = {};
    event.xkey.type = pressed ? KeyPress : KeyRelease;
    event.xkey.root = DefaultRootWindow(impl_->display);
    event.xkey.keycode = XKeysymToKeycode(impl_->display, XStringToKeysym(name));
    event.xkey.same_screen = True;
    impl_->send(event, KeyPressMask);
}

void Person::resize(int width, int height)
{
    XResizeWindow(impl_->display, impl_->window, static_cast<unsigned>(width), static_cast<unsigned>(height));
    XSync(impl_->display, False);
}

void Person::requestClose()
{
    XEvent event = {};
    event.xclient.type = ClientMessage;
    event.xclient.message_type = XInternAtom(impl_->display, "WM_PROTOCOLS", False);
    event.xclient.format = 32;
    event.xclient.data.l[0] = static_cast<long>(XInternAtom(impl_->display, "WM_DELETE_WINDOW", False));
    impl_->send(event, NoEventMask);
}

void Person::minimize(bool hidden)
{
    hidden ? XUnmapWindow(impl_->display, impl_->window) : XMapWindow(impl_->display, impl_->window);
    XSync(impl_->display, False);
}

std::string Person::title() const
{
    XTextProperty property = {};
    XGetTextProperty(impl_->display, impl_->window, &property, XInternAtom(impl_->display, "_NET_WM_NAME", False));
    const std::string title = property.value ? reinterpret_cast<const char*>(property.value) : "";
    if (property.value) XFree(property.value);
    return title;
}

bool Person::resizable() const
{
    XSizeHints hints = {};
    long supplied = 0;
    XGetWMNormalHints(impl_->display, impl_->window, &hints, &supplied);
    return !((hints.flags & PMinSize) && (hints.flags & PMaxSize) && hints.min_width == hints.max_width);
}

int Person::width() const
{
    XWindowAttributes attributes = {};
    XGetWindowAttributes(impl_->display, impl_->window, &attributes);
    return attributes.width;
}

} // namespace filasofia::window

// SDL leaves its connection to the message bus open on purpose (libdbus may be in use elsewhere in the process).
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libdbus-1.so\n"; }
