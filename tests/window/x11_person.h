#pragma once

#include <memory>
#include <string>

/// An X server for tests and a simulated user in front of it. Xlib's macros stay behind this header.
namespace filasofia::window {

/// Sets an environment variable while this object exists (nullptr: unset).
class ScopedVariable {
public:
    ScopedVariable(const char* name, const char* value);
    ~ScopedVariable();
    ScopedVariable(const ScopedVariable&) = delete;
    ScopedVariable& operator=(const ScopedVariable&) = delete;

private:
    std::string name_;
    std::unique_ptr<std::string> before_;
};

/// Xvfb on a free display, named by DISPLAY while this object exists. Throws if Xvfb is not installed or does not
/// start.
class VirtualDisplay {
public:
    VirtualDisplay();
    ~VirtualDisplay();

private:
    int process_ = 0;
    std::unique_ptr<ScopedVariable> variable_;
};

/// What a user and a window manager do to a window. Every call has reached the X server when it returns.
class Person {
public:
    explicit Person(void* nativeWindow);
    ~Person();

    void moveMouse(int x, int y); ///< to a position in the window
    void button(int number, bool pressed);
    void key(const char* name, bool pressed); ///< X's name of the key: "a", "Shift_L"
    void resize(int width, int height);
    void requestClose();
    void minimize(bool hidden);
    [[nodiscard]] std::string title() const; ///< as the window manager sees it
    [[nodiscard]] bool resizable() const;    ///< the window manager may change the size
    [[nodiscard]] int width() const;         ///< as the X server knows it

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::window
