#include "filasofia/core/error.h"
#include "filasofia/event/input_events.h"
#include "filasofia/window/window.h"
#include "window/x11_person.h"

#include <chrono>
#include <csignal>
#include <functional>
#include <thread>

namespace sdl_window_test {

using namespace filasofia;
using namespace filasofia::event;
using namespace filasofia::window;

namespace {

/// Collects the events of a window until the one that a test waits for arrives (a real X server takes its time).
class Gathered {
public:
    explicit Gathered(window::Window& window) : window_(window) {}

    /// Returns the first event of class E that fits, and drops it and all before it; fails after a long wait.
    template <class E> E next(const std::function<bool(const E&)>& fits)
    {
        for (int tries = 0; tries < 2000; ++tries) {
            window_.poll([&](std::unique_ptr<Event> event) { events_.push_back(std::move(event)); });
            for (std::size_t i = 0; i < events_.size(); ++i) {
                const auto* typed = dynamic_cast<const E*>(events_[i].get());
                if (!typed || !fits(*typed)) continue;
                const E found = *typed;
                events_.erase(events_.begin(), events_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
                return found;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        throw std::runtime_error("the event did not come");
    }
    WindowEvent next(WindowEvent::Kind kind)
    {
        return next<WindowEvent>([&](const WindowEvent& event) { return event.kind == kind; });
    }

private:
    window::Window& window_;
    std::vector<std::unique_ptr<Event>> events_;
};

/// The X server updates a title in its own time: ask for at most 10 s.
bool titleBecomes(const std::string& title, Window& window, const Person& person)
{
    for (int i = 0; i < 1000 && person.title() != title; ++i) {
        window.poll([](std::unique_ptr<Event>) {});
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return person.title() == title;
}

} // namespace

TEST_CASE("a second thread opens a window when the first one has none left")
{
    const VirtualDisplay display;
    const auto elsewhere = [] {
        std::string problem = "none";
        std::thread([&] {
            try {
                openWindow({.width = 64, .height = 48});
            } catch (const Error& error) {
                problem = error.what();
            }
        }).join();
        return problem;
    };
    auto window = openWindow({.width = 64, .height = 48});
    CHECK_THAT(elsewhere(), Catch::Contains("another thread of this program has a window open"));
    CHECK(window->size() == WindowSize{64, 48}); // it is as it was
    window.reset();
    CHECK(elsewhere() == "none");
}

TEST_CASE("a window opens on an X display with the size and title that were asked for")
{
    const VirtualDisplay display;
    std::string why = "untouched";
    CHECK(displayAvailable(&why));
    CHECK(why == "untouched");
    const auto window = openWindow({.title = "Polypectomy", .width = 320, .height = 200, .resizable = false});
    CHECK(window->size() == WindowSize{320, 200});
    CHECK(window->scale() == 1.0);
    CHECK(!window->shouldClose());
    REQUIRE(window->nativeWindow() != nullptr);
    Gathered(*window).next(WindowEvent::Kind::Shown);
    const Person person(window->nativeWindow());
    CHECK(person.title() == "Polypectomy");
    CHECK(person.width() == 320);
    CHECK(!person.resizable());
    window->setTitle("Done");
    CHECK(titleBecomes("Done", *window, person));
}

TEST_CASE("a resize, a hidden window and a request to close arrive as window events")
{
    const VirtualDisplay display;
    const auto window = openWindow({.width = 320, .height = 200});
    Person person(window->nativeWindow());
    CHECK(person.resizable());
    Gathered gathered(*window);
    person.resize(400, 300);
    const auto resized =
        gathered.next<WindowEvent>([](const WindowEvent& event) { return event.kind == WindowEvent::Kind::Resized; });
    CHECK(resized.width == 400);
    CHECK(resized.height == 300);
    CHECK(window->size() == WindowSize{400, 300});
    person.minimize(true);
    gathered.next(WindowEvent::Kind::Hidden);
    person.minimize(false);
    gathered.next(WindowEvent::Kind::Shown);
    CHECK(!window->shouldClose());
    person.requestClose();
    gathered.next(WindowEvent::Kind::CloseRequested);
    CHECK(window->shouldClose());
}

TEST_CASE("keys arrive with their meaning and modifiers")
{
    const VirtualDisplay display;
    const auto window = openWindow({});
    Gathered gathered(*window);
    gathered.next(WindowEvent::Kind::Shown);
    Person person(window->nativeWindow());
    const auto next = [&](KeyCode key, bool pressed) {
        return gathered.next<KeyEvent>(
            [&](const KeyEvent& event) { return event.key == key && event.pressed == pressed; });
    };
    person.key("Escape", true);
    CHECK(next(KeyCode::Escape, true).modifiers == Modifiers{});
    person.key("Escape", false);
    next(KeyCode::Escape, false);
    person.key("Shift_L", true);
    CHECK(next(KeyCode::LeftShift, true).modifiers == Modifiers{.shift = true});
    person.key("a", true);
    CHECK(next(KeyCode::A, true).modifiers == Modifiers{.shift = true});
    person.key("a", false);
    next(KeyCode::A, false);
    person.key("Shift_L", false);
    CHECK(next(KeyCode::LeftShift, false).modifiers == Modifiers{});
}

TEST_CASE("typed letters and digits arrive as text while text is wanted, other keys do not")
{
    const VirtualDisplay display;
    const auto window = openWindow({});
    Gathered gathered(*window);
    gathered.next(WindowEvent::Kind::Shown);
    Person person(window->nativeWindow());
    const auto nextText = [&] { return gathered.next<TextInputEvent>([](const auto&) { return true; }).text; };
    person.key("a", true);
    person.key("a", false);
    gathered.next<KeyEvent>([](const KeyEvent& key) { return !key.pressed; });
    window->setTextInput(true);
    person.key("b", true);
    person.key("b", false);
    CHECK(nextText() == "b");   // the letter before was only a key
    person.key("Escape", true); // makes no text
    person.key("Escape", false);
    person.key("7", true);
    person.key("7", false);
    CHECK(nextText() == "7");
}

TEST_CASE("the mouse arrives with place, buttons and wheel")
{
    const VirtualDisplay display;
    const auto window = openWindow({});
    Gathered gathered(*window);
    gathered.next(WindowEvent::Kind::Shown);
    Person person(window->nativeWindow());
    const auto moveTo = [&](int x, int y) {
        person.moveMouse(x, y);
        return gathered.next<MouseMoveEvent>([&](const MouseMoveEvent& move) { return move.x == x && move.y == y; });
    };
    const auto nextButton = [&] { return gathered.next<MouseButtonEvent>([](const auto&) { return true; }); };
    const auto nextWheel = [&] { return gathered.next<MouseWheelEvent>([](const auto&) { return true; }); };
    moveTo(100, 50);
    CHECK(moveTo(130, 45).buttons == MouseButtons{});
    person.button(3, true);
    const MouseButtonEvent pressed = nextButton();
    CHECK(pressed.button == event::MouseButton::Right);
    CHECK(pressed.pressed);
    CHECK(pressed.x == 130.0);
    CHECK(pressed.y == 45.0);
    const MouseMoveEvent drag = moveTo(135, 50);
    CHECK(drag.buttons == MouseButtons{.right = true});
    CHECK(drag.dx == 5.0);
    CHECK(drag.dy == 5.0);
    person.button(3, false);
    CHECK(!nextButton().pressed);
    person.button(4, true);
    const MouseWheelEvent wheel = nextWheel();
    CHECK(wheel.dy == 1.0);
    CHECK(wheel.x == 135.0);
}

TEST_CASE("two windows get each its own events, and SDL lives as long as one of them")
{
    const VirtualDisplay display;
    auto left = openWindow({.title = "left"});
    auto right = openWindow({.title = "right"});
    CHECK(left->nativeWindow() != right->nativeWindow());
    Gathered ofLeft(*left), ofRight(*right);
    Person(left->nativeWindow()).resize(300, 100);
    // Polling the right window takes the left one's event out of SDL's queue, but not from the left window.
    Person(right->nativeWindow()).requestClose();
    ofRight.next(WindowEvent::Kind::CloseRequested);
    CHECK(ofLeft.next(WindowEvent::Kind::Resized).width == 300);
    CHECK(right->shouldClose());
    CHECK(!left->shouldClose());
    right.reset();
    Person(left->nativeWindow()).requestClose();
    ofLeft.next(WindowEvent::Kind::CloseRequested);
    left.reset();
    CHECK(openWindow({})->size() == WindowSize{960, 720}); // again from the start
}

TEST_CASE("without a display a window is an error of one line")
{
    const ScopedVariable none("DISPLAY", nullptr);
    std::string why;
    CHECK(!displayAvailable(&why));
    CHECK(why == "DISPLAY is not set; run on a desktop, under xvfb-run, or headless");
    CHECK_THROWS_WITH(openWindow({.title = "lost"}), "window 'lost': " + why);
}

TEST_CASE("a display that nobody serves is an error of one line, and a good one works after it")
{
    {
        const ScopedVariable wrong("DISPLAY", ":54321");
        CHECK_THROWS_AS(openWindow({}), Error);
        std::string why;
        CHECK(!displayAvailable(&why));
        CHECK(why.rfind("display ':54321' cannot be opened: ", 0) == 0);
        CHECK(why.find('\n') == std::string::npos);
    }
    const VirtualDisplay display;
    CHECK(openWindow({})->nativeWindow() != nullptr);
}

TEST_CASE("a video driver without X11 is an error, not a window that cannot be drawn into")
{
    const VirtualDisplay display;
    const ScopedVariable driver("SDL_VIDEODRIVER", "dummy");
    CHECK_THROWS_WITH(openWindow({.title = "x"}),
                      "window 'x': SDL_VIDEODRIVER must be x11, because the renderer draws through X11; got 'dummy'");
}

TEST_CASE("an open window leaves Ctrl-C to the program")
{
    const VirtualDisplay display;
    const auto handler = [] {
        struct sigaction now = {};
        sigaction(SIGINT, nullptr, &now);
        return now.sa_handler;
    };
    const auto before = std::signal(SIGINT, SIG_DFL);
    {
        const auto window = openWindow({});
        CHECK(handler() == SIG_DFL);
    }
    CHECK(handler() == SIG_DFL);
    std::signal(SIGINT, before);
}

} // namespace sdl_window_test
