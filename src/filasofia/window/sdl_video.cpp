#include "filasofia/window/sdl_video.h"

#include "filasofia/core/assert.h"
#include "filasofia/core/error.h"

#include <cstdlib>
#include <optional>
#include <string_view>
#include <thread>

namespace filasofia::window {
namespace {

std::optional<std::thread::id> owner; // the thread of the first SdlVideo, while there is one
int users = 0;

std::string_view environment(const char* variable)
{
    const char* value = std::getenv(variable);
    return value ? value : "";
}

// Each stands behind an environment variable of the same name, which the person at the desk may set: that one wins.
void setHints()
{
    SDL_SetHint(SDL_HINT_VIDEODRIVER, "x11");             // the renderer draws through GLX, under Wayland as well
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");        // Ctrl-C is the program's
    SDL_SetHint(SDL_HINT_QUIT_ON_LAST_WINDOW_CLOSE, "0"); // one request to close is enough
    // Else SDL 2.26 swallows the first click after the focus came, however long ago and however it came.
    SDL_SetHint(SDL_HINT_MOUSE_FOCUS_CLICKTHROUGH, "1");
    SDL_SetHint(SDL_HINT_VIDEO_X11_NET_WM_BYPASS_COMPOSITOR, "0"); // one window: leave the desktop as it is
}

void openVideo()
{
    setHints();
    const char* driver = SDL_GetHint(SDL_HINT_VIDEODRIVER);
    if (std::string_view(driver ? driver : "") == "x11" && environment("DISPLAY").empty())
        fail("DISPLAY is not set: run on a desktop, under xvfb-run, or headless");
    if (SDL_InitSubSystem(SDL_INIT_VIDEO) != 0)
        fail("display '", environment("DISPLAY"), "' cannot be opened: ", std::string_view(SDL_GetError()));
    const std::string_view opened = SDL_GetCurrentVideoDriver();
    if (opened != "x11") {
        const std::string name(opened); // SDL's own text goes with the driver
        SDL_QuitSubSystem(SDL_INIT_VIDEO);
        fail("the renderer draws through X11, but SDL_VIDEODRIVER asks for '", name, "'");
    }
    // SDL begins in a mode in which an input method may swallow keys: see Window::setTextInput().
    SDL_StopTextInput();
}

} // namespace

SdlVideo::SdlVideo()
{
    FILASOFIA_ASSERT(!owner || *owner == std::this_thread::get_id());
    if (users == 0) openVideo();
    owner = std::this_thread::get_id();
    ++users;
}

SdlVideo::~SdlVideo()
{
    FILASOFIA_ASSERT(owner == std::this_thread::get_id());
    if (--users > 0) return;
    // Not SDL_Quit(): the application may use other parts of SDL.
    SDL_QuitSubSystem(SDL_INIT_VIDEO);
    owner.reset();
}

} // namespace filasofia::window
