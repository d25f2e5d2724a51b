#include "filasofia/prefab/scope_hands.h"

#include "filasofia/core/units.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/runtime/haptic_interface.h"

#include <catch2/catch.hpp>

namespace scope_handle_test {

using namespace filasofia;
using namespace filasofia::prefab;
using runtime::Simulation;

namespace {

constexpr double kLever = 0.2; // [m], as in ScopeHands

/// A scope that points along +Y through the origin, with its tip 20 mm beyond, and a handle in a hand whose motion the
/// test gives.
struct Scene {
    explicit Scene(const device::Motion& way, std::vector<int> groups = {}) : scope(sim, {.groups = groups})
    {
        sim.add({.device = device::ScriptedDevice{.motion = std::make_shared<const device::Motion>(way)},
                 .body = hands.handle(),
                 .coupling = {.linearStiffness = 2000.0, .linearDamping = 20.0},
                 .forceLimit = 50.0,
                 .rampIn = 0.0});
    }
    void run(int steps) { sim.run({.headless = true, .backend = visual::Backend::Null, .steps = steps}); }
    [[nodiscard]] Pose element(BodyId body) { return sim.physics().latest()->rigidBody(body)->poses[0]; }

    Simulation sim{{.physics = {.gravity = {}}}};
    Endoscope scope;
    ArticulatedInstrument forceps{sim, {.groups = {}}};
    ScopeHands hands{
        sim,
        scope,
        forceps,
        {.up = {0, 0, 1}, .start = {.aim = {0, 1, 0}, .depth = 20_mm}, .mostDepth = 50_mm, .handle = true}};
};

/// Rests for 0.1 s, moves to `to` within 0.3 s, and stays; the buttons are pressed before it moves.
device::Motion motionTo(Vec3 to, std::uint32_t buttons = 0)
{
    std::vector<device::MotionSample> samples;
    for (int i = 0; i <= 20; ++i) {
        const double t = std::clamp((i - 2) / 6.0, 0.0, 1.0), s = t * t * (3.0 - 2.0 * t);
        samples.push_back({0.05 * i, {s * to, axisAngle({0, 1, 0}, s * 40_deg)}, i > 0 ? buttons : 0});
    }
    return device::Motion(std::move(samples), "a hand");
}

} // namespace

TEST_CASE("a handle moves the scope as a lever about the fulcrum does, and rolls it")
{
    Scene scene(motionTo({5_mm, 10_mm, 0}));
    scene.run(1000);
    const Vec3 handle = scene.element(scene.hands.handle()).position;
    CHECK(distance(handle, {5_mm, 20_mm - kLever + 10_mm, 0}) < 0.2_mm);
    const Pose tip = scene.element(scene.scope.body());
    const Vec3 aim = normalized(-handle);
    CHECK(distance(tip.position, (kLever - length(handle)) * aim) < 1e-6);
    CHECK(tip.position.x < 0.0); // on the other side of the fulcrum
    const Vec3 right = rotate(tip.orientation, {1, 0, 0});
    CHECK(std::abs(std::acos(std::clamp(std::abs(right.x), 0.0, 1.0))) == Approx(40_deg).epsilon(0.05));
}

TEST_CASE("with the second button the handle moves the instrument, with the first it opens the jaws")
{
    Scene scene(motionTo({0, 10_mm, 0}, 0b11));
    scene.run(1000);
    CHECK(scene.element(scene.scope.body()).position.y == Approx(20_mm).margin(0.2_mm));
    CHECK(distance(scene.scope.channel().position, scene.element(scene.forceps.body()).position) ==
          Approx(10_mm).margin(0.4_mm));
    CHECK(scene.forceps.opening() == Approx(1.0).margin(1e-3));
}

TEST_CASE("a hand feels along the shaft what tissue does to the scope, and across it by the lever")
{
    // A soft block in front of the tip, which is pushed 5 mm into it.
    Scene scene(motionTo({0, 8_mm, 0}), {0});
    const BodyId block = scene.sim.add(
        physics::SoftBodyDef{.name = "block",
                             .mesh = geometry::shapes::block({40_mm, 20_mm, 40_mm}, {6, 3, 6}),
                             .pose = {{0, 34_mm, 0}},
                             .material = physics::FemMaterial{.youngModulus = 10_kPa, .poissonRatio = 0.4},
                             .attachments = {{.box = geometry::Box{{-1, 43.9_mm, -1}, {1, 1, 1}}}},
                             .collision = {{}}});
    scene.run(1000);
    double force = 0.0;
    for (const frame::ContactPair& pair : frame::contactPairs(scene.sim.physics().latest()->contacts))
        force += (pair.first == block ? 1.0 : -1.0) * pair.force.y;
    CHECK(force > 0.2);
    const runtime::HapticState state = scene.sim.haptic({1});
    CHECK(-state.onHand.force.y == Approx(force).epsilon(0.05)); // it pushes the hand back
}

} // namespace scope_handle_test
