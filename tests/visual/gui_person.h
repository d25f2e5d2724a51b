#pragma once

#include "filasofia/event/input_events.h"
#include "filasofia/visual/visual_server.h"

namespace filasofia::visual {

/// A person at mouse and keyboard of a server without a window. Every call returns whether a Gui took it.
class GuiPerson {
public:
    explicit GuiPerson(VisualServer& server) : server_(server) {}

    bool move(double x, double y)
    {
        event::MouseMoveEvent move;
        move.x = x_ = x;
        move.y = y_ = y;
        move.buttons.left = held_;
        return server_.handle(move);
    }
    bool press(bool down = true, event::MouseButton button = event::MouseButton::Left)
    {
        event::MouseButtonEvent press;
        press.button = button;
        press.pressed = down;
        press.x = x_;
        press.y = y_;
        if (button == event::MouseButton::Left) held_ = down;
        return server_.handle(press);
    }
    bool release() { return press(false); }
    void click(double x, double y)
    {
        move(x, y);
        press();
        release();
    }
    bool wheel(double notches)
    {
        event::MouseWheelEvent wheel;
        wheel.dy = notches;
        wheel.x = x_;
        wheel.y = y_;
        return server_.handle(wheel);
    }
    bool key(event::KeyCode code, bool down, event::Modifiers held = {})
    {
        event::KeyEvent key;
        key.key = code;
        key.pressed = down;
        key.modifiers = held;
        return server_.handle(key);
    }
    void stroke(event::KeyCode code, event::Modifiers held = {})
    {
        key(code, true, held);
        key(code, false, held);
    }
    bool type(const std::string& text)
    {
        event::TextInputEvent typed;
        typed.text = text;
        return server_.handle(typed);
    }
    /// Draws frames until all input has been seen.
    void look(int frames = 4)
    {
        for (int i = 0; i < frames; ++i) server_.render();
    }

private:
    VisualServer& server_;
    double x_ = 0.0, y_ = 0.0;
    bool held_ = false;
};

} // namespace filasofia::visual
