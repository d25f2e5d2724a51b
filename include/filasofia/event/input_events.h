#pragma once

#include "filasofia/event/event.h"

#include <string>

/// The user's input to a window, as plain data that depends on no window library. Pixels are counted from the upper
/// left corner of the window's content, x to the right, y down.
namespace filasofia::event {

/// The modifier keys that are down when the event happens.
struct Modifiers {
    bool shift = false;
    bool control = false;
    bool alt = false;
    bool super = false;

    friend constexpr bool operator==(const Modifiers&, const Modifiers&) = default;
};

enum class MouseButton { Left, Middle, Right, Back, Forward };

/// The mouse buttons that are down while the mouse moves.
struct MouseButtons {
    bool left = false;
    bool middle = false;
    bool right = false;
    bool back = false;
    bool forward = false;

    friend constexpr bool operator==(const MouseButtons&, const MouseButtons&) = default;
};

/// A button was pressed or released.
class MouseButtonEvent final : public Event {
public:
    static constexpr EventType kType = EventType::MouseButton;
    MouseButtonEvent() : Event(kType) {}

    MouseButton button = MouseButton::Left;
    bool pressed = false;
    double x = 0.0; ///< [px]
    double y = 0.0; ///< [px]
    Modifiers modifiers;
};

/// The mouse moved. Merges: the newest position wins, the displacements add up.
class MouseMoveEvent final : public Event {
public:
    static constexpr EventType kType = EventType::MouseMove;
    MouseMoveEvent() : Event(kType) {}
    [[nodiscard]] std::optional<MergeKey> mergeKey() const override { return MergeKey{type}; }
    void absorb(const Event& older) noexcept override;

    double x = 0.0;  ///< [px]
    double y = 0.0;  ///< [px]
    double dx = 0.0; ///< [px], since the last MouseMoveEvent that was delivered
    double dy = 0.0; ///< [px]
    MouseButtons buttons;
    Modifiers modifiers;
};

/// The wheel turned. Does not merge, because every notch counts.
class MouseWheelEvent final : public Event {
public:
    static constexpr EventType kType = EventType::MouseWheel;
    MouseWheelEvent() : Event(kType) {}

    double dx = 0.0; ///< [notches], positive to the right
    double dy = 0.0; ///< [notches], positive away from the user
    double x = 0.0;  ///< [px], position of the mouse
    double y = 0.0;  ///< [px]
    Modifiers modifiers;
};

/// A key by its meaning in the user's keyboard layout.
// clang-format off
enum class KeyCode {
    Unknown,
    A, B, C, D, E, F, G, H, I, J, K, L, M, N, O, P, Q, R, S, T, U, V, W, X, Y, Z,
    Digit0, Digit1, Digit2, Digit3, Digit4, Digit5, Digit6, Digit7, Digit8, Digit9,
    F1, F2, F3, F4, F5, F6, F7, F8, F9, F10, F11, F12,
    Escape, Enter, Tab, Backspace, Insert, Delete, Space,
    Left, Right, Up, Down, Home, End, PageUp, PageDown,
    Minus, Equals, Comma, Period, Slash, Backslash, Semicolon, Apostrophe, LeftBracket, RightBracket, Grave,
    LeftShift, RightShift, LeftControl, RightControl, LeftAlt, RightAlt, LeftSuper, RightSuper,
    CapsLock, NumLock, ScrollLock, PrintScreen, Pause, Menu,
    Keypad0, Keypad1, Keypad2, Keypad3, Keypad4, Keypad5, Keypad6, Keypad7, Keypad8, Keypad9,
    KeypadAdd, KeypadSubtract, KeypadMultiply, KeypadDivide, KeypadDecimal, KeypadEnter,
};
// clang-format on

/// A key was pressed or released, or is held long enough to repeat.
class KeyEvent final : public Event {
public:
    static constexpr EventType kType = EventType::Key;
    KeyEvent() : Event(kType) {}

    KeyCode key = KeyCode::Unknown;
    bool pressed = false;
    bool repeat = false; ///< pressed again by the keyboard, not by the user
    Modifiers modifiers; ///< a modifier's own event includes the modifier when it is pressed
};

/// The user typed text: the result of keyboard layout and dead keys, sent in addition to the key events.
class TextInputEvent final : public Event {
public:
    static constexpr EventType kType = EventType::TextInput;
    TextInputEvent() : Event(kType) {}

    std::string text; ///< UTF-8; usually one character
};

/// Something happened to the window itself.
class WindowEvent final : public Event {
public:
    static constexpr EventType kType = EventType::Window;
    enum class Kind { Resized, CloseRequested, FocusGained, FocusLost, Shown, Hidden };
    WindowEvent() : Event(kType) {}

    Kind kind = Kind::Resized;
    int width = 0;  ///< [px], current width of the window's content, for every kind
    int height = 0; ///< [px]
};

} // namespace filasofia::event
