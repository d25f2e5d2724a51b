#include "filasofia/filasofia.h"

#include "filasofia/event/controller_event.h"
#include "filasofia/window/null_window.h"

namespace haptic_person_test {

using namespace filasofia;
using filasofia::event::ControllerEvent;
using filasofia::window::NullWindow;

namespace {

/// A window with a person who acts once, after the first pictures.
class HandAtWindow final : public window::Window {
public:
    HandAtWindow(const window::WindowDef& def, std::function<void(NullWindow&)> acts)
        : inner_(def), acts_(std::move(acts))
    {
    }
    [[nodiscard]] void* nativeWindow() const override { return nullptr; }
    [[nodiscard]] window::WindowSize size() const override { return inner_.size(); }
    [[nodiscard]] double scale() const override { return 1.0; }
    void poll(const event::EventSink& sink) override
    {
        if (++looks_ == 10) acts_(inner_);
        inner_.poll(sink);
    }
    [[nodiscard]] bool shouldClose() const override { return false; }
    void setTitle(const std::string&) override {}

private:
    NullWindow inner_;
    std::function<void(NullWindow&)> acts_;
    int looks_ = 0;
};

/// Runs until the tool is where `there` says, with a person who acts in this way on such a device.
void reach(const device::DeviceDef& device, std::function<void(NullWindow&)> acts, std::function<bool(Vec3)> there)
{
    Simulation sim;
    const BodyId tool = sim.add(RigidBodyDef{.name = "tool",
                                             .elements = {{{0.1, 0.2, 0.3}, {}}},
                                             .mesh = shapes::sphere(5_mm),
                                             .dynamic = true,
                                             .mass = TotalMass{0.02},
                                             .gravity = false});
    sim.show(tool);
    sim.add(HapticInterfaceDef{.device = device, .body = tool});
    sim.useWindow([&](const window::WindowDef& def) { return std::make_unique<HandAtWindow>(def, acts); });
    sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent&) {
        const FrameRef frame = sim.physics().latest();
        if (frame && there(frame->rigidBody(tool)->poses[0].position - Vec3{0.1, 0.2, 0.3})) sim.finish("there");
    });
    CHECK(sim.run({.backend = Backend::Null}).finished == "there"); // otherwise the test never ends
}

} // namespace

TEST_CASE("in a live run the mouse pulls the tool while its right button is held, and a key pushes it")
{
    const auto drag = [](NullWindow& window) {
        auto button = std::make_unique<MouseButtonEvent>();
        button->button = event::MouseButton::Right;
        button->pressed = true;
        window.inject(std::move(button));
        auto move = std::make_unique<MouseMoveEvent>();
        move->dx = 50;
        move->dy = 100; // down
        window.inject(std::move(move));
    };
    reach(MouseDevice{.reach = 1e-3}, drag, [](Vec3 moved) { return distance(moved, {50_mm, -100_mm, 0}) < 1_mm; });
    const auto push = [](NullWindow& window) {
        auto key = std::make_unique<KeyEvent>();
        key->key = KeyCode::PageUp;
        key->pressed = true;
        window.inject(std::move(key));
    };
    reach(MouseDevice{}, push, [](Vec3 moved) { return moved.z < -10_mm && std::abs(moved.x) < 0.1_mm; });
}

TEST_CASE("in a live run a controller's sticks push the tool that its own device holds")
{
    const auto by = [](ControllerEvent::Kind kind) {
        return [kind](NullWindow& window) {
            auto sticks = std::make_unique<ControllerEvent>();
            sticks->kind = kind;
            sticks->push = {0.0, 1.0, 0.0};
            window.inject(std::move(sticks));
        };
    };
    const auto up = [](Vec3 moved) { return moved.y > 10_mm && std::abs(moved.x) < 0.1_mm; };
    reach(GamepadDevice{}, by(ControllerEvent::Kind::Gamepad), up);
    reach(SpaceMouseDevice{}, by(ControllerEvent::Kind::SpaceMouse), up);
}

} // namespace haptic_person_test
