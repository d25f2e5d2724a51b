#include "filasofia/window/sdl_video.h"

#include "filasofia/core/assert.h"
#include "filasofia/core/error.h"

#include <cstdlib>
#include <mutex>
#include <optional>
#include <string_view>
#include <thread>

namespace filasofia::window {
namespace {

std::mutex guard;
std::optional<std::thread::id>
    owner; // the thread of the first SdlVideo, while there is one; under the lock, like users
int users = 0;

std::string_view environment(const char* variable)
{
    const char* value = std::getenv(variable);
    return value ? value : "";
}

// Each hint has an environment variable of the same name, which the user may set: that one wins.
void setHints()
{
    SDL_SetHint(SDL_HINT_VIDEODRIVER, "x11");             // the renderer draws through GLX, under Wayland too
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");        // the program handles Ctrl-C
    SDL_SetHint(SDL_HINT_QUIT_ON_LAST_WINDOW_CLOSE, "0"); // one request to close is enough
    // Without it, SDL 2.26 swallows the first click after the window got the focus, however long ago and however it got
    // it.
    SDL_SetHint(SDL_HINT_MOUSE_FOCUS_CLICKTHROUGH, "1");
    SDL_SetHint(SDL_HINT_VIDEO_X11_NET_WM_BYPASS_COMPOSITOR,
                "0"); // this is an ordinary window: leave the desktop's compositor on
}

void openVideo()
{
    setHints();
    const char* driver = SDL_GetHint(SDL_HINT_VIDEODRIVER);
    if (std::string_view(driver ? driver : "") == "x11" && environment("DISPLAY").empty())
        fail("DISPLAY is not set; run on a desktop, under xvfb-run, or headless");
    if (SDL_InitSubSystem(SDL_INIT_VIDEO) != 0)
        fail("display '", environment("DISPLAY"), "' cannot be opened: ", std::string_view(SDL_GetError()));
    const std::string_view opened = SDL_GetCurrentVideoDriver();
    if (opened != "x11") {
        const std::string name(opened); // SDL's own text disappears with the driver
        SDL_QuitSubSystem(SDL_INIT_VIDEO);
        fail("SDL_VIDEODRIVER must be x11, because the renderer draws through X11; got '", name, "'");
    }
    // SDL starts with text input on, in which an input method may swallow keys: see Window::setTextInput().
    SDL_StopTextInput();
}

} // namespace

SdlVideo::SdlVideo()
{
    const std::lock_guard lock(guard);
    if (owner && *owner != std::this_thread::get_id())
        fail("another thread of this program has a window open; close that one first, or open both on one thread");
    if (users == 0) openVideo();
    owner = std::this_thread::get_id();
    ++users;
}

SdlVideo::~SdlVideo()
{
    const std::lock_guard lock(guard);
    FILASOFIA_ASSERT(owner == std::this_thread::get_id());
    if (--users > 0) return;
    // Not SDL_Quit(), because the application may use other parts of SDL.
    SDL_QuitSubSystem(SDL_INIT_VIDEO);
    owner.reset();
}

} // namespace filasofia::window
