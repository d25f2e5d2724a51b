#include "filasofia/window/sdl_controllers.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace filasofia::window {
namespace {

constexpr Uint16 kThreeDconnexion = 0x256f;
constexpr double kDeadGamepad = 0.12,
                 kDeadCap = 0.02; ///< [-] dead zones: readings of a stick or cap that nobody touches

/// [-] The axis value in [-1, 1], with a dead zone around 0.
double axis(Sint16 value, double dead)
{
    const double share = std::clamp(value / 32767.0, -1.0, 1.0), size = std::abs(share);
    return size < dead ? 0.0 : std::copysign((size - dead) / (1.0 - dead), share);
}

} // namespace

bool isSpaceMouse(Uint16 vendor, const char* name)
{
    const std::string_view called = name ? name : "";
    return vendor == kThreeDconnexion || called.find("SpaceNavigator") != std::string_view::npos ||
           called.find("SpaceMouse") != std::string_view::npos;
}

SdlControllers::SdlControllers() : works_(SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER) == 0) {}

SdlControllers::~SdlControllers()
{
    while (!open_.empty()) close(open_.back().id);
    if (works_) SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER);
}

void SdlControllers::open(int index)
{
    const SDL_JoystickID id = SDL_JoystickGetDeviceInstanceID(index);
    if (std::ranges::any_of(open_, [id](const Open& each) { return each.id == id; })) return;
    if (isSpaceMouse(SDL_JoystickGetDeviceVendor(index), SDL_JoystickNameForIndex(index))) {
        if (SDL_Joystick* cap = SDL_JoystickOpen(index)) open_.push_back({.id = id, .cap = cap});
    } else if (SDL_IsGameController(index)) {
        if (SDL_GameController* gamepad = SDL_GameControllerOpen(index))
            open_.push_back({.id = id, .gamepad = gamepad});
    }
}

void SdlControllers::close(SDL_JoystickID id)
{
    const auto place = std::ranges::find(open_, id, &Open::id);
    if (place == open_.end()) return;
    if (place->gamepad) SDL_GameControllerClose(place->gamepad);
    if (place->cap) SDL_JoystickClose(place->cap);
    open_.erase(place);
}

// SDL's y axes point down. A cap's axes are those of its maker: to the right, towards the user, down, and rotations
// about the same axes.
std::unique_ptr<event::ControllerEvent> SdlControllers::read(const Open& open)
{
    auto event = std::make_unique<event::ControllerEvent>();
    if (open.cap) {
        const auto at = [&](int which) { return axis(SDL_JoystickGetAxis(open.cap, which), kDeadCap); };
        event->kind = event::ControllerEvent::Kind::SpaceMouse;
        event->push = {at(0), -at(2), at(1)};
        event->twist = {at(3), -at(5), at(4)};
        for (int b = 0; b < std::min(SDL_JoystickNumButtons(open.cap), 32); ++b)
            event->buttons |= static_cast<std::uint32_t>(SDL_JoystickGetButton(open.cap, b)) << b;
        return event;
    }
    const auto at = [&](SDL_GameControllerAxis which) {
        return axis(SDL_GameControllerGetAxis(open.gamepad, which), kDeadGamepad);
    };
    const double roll = at(SDL_CONTROLLER_AXIS_TRIGGERLEFT) - at(SDL_CONTROLLER_AXIS_TRIGGERRIGHT);
    event->push = {at(SDL_CONTROLLER_AXIS_LEFTX), -at(SDL_CONTROLLER_AXIS_RIGHTY), at(SDL_CONTROLLER_AXIS_LEFTY)};
    event->twist = {0.0, -at(SDL_CONTROLLER_AXIS_RIGHTX), roll};
    for (int b = 0; b < SDL_CONTROLLER_BUTTON_MAX; ++b)
        event->buttons |= static_cast<std::uint32_t>(
                              SDL_GameControllerGetButton(open.gamepad, static_cast<SDL_GameControllerButton>(b)))
                          << b;
    return event;
}

std::unique_ptr<event::ControllerEvent> SdlControllers::take(const SDL_Event& event)
{
    SDL_JoystickID id = -1;
    switch (event.type) {
    case SDL_JOYDEVICEADDED:
        open(event.jdevice.which);
        return nullptr;
    case SDL_JOYDEVICEREMOVED: { // report it at rest, because it sends nothing more
        const auto place = std::ranges::find(open_, event.jdevice.which, &Open::id);
        if (place == open_.end()) return nullptr;
        auto still = std::make_unique<event::ControllerEvent>();
        still->kind = place->cap ? event::ControllerEvent::Kind::SpaceMouse : event::ControllerEvent::Kind::Gamepad;
        close(place->id);
        return still;
    }
    case SDL_CONTROLLERAXISMOTION:
        id = event.caxis.which;
        break;
    case SDL_CONTROLLERBUTTONDOWN:
    case SDL_CONTROLLERBUTTONUP:
        id = event.cbutton.which;
        break;
    case SDL_JOYAXISMOTION:
        id = event.jaxis.which;
        break;
    case SDL_JOYBUTTONDOWN:
    case SDL_JOYBUTTONUP:
        id = event.jbutton.which;
        break;
    default:
        return nullptr;
    }
    const auto place = std::ranges::find(open_, id, &Open::id);
    return place == open_.end() ? nullptr : read(*place);
}

} // namespace filasofia::window
