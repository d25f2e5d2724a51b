#pragma once

#include "filasofia/event/input_events.h"

#include <SDL.h>

#include <optional>

namespace filasofia::window {

/// The window that an SDL event is about; 0 if SDL does not say (such as a key while none of our windows has the
/// focus).
Uint32 windowOf(const SDL_Event& event);

/// The event as one of our types; nullptr if it is none of them. The window fills in the size of a WindowEvent.
std::unique_ptr<event::Event> translate(const SDL_Event& event);

/// Unknown if the key has no name here.
event::KeyCode keyCode(SDL_Keycode key);

} // namespace filasofia::window
