#include "filasofia/window/sdl_events.h"

#include <cstdio>
#include <set>

namespace sdl_events_test {

using namespace filasofia;
using namespace filasofia::window;
using event::KeyCode;

TEST_CASE("letters, digits, function and keypad keys keep their order")
{
    for (int i = 0; i < 26; ++i) CHECK(static_cast<int>(keyCode(SDLK_a + i)) == static_cast<int>(KeyCode::A) + i);
    for (int i = 0; i < 10; ++i) CHECK(static_cast<int>(keyCode(SDLK_0 + i)) == static_cast<int>(KeyCode::Digit0) + i);
    CHECK(keyCode(SDLK_F1) == KeyCode::F1);
    CHECK(keyCode(SDLK_F12) == KeyCode::F12);
    CHECK(keyCode(SDLK_KP_0) == KeyCode::Keypad0);
    CHECK(keyCode(SDLK_KP_1) == KeyCode::Keypad1);
    CHECK(keyCode(SDLK_KP_9) == KeyCode::Keypad9);
}

TEST_CASE("every key we have a name for is reached by a key of SDL, and by one only")
{
    std::multiset<KeyCode> reached;
    for (int scancode = 0; scancode < SDL_NUM_SCANCODES; ++scancode)
        reached.insert(keyCode(SDL_SCANCODE_TO_KEYCODE(scancode)));
    for (int character = 0; character < 128; ++character) reached.insert(keyCode(character));
    for (int key = 1; key <= static_cast<int>(KeyCode::KeypadEnter); ++key) {
        INFO("KeyCode " << key);
        CHECK(reached.count(static_cast<KeyCode>(key)) == 1);
    }
    CHECK(keyCode(SDLK_VOLUMEUP) == KeyCode::Unknown);
    CHECK(keyCode(0xe4) == KeyCode::Unknown); // a-umlaut
}

TEST_CASE("a pressed key's repeats and modifiers come along")
{
    SDL_Event from = {};
    from.type = SDL_KEYDOWN;
    from.key.type = SDL_KEYDOWN;
    from.key.state = SDL_PRESSED;
    from.key.repeat = 1;
    from.key.windowID = 7;
    from.key.keysym.sym = SDLK_SPACE;
    from.key.keysym.mod = KMOD_RCTRL | KMOD_LGUI | KMOD_NUM;
    CHECK(windowOf(from) == 7);
    const auto made = translate(from);
    const auto* key = dynamic_cast<const event::KeyEvent*>(made.get());
    REQUIRE(key);
    CHECK(key->key == KeyCode::Space);
    CHECK(key->pressed);
    CHECK(key->repeat);
    CHECK(key->modifiers == event::Modifiers{.control = true, .super = true});
}

TEST_CASE("a mouse move carries place, way and held buttons, a flipped wheel is set right")
{
    SDL_Event from = {};
    from.motion.type = SDL_MOUSEMOTION;
    from.motion.x = 12;
    from.motion.y = 34;
    from.motion.xrel = -5;
    from.motion.yrel = 6;
    from.motion.state = SDL_BUTTON_LMASK | SDL_BUTTON_X2MASK;
    auto made = translate(from);
    const auto* move = dynamic_cast<const event::MouseMoveEvent*>(made.get());
    REQUIRE(move);
    CHECK(move->x == 12.0);
    CHECK(move->y == 34.0);
    CHECK(move->dx == -5.0);
    CHECK(move->dy == 6.0);
    CHECK(move->buttons == event::MouseButtons{.left = true, .forward = true});

    from = {};
    from.wheel.type = SDL_MOUSEWHEEL;
    from.wheel.x = 1;
    from.wheel.y = -2;
    from.wheel.direction = SDL_MOUSEWHEEL_FLIPPED;
    made = translate(from);
    const auto* wheel = dynamic_cast<const event::MouseWheelEvent*>(made.get());
    REQUIRE(wheel);
    CHECK(wheel->dx == -1.0);
    CHECK(wheel->dy == 2.0);
}

TEST_CASE("an event of the mouse has the modifiers that were held when it came")
{
    const auto key = [](Uint32 type, Uint16 modifiers) {
        SDL_Event event = {};
        event.type = type;
        event.key.keysym.sym = SDLK_LCTRL;
        event.key.keysym.mod = modifiers;
        return event;
    };
    SDL_Event wheel = {}, move = {}, button = {};
    wheel.type = SDL_MOUSEWHEEL;
    move.type = SDL_MOUSEMOTION;
    button.type = SDL_MOUSEBUTTONDOWN;
    button.button.button = SDL_BUTTON_LEFT;
    const event::Modifiers none, control{.control = true};
    const event::Modifiers pressed = heldAfter(key(SDL_KEYDOWN, KMOD_LCTRL | KMOD_NUM), none);
    CHECK(pressed == control);
    for (const SDL_Event& event : {wheel, move, button}) CHECK(heldAfter(event, pressed) == control);
    CHECK(heldAfter(key(SDL_KEYUP, KMOD_NUM), pressed) == none);
    CHECK(dynamic_cast<const event::MouseWheelEvent&>(*translate(wheel, pressed)).modifiers == control);
    CHECK(dynamic_cast<const event::MouseMoveEvent&>(*translate(move, pressed)).modifiers == control);
    CHECK(dynamic_cast<const event::MouseButtonEvent&>(*translate(button, pressed)).modifiers == control);
    CHECK(dynamic_cast<const event::MouseWheelEvent&>(*translate(wheel, none)).modifiers == none);
}

TEST_CASE("typed text arrives as it was typed, a dead key alone does not")
{
    SDL_Event from = {};
    from.type = SDL_TEXTINPUT;
    from.text.windowID = 7;
    CHECK(windowOf(from) == 7);
    CHECK(!translate(from));
    std::snprintf(from.text.text, sizeof from.text.text, "%s", "\xc3\xa9"); // e with an acute accent
    const auto made = translate(from);
    const auto* typed = dynamic_cast<const event::TextInputEvent*>(made.get());
    REQUIRE(typed);
    CHECK(typed->text == "\xc3\xa9");
}

TEST_CASE("a sixth mouse button and a text being composed are none of our events, the end of the session is a request "
          "to close")
{
    SDL_Event from = {};
    from.button.type = SDL_MOUSEBUTTONDOWN;
    from.button.button = 6;
    CHECK(!translate(from));
    from = {};
    from.type = SDL_TEXTEDITING;
    CHECK(!translate(from));
    from = {};
    from.type = SDL_QUIT;
    CHECK(windowOf(from) == 0);
    const auto made = translate(from);
    const auto* close = dynamic_cast<const event::WindowEvent*>(made.get());
    REQUIRE(close);
    CHECK(close->kind == event::WindowEvent::Kind::CloseRequested);
}

} // namespace sdl_events_test
