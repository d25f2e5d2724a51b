#pragma once

#include <filasofia/core/error.h>
#include <filasofia/event/input_events.h>
#include <filasofia/window/window.h>

#include <array>
#include <deque>

// Last: the X11 headers behind it define macros.
#define GLFW_EXPOSE_NATIVE_X11
#include <GLFW/glfw3.h>
#include <GLFW/glfw3native.h>

/// A window of GLFW for Filasofia, to be copied into an application. Main thread only, as GLFW asks; one at a time.
class GlfwWindow final : public filasofia::window::Window {
public:
    explicit GlfwWindow(const filasofia::window::WindowDef& def)
    {
        if (!glfwInit()) filasofia::fail("window '", def.title, "': GLFW finds no X display");
        glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API); // the renderer makes its own context
        glfwWindowHint(GLFW_RESIZABLE, def.resizable);
        window_ = glfwCreateWindow(def.width, def.height, def.title.c_str(), nullptr, nullptr);
        if (!window_) filasofia::fail("window '", def.title, "': GLFW cannot make it");
        glfwSetWindowUserPointer(window_, this);
        listen();
    }
    ~GlfwWindow() override { glfwTerminate(); }

    // The renderer needs no more than this.
    void* nativeWindow() const override { return reinterpret_cast<void*>(glfwGetX11Window(window_)); }

    // The rest is for the person at the window.
    void setTitle(const std::string& title) override { glfwSetWindowTitle(window_, title.c_str()); }
    bool shouldClose() const override { return glfwWindowShouldClose(window_); }
    void poll(const filasofia::event::EventSink& sink) override
    {
        glfwPollEvents();
        for (; !waiting_.empty(); waiting_.pop_front()) sink(std::move(waiting_.front()));
    }

private:
    template <class E> static void add(GLFWwindow* from, E event)
    {
        GlfwWindow& self = *static_cast<GlfwWindow*>(glfwGetWindowUserPointer(from));
        if constexpr (requires { event.x; }) glfwGetCursorPos(from, &event.x, &event.y);
        if constexpr (requires { event.buttons; }) {
            event.dx = event.x - std::exchange(self.x_, event.x);
            event.dy = event.y - std::exchange(self.y_, event.y);
            event.buttons = {.left = glfwGetMouseButton(from, 0) != 0, .right = glfwGetMouseButton(from, 1) != 0};
        }
        self.waiting_.push_back(std::make_unique<E>(std::move(event)));
    }
    template <class E> static E made(bool pressed, int held)
    {
        E event;
        event.pressed = pressed;
        event.modifiers = {(held & GLFW_MOD_SHIFT) != 0, (held & GLFW_MOD_CONTROL) != 0, (held & GLFW_MOD_ALT) != 0};
        return event;
    }
    static filasofia::event::KeyCode keyCode(int key)
    {
        using enum filasofia::event::KeyCode;
        constexpr std::array rows = {std::tuple{GLFW_KEY_A, 26, A},        std::tuple{GLFW_KEY_0, 10, Digit0},
                                     std::tuple{GLFW_KEY_F1, 12, F1},      std::tuple{GLFW_KEY_SPACE, 1, Space},
                                     std::tuple{GLFW_KEY_ENTER, 1, Enter}, std::tuple{GLFW_KEY_ESCAPE, 1, Escape}};
        for (const auto& [first, count, ours] : rows)
            if (key >= first && key < first + count)
                return static_cast<filasofia::event::KeyCode>(static_cast<int>(ours) + key - first);
        return Unknown; // KeyCode has more: add those that the application uses
    }
    void listen()
    {
        using namespace filasofia::event;
        glfwGetCursorPos(window_, &x_, &y_);
        glfwSetCursorPosCallback(window_, [](GLFWwindow* from, double, double) { add(from, MouseMoveEvent()); });
        glfwSetMouseButtonCallback(window_, [](GLFWwindow* from, int button, int action, int held) {
            auto event = made<MouseButtonEvent>(action == GLFW_PRESS, held);
            event.button = button == 0 ? MouseButton::Left : button == 1 ? MouseButton::Right : MouseButton::Middle;
            add(from, event);
        });
        glfwSetScrollCallback(window_, [](GLFWwindow* from, double dx, double dy) {
            MouseWheelEvent event;
            event.dx = dx;
            event.dy = dy;
            add(from, event);
        });
        glfwSetKeyCallback(window_, [](GLFWwindow* from, int key, int, int action, int held) {
            auto event = made<KeyEvent>(action != GLFW_RELEASE, held);
            event.key = keyCode(key);
            event.repeat = action == GLFW_REPEAT;
            add(from, event);
        });
    }

    GLFWwindow* window_ = nullptr;
    double x_ = 0.0, y_ = 0.0; ///< [px], the mouse's place at its last event
    std::deque<std::unique_ptr<filasofia::event::Event>> waiting_;
};
