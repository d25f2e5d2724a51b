#include "filasofia/window/null_window.h"

#include "filasofia/core/error.h"
#include "filasofia/event/event_dispatcher.h"
#include "filasofia/event/input_events.h"

namespace null_window_test {

using namespace filasofia;
using namespace filasofia::window;

TEST_CASE("a null window delivers what is injected, in order, and acts on window events")
{
    NullWindow window({.title = "nobody", .width = 320, .height = 200});
    CHECK(window.nativeWindow() == nullptr);
    CHECK(window.size() == WindowSize{320, 200});
    CHECK(window.scale() == 1.0);
    CHECK(window.title() == "nobody");

    event::EventDispatcher dispatcher;
    std::string heard;
    dispatcher.on<event::KeyEvent>([&](const event::KeyEvent& key) { heard += key.pressed ? "down " : "up "; });
    dispatcher.on<event::WindowEvent>(
        [&](const event::WindowEvent& it) { heard += text("size ", it.width, "x", it.height, " "); });
    auto key = std::make_unique<event::KeyEvent>();
    key->pressed = true;
    window.inject(std::move(key));
    auto resized = std::make_unique<event::WindowEvent>();
    resized->width = 640;
    resized->height = 400;
    window.inject(std::move(resized));
    window.inject(std::make_unique<event::KeyEvent>());
    CHECK(window.size() == WindowSize{320, 200}); // nothing happens before poll()

    const event::EventSink sink = [&](std::unique_ptr<event::Event> event) { dispatcher.post(std::move(event)); };
    window.poll(sink);
    dispatcher.deliverAll();
    CHECK(heard == "down size 640x400 up ");
    CHECK(window.size() == WindowSize{640, 400});
    CHECK(!window.shouldClose());

    auto close = std::make_unique<event::WindowEvent>();
    close->kind = event::WindowEvent::Kind::CloseRequested;
    window.inject(std::move(close));
    window.poll(sink);
    CHECK(window.shouldClose());
    window.poll([](std::unique_ptr<event::Event>) { FAIL("handed on twice"); });
}

TEST_CASE("a sink that throws gets the rest with the next poll")
{
    NullWindow window;
    for (int i = 0; i < 3; ++i) window.inject(std::make_unique<event::KeyEvent>());
    CHECK_THROWS_AS(window.poll([](std::unique_ptr<event::Event>) { fail("full"); }), Error);
    int rest = 0;
    window.poll([&](std::unique_ptr<event::Event>) { ++rest; });
    CHECK(rest == 2);
}

TEST_CASE("a window's size is checked against its range")
{
    CHECK_THROWS_WITH(NullWindow({.title = "tiny", .width = 0}), "window 'tiny': width must be in [1, 8192] px, got 0");
    CHECK_THROWS_WITH(openWindow({.title = "huge", .height = 10000}),
                      "window 'huge': height must be in [1, 8192] px, got 10000");
}

} // namespace null_window_test
