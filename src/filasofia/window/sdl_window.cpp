#include "filasofia/window/sdl_window.h"

#include "filasofia/core/assert.h"
#include "filasofia/core/error.h"
#include "filasofia/core/validate.h"
#include "filasofia/window/sdl_controllers.h"
#include "filasofia/window/sdl_events.h"

#include <SDL_syswm.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace filasofia::window {
namespace {

// SDL has one event queue for all windows; each window picks its own events here. One thread only (see SdlVideo).
std::vector<SdlWindow*> openWindows;
std::unique_ptr<SdlControllers> controllers; // exists while there is a window
event::Modifiers held;                       // by the keys of the events that have been taken

} // namespace

SdlWindow::SdlWindow(const WindowDef& def)
{
    Uint32 flags = SDL_WINDOW_SHOWN;
    if (def.resizable) flags |= SDL_WINDOW_RESIZABLE;
    // Not SDL_WINDOW_OPENGL: the renderer creates its own context and wants the display's default visual.
    window_ = SDL_CreateWindow(def.title.c_str(), SDL_WINDOWPOS_UNDEFINED, SDL_WINDOWPOS_UNDEFINED, def.width,
                               def.height, flags);
    if (!window_) fail("SDL cannot create it: ", std::string_view(SDL_GetError()));
    openWindows.push_back(this);
    if (!controllers) controllers = std::make_unique<SdlControllers>();
}

SdlWindow::~SdlWindow()
{
    std::erase(openWindows, this);
    if (openWindows.empty()) controllers.reset();
    SDL_DestroyWindow(window_);
}

void* SdlWindow::nativeWindow() const
{
    SDL_SysWMinfo info;
    SDL_VERSION(&info.version)
    const bool known = SDL_GetWindowWMInfo(window_, &info) == SDL_TRUE && info.subsystem == SDL_SYSWM_X11;
    FILASOFIA_ASSERT(known); // SdlVideo accepts only X11
    return reinterpret_cast<void*>(static_cast<std::uintptr_t>(info.info.x11.window));
}

WindowSize SdlWindow::size() const
{
    WindowSize size;
    SDL_GetWindowSize(window_, &size.width, &size.height); // in pixels: X11 has no other unit
    return size;
}

double SdlWindow::scale() const
{
    float dotsPerInch = 0.0f;
    const int display = SDL_GetWindowDisplayIndex(window_);
    if (display < 0 || SDL_GetDisplayDPI(display, &dotsPerInch, nullptr, nullptr) != 0) return 1.0;
    // Rounded to quarters, because monitors report their size only roughly, and text at 1.04 is only blurred.
    return std::clamp(std::round(4.0 * static_cast<double>(dotsPerInch) / 96.0) / 4.0, 1.0, 4.0);
}

void SdlWindow::poll(const event::EventSink& sink)
{
    pump();
    while (!waiting_.empty()) {
        std::unique_ptr<event::Event> event = std::move(waiting_.front());
        waiting_.pop_front();
        if (const auto* own = dynamic_cast<const event::WindowEvent*>(event.get()))
            shouldClose_ = shouldClose_ || own->kind == event::WindowEvent::Kind::CloseRequested;
        sink(std::move(event));
    }
}

void SdlWindow::pump()
{
    SDL_Event event;
    while (SDL_PollEvent(&event)) {
        held = heldAfter(event, held);
        if (auto done = controllers->take(event); done && !openWindows.empty()) {
            const auto focused = std::ranges::find_if(openWindows, [](const SdlWindow* window) {
                return (SDL_GetWindowFlags(window->window_) & SDL_WINDOW_INPUT_FOCUS) != 0;
            });
            (focused == openWindows.end() ? openWindows.front() : *focused)->waiting_.push_back(std::move(done));
        }
        const Uint32 id = windowOf(event);
        for (SdlWindow* window : openWindows)
            if (id == 0 || id == SDL_GetWindowID(window->window_)) window->take(event);
    }
}

void SdlWindow::take(const SDL_Event& from)
{
    std::unique_ptr<event::Event> made = translate(from, held);
    if (!made) return;
    if (auto* own = dynamic_cast<event::WindowEvent*>(made.get())) {
        const WindowSize now = size();
        own->width = now.width;
        own->height = now.height;
        // SDL sends both "minimized" and "hidden" for the same change.
        const bool appears = own->kind == event::WindowEvent::Kind::Shown;
        if ((appears || own->kind == event::WindowEvent::Kind::Hidden) && std::exchange(shown_, appears) == appears)
            return;
    }
    waiting_.push_back(std::move(made));
}

void SdlWindow::setTitle(const std::string& title) { SDL_SetWindowTitle(window_, title.c_str()); }

void SdlWindow::setTextInput(bool on)
{
    if (on == (SDL_IsTextInputActive() == SDL_TRUE)) return;
    if (on)
        SDL_StartTextInput();
    else
        SDL_StopTextInput();
}

std::unique_ptr<Window> openWindow(const WindowDef& def)
{
    const std::string object = text("window '", def.title, "'");
    validate(def, object);
    try {
        return std::make_unique<SdlWindow>(def);
    } catch (const Error& error) {
        fail(object, ": ", std::string_view(error.what()));
    }
}

bool displayAvailable(std::string* why)
{
    try {
        const SdlVideo video;
        return true;
    } catch (const Error& error) {
        if (why) *why = error.what();
        return false;
    }
}

} // namespace filasofia::window
