#include "filasofia/prefab/scope_hands.h"

#include "filasofia/core/error.h"
#include "filasofia/core/units.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/runtime/stepped_run.h"

#include <catch2/catch.hpp>

namespace scope_hands_test {

using namespace filasofia;
using namespace filasofia::prefab;
using runtime::Simulation;

namespace {

/// A scope and forceps that touch nothing, and their hands, about a fulcrum away from the origin.
struct Scene {
    Simulation sim;
    Endoscope scope{sim, {.groups = {}}};
    ArticulatedInstrument forceps{sim, {.groups = {}}};
    ScopeHandsDef def{.fulcrum = {1_mm, 20_mm, -2_mm}, .up = {0, 0, 1}, .start = {.aim = {0, 1, 0}, .depth = -30_mm}};
    ScopeHands hands{sim, scope, forceps, def};

    void run(int steps) { sim.run({.headless = true, .backend = visual::Backend::Null, .steps = steps}); }
    [[nodiscard]] Pose element(BodyId body) { return sim.physics().latest()->rigidBody(body)->poses[0]; }
};

/// The distance of a point from the axis of a pose.
double fromAxis(const Pose& pose, Vec3 point)
{
    return length(cross(point - pose.position, rotate(pose.orientation, {0, 0, -1})));
}

} // namespace

TEST_CASE("at() places the instrument before a target, with the shaft through the fulcrum")
{
    Scene scene;
    const Vec3 target = {6_mm, 50_mm, 3_mm};
    for (const double roll : {0.0, 40_deg, -80_deg}) {
        const ScopeHand hand = scene.hands.at(target, 3_mm, roll, 8_mm);
        scene.hands.play({{.seconds = 0.05, .to = hand}});
        scene.run(60);
        const Pose tip = scene.element(scene.scope.body());
        const Pose pivot = scene.element(scene.forceps.body());
        CHECK(fromAxis(tip, scene.def.fulcrum) < 1e-6);
        CHECK(distance(transform(pivot, {0, 0, -3_mm}), target) < 1e-6);
        CHECK(distance(scene.hands.tip(hand).position, tip.position) < 1e-6);
        CHECK(distance(scene.scope.channel().position, pivot.position) == Approx(8_mm).epsilon(1e-5));
    }
}

TEST_CASE("a script is played move by move, each begun and ended once, at its time")
{
    Scene scene;
    std::vector<std::pair<std::string, double>> calls;
    const auto record = [&](const char* what) {
        return [&, what] {
            const auto frame = scene.sim.physics().latest(); // null before the first step
            calls.emplace_back(what, frame ? frame->time : 0.0);
        };
    };
    const ScopeHand in{.aim = {0, 1, 0}, .depth = 10_mm};
    scene.hands.play({{.seconds = 0.02, .to = in, .begin = record("in"), .end = record("is in")},
                      {.seconds = 0.01, .to = in, .begin = record("rest"), .end = record("has rested")}});
    scene.run(100);
    REQUIRE(calls.size() == 4);
    CHECK(calls[0].first == "in");
    CHECK(calls[1].first == "is in");
    CHECK(calls[2].first == "rest");
    CHECK(calls[3].first == "has rested");
    CHECK(calls[1].second - calls[0].second == Approx(19e-3).margin(1.1e-3));
    CHECK(calls[3].second - calls[2].second == Approx(10e-3).margin(1.1e-3));
    CHECK(scene.element(scene.scope.body()).position.y == Approx(30_mm).epsilon(1e-9));
    CHECK(durationOf(std::vector<HandMove>{{.seconds = 1.5}, {.seconds = 2.0}}) == 3.5);
}

TEST_CASE("a move with an aim function goes where it says when the move begins")
{
    Scene scene;
    double depth = 1_mm;
    int asked = 0;
    const auto look = [&] {
        ++asked;
        return ScopeHand{.aim = {0, 1, 0}, .depth = depth};
    };
    scene.hands.play(
        {{.seconds = 0.02, .to = {.aim = {0, 1, 0}}, .end = [&] { depth = 7_mm; }}, {.seconds = 0.02, .aim = look}});
    scene.run(60);
    CHECK(asked == 1);
    CHECK(scene.element(scene.scope.body()).position.y == Approx(27_mm).epsilon(1e-9));
}

TEST_CASE("a person's wheel and keys move the hands smoothly and within their bounds")
{
    Scene scene;
    event::MouseWheelEvent wheel;
    wheel.dy = 10.0;
    scene.sim.post(wheel);
    event::KeyEvent key;
    key.key = event::KeyCode::G;
    key.pressed = true;
    scene.sim.post(key); // opens the jaws
    scene.run(1000);
    CHECK(scene.element(scene.scope.body()).position.y == Approx(20_mm - 30_mm + 15_mm).epsilon(1e-4));
    CHECK(scene.forceps.opening() == Approx(1.0).epsilon(1e-6));
    wheel.dy = 1e6;
    scene.sim.post(wheel);
    scene.run(2000);
    CHECK(scene.element(scene.scope.body()).position.y == Approx(20_mm + scene.def.mostDepth).epsilon(1e-4));
    event::MouseMoveEvent drag;
    drag.dx = 100.0;
    drag.buttons.right = true;
    scene.sim.post(drag);
    scene.run(1000);
    const Pose tip = scene.element(scene.scope.body());
    CHECK(fromAxis(tip, scene.def.fulcrum) < 1e-6);
    const double angle = std::acos(rotate(tip.orientation, {0, 0, -1}).y);
    CHECK(angle == Approx(0.2).epsilon(1e-3));
}

TEST_CASE("hands do not go back to a saved state")
{
    Scene scene;
    runtime::SteppedRun run(scene.sim);
    run.step();
    CHECK_THROWS_WITH(run.restore(*run.save()), "restore: hands hold the scope, and do not go back");
}

TEST_CASE("wrong hands are refused with the field and the bound")
{
    Scene scene;
    const auto make = [&](const ScopeHandsDef& def) { ScopeHands(scene.sim, scene.scope, scene.forceps, def); };
    CHECK_THROWS_WITH(make({.start = {.aim = {}}}), Catch::Contains("start.aim must have a length > 0"));
    CHECK_THROWS_WITH(make({.leastDepth = 1.0}), Catch::Contains("mostDepth must be >= leastDepth (1 m)"));
    CHECK_THROWS_WITH(make({.mostTurn = 2.0}), Catch::Contains("mostTurn must be in (0, 1.5]"));
    CHECK_THROWS_WITH(scene.hands.play({{.seconds = 0.0}}), Catch::Contains("moves[0].seconds must be > 0 s, got 0"));
}

TEST_CASE("hands pull on what they hold no harder than their strength")
{
    const auto pullWith = [](double strength) {
        Simulation sim{{.physics = {.gravity = {}}}};
        Endoscope scope(sim, {.groups = {}});
        ArticulatedInstrument forceps(sim, {.groups = {}});
        ScopeHands hands(sim, scope, forceps, {.start = {.depth = 20_mm}, .strength = strength});
        physics::SoftBodyDef def{.mesh = geometry::shapes::block({10_mm, 10_mm, 10_mm}, {2, 2, 2})};
        def.material = physics::FemMaterial{.youngModulus = 100_kPa};
        def.attachments = {{.box = geometry::Box{{-1, 4.9_mm, -1}, {1, 1, 1}}}};
        const BodyId block = sim.add(def);
        const auto run = [&](int steps) {
            sim.run({.headless = true, .backend = visual::Backend::Null, .steps = steps});
        };
        run(10); // to the start pose of the hands
        sim.physics().attach(block, {.box = geometry::Box{{-1, -1, -1}, {1, -4.9_mm, 1}}, .to = forceps.body()});
        ScopeHand back{.depth = 10_mm};
        hands.play({{.seconds = 1.0, .to = back}});
        run(1200);
        double pull = 0.0;
        for (const frame::Attachment& each : sim.physics().latest()->attachments)
            if (each.to && each.body == block) pull = length(each.force);
        return pull;
    };
    const double strong = pullWith(100.0);
    CHECK(strong > 3.0);
    CHECK(pullWith(2.0) < 2.5);
    CHECK(pullWith(2.0) > 1.5);
}

} // namespace scope_hands_test
