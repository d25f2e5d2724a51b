#include "filasofia/prefab/trocar_hands.h"

#include "filasofia/core/error.h"
#include "filasofia/core/units.h"
#include "filasofia/runtime/haptic_interface.h"

#include <catch2/catch.hpp>

namespace trocar_hands_test {

using namespace filasofia;
using namespace filasofia::prefab;
using runtime::Simulation;

namespace {

LaparoscopicInstrumentDef toolOf(const char* name, double x, bool haptic = false)
{
    return {.name = name, .tool = {.groups = {}}, .trocar = {.fulcrum = {x, 0, 0}}, .hand = {.haptic = haptic}};
}

struct Scene {
    explicit Scene(bool haptic = false)
        : left(sim, toolOf("left", -0.1, haptic)), right(sim, toolOf("right", 0.1, haptic))
    {
    }
    void run(int steps) { sim.run({.headless = true, .backend = visual::Backend::Null, .steps = steps}); }
    void key(event::KeyCode code)
    {
        event::KeyEvent key;
        key.key = code;
        key.pressed = true;
        sim.post(key);
    }
    void drag(double dx, double dy)
    {
        event::MouseMoveEvent moved;
        moved.dx = dx;
        moved.dy = dy;
        moved.buttons.right = true;
        sim.post(moved);
    }

    Simulation sim{{.physics = {.gravity = {}}}};
    LaparoscopicInstrument left, right;
    Laparoscope scope{sim, {}};
};

} // namespace

TEST_CASE("a script moves both instruments and the scope, and is brought to the trocars' limits")
{
    Scene scene;
    TrocarHands hands(scene.sim, scene.left, scene.right, scene.scope);
    const TrocarPoses to{.left = {.yaw = 0.2, .insertion = 0.15},
                         .right = {.pitch = -0.1, .insertion = 0.9},
                         .scope = {.insertion = 0.07, .roll = 0.5}};
    bool ended = false;
    hands.play({{.seconds = 0.05, .to = to, .end = [&] { ended = true; }}});
    scene.run(60);
    CHECK(ended);
    CHECK(scene.left.report().pose == to.left);
    CHECK(scene.right.report().pose.insertion == TrocarDef{}.mostInsertion);
    CHECK(scene.scope.report().pose == to.scope);
    CHECK_THROWS_WITH(hands.play({{.seconds = 0.0}}), Catch::Contains("trocar hands: moves[0].seconds must be > 0 s"));
    CHECK_THROWS_WITH(TrocarHands(scene.sim, scene.left, scene.right, scene.scope, {.gain = 1.0}),
                      Catch::Contains("trocar hands: gain must be in (0, 0.1]"));
}

TEST_CASE("a person chooses a hand and moves it with mouse, wheel and keys, within the limits")
{
    Scene scene;
    TrocarHands hands(scene.sim, scene.left, scene.right, scene.scope);
    const TrocarPose start = scene.left.report().pose;
    scene.key(event::KeyCode::Digit1);
    scene.drag(50, -20);
    event::MouseWheelEvent wheel;
    wheel.dy = 4;
    scene.sim.post(wheel);
    scene.key(event::KeyCode::A);
    scene.key(event::KeyCode::G); // closed; it begins closed, and stays so
    scene.run(1500);
    CHECK(scene.left.report().pose.yaw == Approx(0.1).epsilon(1e-3));
    CHECK(scene.left.report().pose.pitch == Approx(0.04).epsilon(1e-3));
    CHECK(scene.left.report().pose.insertion == Approx(start.insertion + 12_mm).epsilon(1e-3));
    CHECK(scene.left.report().pose.roll == Approx(5_deg).epsilon(1e-3));
    CHECK(scene.right.report().pose == start);
    scene.key(event::KeyCode::G);
    scene.key(event::KeyCode::Digit3);
    scene.drag(-1e5, 0);
    scene.key(event::KeyCode::PageUp);
    scene.run(1500);
    CHECK(scene.left.tool().opening() == Approx(1.0).margin(1e-3));
    CHECK(scene.scope.report().pose.yaw == Approx(-TrocarDef{}.mostTilt).epsilon(1e-3));
    CHECK(scene.scope.fieldOfView() < LaparoscopeDef{}.fieldOfView);
}

TEST_CASE("two haptic devices hold the handles, each closes its own jaws, and motions of files move them")
{
    Scene scene(true);
    const auto motion = [](double x, bool button) {
        std::vector<device::MotionSample> samples;
        for (int i = 0; i <= 20; ++i)
            samples.push_back(
                {0.05 * i, {{std::clamp(0.1 * (i - 2), 0.0, 1.0) * x, 0, 0}, {}}, button && i > 2 ? 1U : 0U});
        return device::ScriptedDevice{.motion = std::make_shared<const device::Motion>(std::move(samples), "a hand")};
    };
    TrocarHandsDef def;
    const VirtualCoupling coupling{.linearStiffness = 2000.0, .linearDamping = 20.0};
    def.leftDevice = scene.sim.add(
        {.device = motion(-10_mm, false), .body = scene.left.handle(), .coupling = coupling, .rampIn = 0.0});
    def.rightDevice = scene.sim.add(
        {.device = motion(20_mm, true), .body = scene.right.handle(), .coupling = coupling, .rampIn = 0.0});
    const TrocarHands hands(scene.sim, scene.left, scene.right, scene.scope, def);
    scene.left.tool().open();
    scene.right.tool().open();
    scene.run(1200);
    CHECK(scene.left.report().handle.x == Approx(-0.11).margin(0.3_mm));
    CHECK(scene.left.report().pivot.position.x > -0.1 + 3_mm);
    CHECK(scene.right.report().handle.x == Approx(0.12).margin(0.3_mm));
    CHECK(scene.left.tool().opening() == Approx(1.0).margin(1e-3));
    CHECK(scene.right.tool().opening() < 0.05);
}

} // namespace trocar_hands_test
