#include "filasofia/window/sdl_events.h"

#include <algorithm>
#include <array>

namespace filasofia::window {
namespace {

using namespace event;

struct KeyPair {
    SDL_Keycode sdl;
    KeyCode ours;
};

// Letters, digits and function keys are consecutive in SDL as in KeyCode and are computed; these are the others.
constexpr std::array kKeys = {
    KeyPair{SDLK_ESCAPE, KeyCode::Escape},
    KeyPair{SDLK_RETURN, KeyCode::Enter},
    KeyPair{SDLK_TAB, KeyCode::Tab},
    KeyPair{SDLK_BACKSPACE, KeyCode::Backspace},
    KeyPair{SDLK_INSERT, KeyCode::Insert},
    KeyPair{SDLK_DELETE, KeyCode::Delete},
    KeyPair{SDLK_SPACE, KeyCode::Space},
    KeyPair{SDLK_LEFT, KeyCode::Left},
    KeyPair{SDLK_RIGHT, KeyCode::Right},
    KeyPair{SDLK_UP, KeyCode::Up},
    KeyPair{SDLK_DOWN, KeyCode::Down},
    KeyPair{SDLK_HOME, KeyCode::Home},
    KeyPair{SDLK_END, KeyCode::End},
    KeyPair{SDLK_PAGEUP, KeyCode::PageUp},
    KeyPair{SDLK_PAGEDOWN, KeyCode::PageDown},
    KeyPair{SDLK_MINUS, KeyCode::Minus},
    KeyPair{SDLK_EQUALS, KeyCode::Equals},
    KeyPair{SDLK_COMMA, KeyCode::Comma},
    KeyPair{SDLK_PERIOD, KeyCode::Period},
    KeyPair{SDLK_SLASH, KeyCode::Slash},
    KeyPair{SDLK_BACKSLASH, KeyCode::Backslash},
    KeyPair{SDLK_SEMICOLON, KeyCode::Semicolon},
    KeyPair{SDLK_QUOTE, KeyCode::Apostrophe},
    KeyPair{SDLK_LEFTBRACKET, KeyCode::LeftBracket},
    KeyPair{SDLK_RIGHTBRACKET, KeyCode::RightBracket},
    KeyPair{SDLK_BACKQUOTE, KeyCode::Grave},
    KeyPair{SDLK_LSHIFT, KeyCode::LeftShift},
    KeyPair{SDLK_RSHIFT, KeyCode::RightShift},
    KeyPair{SDLK_LCTRL, KeyCode::LeftControl},
    KeyPair{SDLK_RCTRL, KeyCode::RightControl},
    KeyPair{SDLK_LALT, KeyCode::LeftAlt},
    KeyPair{SDLK_RALT, KeyCode::RightAlt},
    KeyPair{SDLK_LGUI, KeyCode::LeftSuper},
    KeyPair{SDLK_RGUI, KeyCode::RightSuper},
    KeyPair{SDLK_CAPSLOCK, KeyCode::CapsLock},
    KeyPair{SDLK_NUMLOCKCLEAR, KeyCode::NumLock},
    KeyPair{SDLK_SCROLLLOCK, KeyCode::ScrollLock},
    KeyPair{SDLK_PRINTSCREEN, KeyCode::PrintScreen},
    KeyPair{SDLK_PAUSE, KeyCode::Pause},
    KeyPair{SDLK_APPLICATION, KeyCode::Menu},
    KeyPair{SDLK_KP_0, KeyCode::Keypad0}, // SDL puts 0 after 9
    KeyPair{SDLK_KP_PLUS, KeyCode::KeypadAdd},
    KeyPair{SDLK_KP_MINUS, KeyCode::KeypadSubtract},
    KeyPair{SDLK_KP_MULTIPLY, KeyCode::KeypadMultiply},
    KeyPair{SDLK_KP_DIVIDE, KeyCode::KeypadDivide},
    KeyPair{SDLK_KP_PERIOD, KeyCode::KeypadDecimal},
    KeyPair{SDLK_KP_ENTER, KeyCode::KeypadEnter},
};

struct KeyRow {
    SDL_Keycode first, last;
    KeyCode ours; // code of `first`
};
constexpr std::array kRows = {
    KeyRow{SDLK_a, SDLK_z, KeyCode::A},
    KeyRow{SDLK_0, SDLK_9, KeyCode::Digit0},
    KeyRow{SDLK_F1, SDLK_F12, KeyCode::F1},
    KeyRow{SDLK_KP_1, SDLK_KP_9, KeyCode::Keypad1},
};

Modifiers modifiersOf(int held)
{
    return {.shift = (held & KMOD_SHIFT) != 0,
            .control = (held & KMOD_CTRL) != 0,
            .alt = (held & KMOD_ALT) != 0,
            .super = (held & KMOD_GUI) != 0};
}

std::optional<MouseButton> mouseButton(Uint8 button)
{
    switch (button) {
    case SDL_BUTTON_LEFT:
        return MouseButton::Left;
    case SDL_BUTTON_MIDDLE:
        return MouseButton::Middle;
    case SDL_BUTTON_RIGHT:
        return MouseButton::Right;
    case SDL_BUTTON_X1:
        return MouseButton::Back;
    case SDL_BUTTON_X2:
        return MouseButton::Forward;
    default:
        return std::nullopt; // other buttons have no use in a simulator
    }
}

std::unique_ptr<Event> translateButton(const SDL_MouseButtonEvent& from, Modifiers held)
{
    const std::optional<MouseButton> button = mouseButton(from.button);
    if (!button) return nullptr;
    auto made = std::make_unique<MouseButtonEvent>();
    made->button = *button;
    made->pressed = from.state == SDL_PRESSED;
    made->x = from.x;
    made->y = from.y;
    made->modifiers = held;
    return made;
}

std::unique_ptr<Event> translateMove(const SDL_MouseMotionEvent& from, Modifiers held)
{
    auto made = std::make_unique<MouseMoveEvent>();
    made->x = from.x;
    made->y = from.y;
    made->dx = from.xrel;
    made->dy = from.yrel;
    made->buttons = {.left = (from.state & SDL_BUTTON_LMASK) != 0,
                     .middle = (from.state & SDL_BUTTON_MMASK) != 0,
                     .right = (from.state & SDL_BUTTON_RMASK) != 0,
                     .back = (from.state & SDL_BUTTON_X1MASK) != 0,
                     .forward = (from.state & SDL_BUTTON_X2MASK) != 0};
    made->modifiers = held;
    return made;
}

std::unique_ptr<Event> translateWheel(const SDL_MouseWheelEvent& from, Modifiers held)
{
    auto made = std::make_unique<MouseWheelEvent>();
    const double sign = from.direction == SDL_MOUSEWHEEL_FLIPPED ? -1.0 : 1.0;
    made->dx = sign * from.x;
    made->dy = sign * from.y;
    int x = 0, y = 0; // only newer versions of SDL store the position in the wheel's own event
    SDL_GetMouseState(&x, &y);
    made->x = x;
    made->y = y;
    made->modifiers = held;
    return made;
}

std::unique_ptr<Event> translateKey(const SDL_KeyboardEvent& from)
{
    auto made = std::make_unique<KeyEvent>();
    made->key = keyCode(from.keysym.sym);
    made->pressed = from.state == SDL_PRESSED;
    made->repeat = from.repeat != 0;
    made->modifiers = modifiersOf(from.keysym.mod);
    return made;
}

std::unique_ptr<Event> translateText(const SDL_TextInputEvent& from)
{
    if (from.text[0] == '\0') return nullptr; // a dead key that waits for the next key
    auto made = std::make_unique<TextInputEvent>();
    made->text = from.text;
    return made;
}

std::optional<WindowEvent::Kind> windowKind(Uint8 sdl)
{
    switch (sdl) {
    case SDL_WINDOWEVENT_SIZE_CHANGED: // sent for every change; RESIZED repeats some of them
        return WindowEvent::Kind::Resized;
    case SDL_WINDOWEVENT_CLOSE:
        return WindowEvent::Kind::CloseRequested;
    case SDL_WINDOWEVENT_FOCUS_GAINED:
        return WindowEvent::Kind::FocusGained;
    case SDL_WINDOWEVENT_FOCUS_LOST:
        return WindowEvent::Kind::FocusLost;
    case SDL_WINDOWEVENT_SHOWN:
    case SDL_WINDOWEVENT_RESTORED:
        return WindowEvent::Kind::Shown;
    case SDL_WINDOWEVENT_HIDDEN:
    case SDL_WINDOWEVENT_MINIMIZED:
        return WindowEvent::Kind::Hidden;
    default:
        return std::nullopt;
    }
}

std::unique_ptr<Event> translateWindow(std::optional<WindowEvent::Kind> kind)
{
    if (!kind) return nullptr;
    auto made = std::make_unique<WindowEvent>();
    made->kind = *kind;
    return made;
}

} // namespace

KeyCode keyCode(SDL_Keycode key)
{
    for (const KeyRow& row : kRows)
        if (key >= row.first && key <= row.last)
            return static_cast<KeyCode>(static_cast<int>(row.ours) + (key - row.first));
    const auto found = std::find_if(kKeys.begin(), kKeys.end(), [&](const KeyPair& pair) { return pair.sdl == key; });
    return found == kKeys.end() ? KeyCode::Unknown : found->ours;
}

Uint32 windowOf(const SDL_Event& event)
{
    switch (event.type) {
    case SDL_MOUSEBUTTONDOWN:
    case SDL_MOUSEBUTTONUP:
        return event.button.windowID;
    case SDL_MOUSEMOTION:
        return event.motion.windowID;
    case SDL_MOUSEWHEEL:
        return event.wheel.windowID;
    case SDL_KEYDOWN:
    case SDL_KEYUP:
        return event.key.windowID;
    case SDL_TEXTINPUT:
        return event.text.windowID;
    case SDL_WINDOWEVENT:
        return event.window.windowID;
    default:
        return 0;
    }
}

Modifiers heldAfter(const SDL_Event& event, Modifiers before)
{
    const bool isKey = event.type == SDL_KEYDOWN || event.type == SDL_KEYUP;
    return isKey ? modifiersOf(event.key.keysym.mod) : before;
}

std::unique_ptr<Event> translate(const SDL_Event& event, Modifiers held)
{
    switch (event.type) {
    case SDL_MOUSEBUTTONDOWN:
    case SDL_MOUSEBUTTONUP:
        return translateButton(event.button, held);
    case SDL_MOUSEMOTION:
        return translateMove(event.motion, held);
    case SDL_MOUSEWHEEL:
        return translateWheel(event.wheel, held);
    case SDL_KEYDOWN:
    case SDL_KEYUP:
        return translateKey(event.key);
    case SDL_TEXTINPUT:
        return translateText(event.text);
    case SDL_WINDOWEVENT:
        return translateWindow(windowKind(event.window.event));
    case SDL_QUIT: // the desktop session ends
        return translateWindow(WindowEvent::Kind::CloseRequested);
    default:
        return nullptr;
    }
}

} // namespace filasofia::window
