#pragma once

#include <SDL.h>

#include <string>

namespace filasofia::window {

/// SDL's video subsystem, initialised while at least one of these objects exists. All must live on one thread.
class SdlVideo {
public:
    SdlVideo(); ///< throws an Error that says why there is no X display, or that another thread has the windows
    ~SdlVideo();
    SdlVideo(const SdlVideo&) = delete;
    SdlVideo& operator=(const SdlVideo&) = delete;
};

} // namespace filasofia::window
