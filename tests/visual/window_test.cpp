#include "little_scene.h"

#include "filasofia/core/error.h"

#include <X11/Xlib.h>

#include <csignal>
#include <cstdlib>
#include <sys/wait.h>
#include <unistd.h>

namespace window_test {

using namespace filasofia;
using namespace filasofia::visual;
using Catch::Contains;

namespace {

/// An X server in memory during a test; DISPLAY names it.
class TestDisplay {
public:
    TestDisplay()
    {
        int ready[2];
        REQUIRE(pipe(ready) == 0);
        process_ = fork();
        REQUIRE(process_ >= 0);
        if (process_ == 0) {
            close(ready[0]);
            const std::string descriptor = std::to_string(ready[1]);
            execlp("Xvfb", "Xvfb", "-displayfd", descriptor.c_str(), "-screen", "0", "640x480x24", "-nolisten", "tcp",
                   nullptr);
            _exit(127);
        }
        close(ready[1]);
        std::string number; // Xvfb writes it when it is ready
        for (char c = 0; read(ready[0], &c, 1) == 1 && c != '\n';) number += c;
        close(ready[0]);
        INFO("Xvfb (package xvfb) must be installed");
        REQUIRE_FALSE(number.empty());
        setenv("DISPLAY", (":" + number).c_str(), 1);
    }
    ~TestDisplay()
    {
        kill(process_, SIGTERM);
        waitpid(process_, nullptr, 0);
        unsetenv("DISPLAY");
    }

private:
    pid_t process_ = -1;
};

/// A window without decoration, and its id in the form that the server takes.
class TestWindow {
public:
    TestWindow(unsigned width, unsigned height) : display_(XOpenDisplay(nullptr))
    {
        REQUIRE(display_);
        window_ = XCreateSimpleWindow(display_, DefaultRootWindow(display_), 0, 0, width, height, 0, 0, 0);
        XMapWindow(display_, window_);
        XSync(display_, False);
    }
    ~TestWindow()
    {
        XDestroyWindow(display_, window_);
        XCloseDisplay(display_);
    }
    [[nodiscard]] void* handle() const { return reinterpret_cast<void*>(static_cast<std::uintptr_t>(window_)); }

private:
    Display* display_;
    Window window_ = 0;
};

} // namespace

TEST_CASE("a window shows the same picture as no window")
{
    const TestDisplay display;
    const TestWindow window(320, 240);
    VisualServer server({.backend = Backend::Window, .width = 320, .height = 240, .nativeWindow = window.handle()});
    server.add(sphereDef());
    const EndoscopeLook look = addEndoscopeLook(server, boundsOf(sphereDef().mesh), Quality::Low);
    int drawn = 0;
    for (int i = 0; i < 100 && drawn == 0; ++i) drawn += server.render();
    CHECK(drawn == 1);
    const Image inWindow = server.capture();
    CHECK(brightnessAt(inWindow, 160, 120) > 40);
    LittleScene headless;
    const Image expected = headless.server.capture();
    CHECK(difference(expected, inWindow) <= 2);
    View& aside = server.add(ViewDef{.quality = Quality::Low, .target = OffScreen{320, 240}}, look.view->camera());
    CHECK(difference(expected, aside.capture()) <= 2);
    CHECK(difference(expected, server.capture()) <= 2);
}

TEST_CASE("without a display or a window, the window backend is an Error and does not end the process")
{
    unsetenv("DISPLAY");
    void* const nowhere = reinterpret_cast<void*>(std::uintptr_t{12345});
    CHECK_THROWS_WITH(VisualServer({.backend = Backend::Window, .nativeWindow = nowhere}), Contains("DISPLAY"));
    const TestDisplay display;
    CHECK_THROWS_WITH(VisualServer({.backend = Backend::Window, .nativeWindow = nowhere}), Contains("12345"));
    CHECK_THROWS_WITH(VisualServer({.backend = Backend::Window, .nativeWindow = nullptr}), Contains("nativeWindow"));
}

} // namespace window_test
