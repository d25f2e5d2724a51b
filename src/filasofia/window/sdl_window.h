#pragma once

#include "filasofia/window/sdl_video.h"
#include "filasofia/window/window.h"

#include <deque>

namespace filasofia::window {

/// An SDL window on an X display.
class SdlWindow final : public Window {
public:
    explicit SdlWindow(const WindowDef& def);
    ~SdlWindow() override;

    [[nodiscard]] void* nativeWindow() const override;
    [[nodiscard]] WindowSize size() const override;
    [[nodiscard]] double scale() const override;
    void poll(const event::EventSink& sink) override;
    [[nodiscard]] bool shouldClose() const override { return shouldClose_; }
    void setTitle(const std::string& title) override;
    void setTextInput(bool on) override;

private:
    static void pump();
    void take(const SDL_Event& event);

    SdlVideo video_; // first member, because a window needs it
    SDL_Window* window_ = nullptr;
    bool shown_ = false;
    bool shouldClose_ = false;
    std::deque<std::unique_ptr<event::Event>> waiting_;
};

} // namespace filasofia::window
