#pragma once

#include "filasofia/event/input_events.h"

#include <SDL.h>

#include <optional>

namespace filasofia::window {

/// The window an SDL event is about: 0 where SDL does not say (a key while no window of ours has the focus).
Uint32 windowOf(const SDL_Event& event);

/// The event in our words; nullptr where it is none of our kinds. A WindowEvent's size is left to the window.
std::unique_ptr<event::Event> translate(const SDL_Event& event);

/// Unknown where we have no name for it.
event::KeyCode keyCode(SDL_Keycode key);

} // namespace filasofia::window
