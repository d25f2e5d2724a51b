#pragma once

#include <SDL.h>

#include <string>

namespace filasofia::window {

/// SDL's video part, alive while at least one of these is. All live in one thread.
class SdlVideo {
public:
    SdlVideo(); ///< throws an Error that says why there is no X display
    ~SdlVideo();
    SdlVideo(const SdlVideo&) = delete;
    SdlVideo& operator=(const SdlVideo&) = delete;
};

} // namespace filasofia::window
