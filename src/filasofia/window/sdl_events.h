#pragma once

#include "filasofia/event/input_events.h"

#include <SDL.h>

#include <optional>

namespace filasofia::window {

/// The window that an SDL event is about; 0 if SDL does not say (such as a key while none of our windows has the
/// focus).
Uint32 windowOf(const SDL_Event& event);

/// The modifier keys that are held after an event, if those were held `before` it.
event::Modifiers heldAfter(const SDL_Event& event, event::Modifiers before);

/// The event as one of our types; nullptr if it is none of them. The window fills in the size of a WindowEvent. `held`:
/// the modifiers of an event of the mouse. SDL tells only which are held now, after all events that wait: where a
/// picture takes a second, a wheel that was turned before Ctrl was pressed would turn the hand of a person.
std::unique_ptr<event::Event> translate(const SDL_Event& event, event::Modifiers held = {});

/// Unknown if the key has no name here.
event::KeyCode keyCode(SDL_Keycode key);

} // namespace filasofia::window
