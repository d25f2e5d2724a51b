// The adapter of examples/13_glfw, with a person at it.
#include "filasofia/core/error.h"
#include "window/x11_person.h"

#include <chrono>
#include <functional>
#include <thread>

#include "../examples/13_glfw/glfw_window.h"

namespace glfw_window_test {

using namespace filasofia;
using namespace filasofia::event;
using filasofia::window::Person;
using filasofia::window::ScopedVariable;
using filasofia::window::VirtualDisplay;

namespace {

/// The first event of class E that fits; all before it are dropped. Fails after a long wait.
template <class E> E next(GlfwWindow& window, const std::function<bool(const E&)>& fits)
{
    std::optional<E> found;
    for (int tries = 0; tries < 2000 && !found; ++tries) {
        window.poll([&](std::unique_ptr<Event> event) {
            const auto* typed = dynamic_cast<const E*>(event.get());
            if (typed && !found && fits(*typed)) found = *typed;
        });
        if (!found) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    if (!found) throw std::runtime_error("the event did not come");
    return *found;
}

} // namespace

TEST_CASE("a window of GLFW has the size asked for, its title, and says when it is to close")
{
    const VirtualDisplay display;
    GlfwWindow window({.title = "Polypectomy", .width = 320, .height = 200});
    REQUIRE(window.nativeWindow() != nullptr);
    CHECK(window.size() == filasofia::window::WindowSize{320, 200});
    Person person(window.nativeWindow());
    CHECK(person.title() == "Polypectomy");
    person.resize(400, 300);
    CHECK(person.width() == 400);
    CHECK(window.size() == filasofia::window::WindowSize{400, 300});
    CHECK(!window.shouldClose());
    person.requestClose();
    for (int tries = 0; tries < 2000 && !window.shouldClose(); ++tries) {
        window.poll([](std::unique_ptr<Event>) {});
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    CHECK(window.shouldClose());
}

TEST_CASE("mouse, wheel and keys at a window of GLFW arrive as events")
{
    const VirtualDisplay display;
    GlfwWindow window({.width = 320, .height = 200});
    Person person(window.nativeWindow());
    person.moveMouse(20, 30);
    next<MouseMoveEvent>(window, [](const MouseMoveEvent& e) { return e.x == 20 && e.y == 30; });
    person.button(1, true);
    const auto pressed = next<MouseButtonEvent>(window, [](const MouseButtonEvent& e) { return e.pressed; });
    CHECK(pressed.button == MouseButton::Left);
    CHECK((pressed.x == 20 && pressed.y == 30));
    person.moveMouse(50, 40);
    const auto moved = next<MouseMoveEvent>(window, [](const MouseMoveEvent& e) { return e.x == 50; });
    CHECK((moved.dx == 30 && moved.dy == 10));
    CHECK((moved.buttons.left && !moved.buttons.right));
    person.button(1, false);
    next<MouseButtonEvent>(window, [](const MouseButtonEvent& e) { return !e.pressed; });
    person.button(4, true); // X calls the wheel so
    person.button(4, false);
    CHECK(next<MouseWheelEvent>(window, [](const MouseWheelEvent&) { return true; }).dy == 1.0);
    using Key = event::KeyCode; // Xlib has another
    const std::vector<std::pair<const char*, Key>> keys = {
        {"b", Key::B}, {"7", Key::Digit7}, {"F12", Key::F12}, {"space", Key::Space}, {"Escape", Key::Escape}};
    for (const auto& [name, key] : keys) {
        person.key(name, true);
        CHECK(next<KeyEvent>(window, [](const KeyEvent& e) { return e.pressed; }).key == key);
        person.key(name, false);
        next<KeyEvent>(window, [](const KeyEvent& e) { return !e.pressed; });
    }
}

TEST_CASE("without a display a window of GLFW is an error of one line")
{
    const ScopedVariable none("DISPLAY", nullptr);
    CHECK_THROWS_WITH(GlfwWindow({.title = "lost"}), "window 'lost': GLFW finds no X display");
}

} // namespace glfw_window_test
