#include "filasofia/window/sdl_controllers.h"

namespace sdl_controllers_test {

using namespace filasofia;
using namespace filasofia::window;
using filasofia::event::ControllerEvent;

namespace {

/// A virtual controller of SDL.
struct Virtual {
    Virtual(SDL_JoystickType type, int axes, int buttons) : index(SDL_JoystickAttachVirtual(type, axes, buttons, 0))
    {
        REQUIRE(index >= 0);
    }
    ~Virtual()
    {
        if (pad) SDL_JoystickClose(pad);
        SDL_JoystickDetachVirtual(index);
    }
    SDL_Joystick* open() { return pad = SDL_JoystickOpen(index); }
    int index;
    SDL_Joystick* pad = nullptr;
};

/// The last event that the queued SDL events lead to.
std::unique_ptr<ControllerEvent> poll(SdlControllers& controllers)
{
    std::unique_ptr<ControllerEvent> last;
    SDL_GameControllerUpdate();
    for (SDL_Event event; SDL_PollEvent(&event);)
        if (auto made = controllers.take(event)) last = std::move(made);
    return last;
}

} // namespace

TEST_CASE("a game controller's sticks become pushes and twists, and small deflections are ignored")
{
    SDL_SetHint(SDL_HINT_JOYSTICK_ALLOW_BACKGROUND_EVENTS, "1");
    SdlControllers controllers;
    std::unique_ptr<ControllerEvent> event;
    {
        Virtual made(SDL_JOYSTICK_TYPE_GAMECONTROLLER, SDL_CONTROLLER_AXIS_MAX, SDL_CONTROLLER_BUTTON_MAX);
        poll(controllers);
        SDL_Joystick* pad = made.open();
        REQUIRE(pad);
        SDL_JoystickSetVirtualAxis(pad, SDL_CONTROLLER_AXIS_LEFTX, 32767);
        SDL_JoystickSetVirtualAxis(pad, SDL_CONTROLLER_AXIS_LEFTY, -32768);
        SDL_JoystickSetVirtualAxis(pad, SDL_CONTROLLER_AXIS_RIGHTY, 1000);
        SDL_JoystickSetVirtualButton(pad, SDL_CONTROLLER_BUTTON_B, 1);
        event = poll(controllers);
        REQUIRE(event);
        CHECK(event->kind == ControllerEvent::Kind::Gamepad);
        CHECK(event->push[0] == Approx(1.0));
        CHECK(event->push[1] == 0.0);
        CHECK(event->push[2] == Approx(-1.0)); // up on the stick means away from the user
        CHECK(event->buttons == 2);
    }
    event = poll(controllers);
    REQUIRE(event); // it was removed: it is reported at rest
    CHECK(event->push == std::array<double, 3>{});
    CHECK(event->buttons == 0);
}

TEST_CASE("six-axis caps are recognised by their vendor or their name")
{
    CHECK(isSpaceMouse(0x256f, "anything"));
    CHECK(isSpaceMouse(0x046d, "3Dconnexion SpaceNavigator"));
    CHECK_FALSE(isSpaceMouse(0x046d, "Logitech Dual Action"));
    CHECK_FALSE(isSpaceMouse(0, nullptr));
}

} // namespace sdl_controllers_test
