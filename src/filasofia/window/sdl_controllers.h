#pragma once

#include "filasofia/event/controller_event.h"

#include <SDL.h>

#include <memory>
#include <vector>

namespace filasofia::window {

/// Game controllers and six-axis controllers found by SDL: opened when they are connected, closed when they are
/// removed. If SDL cannot read controllers, there are none.
class SdlControllers {
public:
    SdlControllers();
    ~SdlControllers();
    SdlControllers(const SdlControllers&) = delete;
    SdlControllers& operator=(const SdlControllers&) = delete;

    /// The event of an open controller that an SDL event leads to; nullptr if there is none.
    std::unique_ptr<event::ControllerEvent> take(const SDL_Event& event);

private:
    struct Open {
        SDL_JoystickID id = 0;
        SDL_GameController* gamepad = nullptr;
        SDL_Joystick* cap = nullptr;
    };

    void open(int index);
    void close(SDL_JoystickID id);
    static std::unique_ptr<event::ControllerEvent> read(const Open& open);

    bool works_ = false;
    std::vector<Open> open_;
};

/// True if a joystick of this vendor and name is a six-axis controller.
bool isSpaceMouse(Uint16 vendor, const char* name);

} // namespace filasofia::window
