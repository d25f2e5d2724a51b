#include "filasofia/runtime/person_input.h"

namespace person_input_test {

using namespace filasofia;
using namespace filasofia::event;
using filasofia::runtime::PersonInputReader;

namespace {

template <class E> E with(auto&& change)
{
    E event;
    change(event);
    return event;
}

KeyEvent key(KeyCode code, bool pressed)
{
    return with<KeyEvent>([&](KeyEvent& e) { e.key = code, e.pressed = pressed; });
}
MouseButtonEvent button(MouseButton which, bool pressed)
{
    return with<MouseButtonEvent>([&](MouseButtonEvent& e) { e.button = which, e.pressed = pressed; });
}

} // namespace

TEST_CASE("the mouse moves the hand while its right button is held, and only then")
{
    PersonInputReader reader;
    const auto move = with<MouseMoveEvent>([](MouseMoveEvent& e) { e.dx = 3, e.dy = 4; });
    const auto wheel = with<MouseWheelEvent>([](MouseWheelEvent& e) { e.dy = 2; });
    CHECK_FALSE(reader.read(move));
    CHECK_FALSE(reader.read(wheel)); // both are the camera's
    CHECK_FALSE(reader.read(button(MouseButton::Left, true)));
    CHECK(reader.read(button(MouseButton::Right, true)));
    CHECK(reader.read(move)->moved == Vec3{3, -4, 0});
    CHECK(reader.read(wheel)->moved == Vec3{0, 0, -20}); // away from the person
    CHECK(reader.read(button(MouseButton::Left, true))->buttons == 1u);
    CHECK(reader.read(button(MouseButton::Left, false))->buttons == 0u);
    CHECK_FALSE(reader.read(button(MouseButton::Middle, true)));
    CHECK(reader.read(button(MouseButton::Right, false)));
    CHECK_FALSE(reader.read(move));
}

TEST_CASE("with Ctrl the mouse turns the hand: its tip goes where the mouse goes")
{
    PersonInputReader reader;
    const auto withControl = [](auto event) {
        event.modifiers.control = true;
        return event;
    };
    CHECK(reader.read(button(MouseButton::Right, true)));
    const auto move = reader.read(withControl(with<MouseMoveEvent>([](MouseMoveEvent& e) { e.dx = 3, e.dy = -4; })));
    CHECK(move->turned == Vec3{4, -3, 0}); // about x: -z goes up; about -y: to the right
    CHECK(move->moved == Vec3{});
    const auto wheel = reader.read(withControl(with<MouseWheelEvent>([](MouseWheelEvent& e) { e.dy = 2; })));
    CHECK(wheel->turned == Vec3{0, 0, 20});
}

TEST_CASE("keys push as long as they are held, and a window that is left lets go")
{
    PersonInputReader reader;
    CHECK(reader.read(key(KeyCode::Left, true))->push == Vec3{-1, 0, 0});
    CHECK(reader.read(key(KeyCode::PageUp, true))->push == Vec3{-1, 0, -1});
    CHECK(reader.read(key(KeyCode::Left, false))->push == Vec3{0, 0, -1});
    CHECK_FALSE(reader.read(key(KeyCode::Space, true)));
    auto withControl = key(KeyCode::Right, true);
    withControl.modifiers.control = true;
    CHECK_FALSE(reader.read(withControl));
    const auto left = with<WindowEvent>([](WindowEvent& e) { e.kind = WindowEvent::Kind::FocusLost; });
    CHECK(reader.read(left)->push == Vec3{});
    CHECK_FALSE(reader.read(left));
}

} // namespace person_input_test
