#pragma once

#include "filasofia/event/controller_event.h"

#include <SDL.h>

#include <memory>
#include <vector>

namespace filasofia::window {

/// Game controllers and six-axis caps, as SDL finds them: opened as they come, closed as they go. Where SDL can read
/// none, there are none.
class SdlControllers {
public:
    SdlControllers();
    ~SdlControllers();
    SdlControllers(const SdlControllers&) = delete;
    SdlControllers& operator=(const SdlControllers&) = delete;

    /// What an SDL event leads to; nullptr where it is none of a controller that is open.
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

/// Whether a joystick of this maker and name is a six-axis cap.
bool isSpaceMouse(Uint16 vendor, const char* name);

} // namespace filasofia::window
