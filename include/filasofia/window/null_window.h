#pragma once

#include "filasofia/window/window.h"

#include <deque>

namespace filasofia::window {

/// An invisible window for tests and for runs without a display. Input events are injected by the program.
class NullWindow final : public Window {
public:
    /// Throws an Error if a field is outside its range.
    explicit NullWindow(const WindowDef& def = {});

    /// The next poll() delivers the event, after all events injected before. A WindowEvent also takes effect then:
    /// Resized changes size(), and CloseRequested makes shouldClose() true.
    void inject(std::unique_ptr<event::Event> event);

    [[nodiscard]] void* nativeWindow() const override { return nullptr; }
    [[nodiscard]] WindowSize size() const override { return size_; }
    [[nodiscard]] double scale() const override { return 1.0; }
    void poll(const event::EventSink& sink) override;
    [[nodiscard]] bool shouldClose() const override { return shouldClose_; }
    void setTitle(const std::string& title) override { title_ = title; }
    [[nodiscard]] const std::string& title() const { return title_; }
    void setTextInput(bool on) override { textInput_ = on; }
    [[nodiscard]] bool textInput() const { return textInput_; }

private:
    std::string title_;
    WindowSize size_;
    bool shouldClose_ = false;
    bool textInput_ = false;
    std::deque<std::unique_ptr<event::Event>> injected_;
};

} // namespace filasofia::window
