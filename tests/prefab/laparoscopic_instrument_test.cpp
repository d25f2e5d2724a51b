#include "filasofia/prefab/laparoscopic_instrument.h"

#include "filasofia/core/error.h"
#include "filasofia/core/units.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/runtime/haptic_interface.h"
#include "filasofia/runtime/stepped_run.h"

#include <catch2/catch.hpp>

namespace laparoscopic_instrument_test {

using namespace filasofia;
using namespace filasofia::prefab;
using runtime::Simulation;

namespace {

constexpr double kInside = 0.12, kLength = 0.36, kOutside = kLength - kInside; // [m]
constexpr double kWeight = 0.1 * 9.81;                                         // [N]

/// A shaft along -Z through the origin, level, with 120 of 360 mm inside.
LaparoscopicInstrumentDef level(double wallStiffness, double friction = 0.0)
{
    return {.tool = {.groups = {}},
            .trocar = {.wallStiffness = wallStiffness, .friction = friction},
            .hand = {.length = kLength},
            .start = {.insertion = kInside}};
}

/// 100 g that hang from the pivot of the jaws.
BodyId hang(Simulation& sim, const LaparoscopicInstrument& from)
{
    const BodyId weight =
        sim.add(physics::RigidBodyDef{.name = "weight",
                                      .elements = {from.report().pivot},
                                      .dynamic = true,
                                      .mass = physics::GivenInertia{.mass = 0.1, .moments = {1e-5, 1e-5, 1e-5}},
                                      .attachments = {{.to = from.body()}}});
    return weight;
}

void run(Simulation& sim, int steps) { sim.run({.headless = true, .backend = visual::Backend::Null, .steps = steps}); }

/// Distance of a point from the line of the shaft.
double fromShaft(const TrocarReport& report, Vec3 point)
{
    return length(cross(point - report.handle, normalized(report.pivot.position - report.handle)));
}

/// Rests for 0.1 s, moves by `to` within 0.3 s, and stays.
device::Motion motionBy(Vec3 to)
{
    std::vector<device::MotionSample> samples;
    for (int i = 0; i <= 20; ++i) {
        const double t = std::clamp((i - 2) / 6.0, 0.0, 1.0), s = t * t * (3.0 - 2.0 * t);
        samples.push_back({0.05 * i, {s * to, {}}, 0});
    }
    return device::Motion(std::move(samples), "a hand");
}

} // namespace

TEST_CASE("the handle bears a weight at the tip times the length inside over the length outside")
{
    for (const double wall : {physics::kHard, 2000.0}) {
        Simulation sim;
        LaparoscopicInstrument tool(sim, level(wall));
        hang(sim, tool);
        run(sim, 2000);
        const TrocarReport report = tool.report();
        CHECK(report.force.y == Approx(kWeight * kInside / kOutside).epsilon(0.02)); // the hand is pushed up
        CHECK(std::abs(report.force.x) < 1e-3);
        CHECK(std::abs(report.force.z) < 0.01);
        CHECK(report.wall.y == Approx(kWeight * kLength / kOutside).epsilon(0.02));
    }
}

TEST_CASE("a hand on a haptic device feels the same")
{
    Simulation sim;
    LaparoscopicInstrumentDef def = level(physics::kHard);
    def.hand.haptic = true;
    LaparoscopicInstrument tool(sim, def);
    hang(sim, tool);
    sim.add({.device = device::ScriptedDevice{.motion = std::make_shared<const device::Motion>(motionBy({}))},
             .body = tool.handle(),
             .coupling = {.linearStiffness = 2000.0, .linearDamping = 20.0},
             .rampIn = 0.0});
    run(sim, 2000);
    CHECK(sim.haptic({1}).onHand.force.y == Approx(kWeight * kInside / kOutside).epsilon(0.02));
}

TEST_CASE("a handle moved to the left takes the tip to the right, and forwards it takes it forwards")
{
    Simulation sim;
    LaparoscopicInstrumentDef def = level(physics::kHard);
    def.hand.haptic = true;
    LaparoscopicInstrument tool(sim, def);
    sim.add({.device = device::ScriptedDevice{.motion = std::make_shared<const device::Motion>(
                                                  motionBy({-10_mm, 0, -20_mm}))},
             .body = tool.handle(),
             .coupling = {.linearStiffness = 2000.0, .linearDamping = 20.0},
             .rampIn = 0.0});
    run(sim, 1000);
    const TrocarReport report = tool.report();
    CHECK(report.handle.x == Approx(-10_mm).epsilon(0.02));
    CHECK(report.pose.insertion == Approx(kInside + 20_mm).epsilon(0.02));
    const double outside = kLength - report.pose.insertion;
    CHECK(report.pivot.position.x == Approx(-report.handle.x * report.pose.insertion / outside).epsilon(1e-3));
    CHECK(fromShaft(report, {}) < 1e-9);
    CHECK_THROWS_WITH(tool.move({.insertion = 0.1}), Catch::Contains("a haptic device moves it"));
}

TEST_CASE("the wall yields as far as its stiffness says, and the shaft goes through the place that it yields to")
{
    constexpr double stiffness = 1500.0;
    Simulation sim;
    LaparoscopicInstrument tool(sim, level(stiffness));
    hang(sim, tool);
    double most = 0.0, farthest = 0.0, off = 0.0;
    sim.everyStep([&](double time) {
        tool.move({.yaw = 0.2 * std::sin(3.0 * time), .pitch = 0.1 * std::sin(7.0 * time), .insertion = kInside});
        const TrocarReport report = tool.report();
        most = std::max(most, length(report.wall));
        farthest = std::max(farthest, length(report.shift));
        off = std::max(off, fromShaft(report, report.shift));
    });
    run(sim, 3000);
    CHECK(farthest > 0.5_mm);
    CHECK(farthest <= most / stiffness * 1.001);
    CHECK(off < 1e-9);
    sim.everyStep([&](double) { tool.move({.insertion = kInside}); }); // the last word of every step
    run(sim, 3000);
    CHECK(-tool.report().shift.y == Approx(kWeight * kLength / kOutside / stiffness).epsilon(0.03));
}

TEST_CASE("the seal rubs against insertion and withdrawal, and holds a shaft that rests")
{
    Simulation sim;
    LaparoscopicInstrument tool(sim, level(physics::kHard, 0.7));
    double at = kInside, speed = 0.0;
    sim.everyStep([&](double) { tool.move({.insertion = at += 1e-3 * speed}); });
    run(sim, 20);
    CHECK(length(tool.report().force) < 1e-12);
    speed = 10_mm;
    run(sim, 500);
    CHECK(tool.report().force.z == Approx(0.7)); // out of the body, along +Z
    speed = 0.0;
    run(sim, 100);
    CHECK(tool.report().force.z == Approx(0.7)); // the seal stays bent
    speed = -10_mm;
    run(sim, 500);
    CHECK(tool.report().force.z == Approx(-0.7));
}

TEST_CASE("a tilted shaft is turned back by the wall")
{
    Simulation sim;
    LaparoscopicInstrumentDef def = level(physics::kHard);
    def.trocar.tiltStiffness = 2.0;
    def.start.yaw = 0.3;
    LaparoscopicInstrument tool(sim, def);
    run(sim, 10);
    const TrocarReport report = tool.report();
    CHECK(report.handle.x < 0.0);
    CHECK(length(report.force) == Approx(2.0 * 0.3 / kOutside).epsilon(1e-6));
    CHECK(dot(report.force, {1, 0, 0}) > 0.0); // back to the axis
}

TEST_CASE("a hand of finite strength does not press harder, and moves no faster than 0.25 m/s")
{
    Simulation sim;
    LaparoscopicInstrumentDef def = level(physics::kHard);
    def.tool.groups = {0};
    def.hand.strength = 2.0;
    LaparoscopicInstrument tool(sim, def);
    sim.add(physics::SoftBodyDef{.name = "block",
                                 .mesh = geometry::shapes::block({60_mm, 60_mm, 40_mm}, {6, 6, 4}),
                                 .pose = {{0, 0, -kInside - 45_mm}},
                                 .material = physics::FemMaterial{.youngModulus = 30_kPa, .poissonRatio = 0.4},
                                 .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1, -kInside - 64.9_mm}}}},
                                 .collision = {{}}});
    double fastest = 0.0, before = kInside;
    sim.everyStep([&](double) {
        tool.move({.insertion = kInside + 40_mm});
        fastest = std::max(fastest, (tool.report().pose.insertion - before) / 1e-3);
        before = tool.report().pose.insertion;
    });
    run(sim, 1500);
    CHECK(fastest < 0.2501);
    CHECK(tool.report().pose.insertion < kInside + 35_mm);
    CHECK(length(tool.report().force) < 3.0);
    CHECK(length(tool.report().force) > 1.0);
}

TEST_CASE("poseAt and pivotOf are each other's inverse, whatever the trocar's axes")
{
    const TrocarDef trocar{.fulcrum = {0.1, -0.2, 0.05}, .axis = {0.3, -1.0, 0.2}, .up = {0, 0.2, -1}};
    for (const TrocarPose pose :
         {TrocarPose{.yaw = 0.4, .pitch = -0.3, .insertion = 0.11, .roll = 1.0}, {.yaw = -0.7, .insertion = 0.02}}) {
        const TrocarPose back = poseAt(trocar, pivotOf(trocar, pose).position, pose.roll);
        CHECK(back.yaw == Approx(pose.yaw));
        CHECK(back.pitch == Approx(pose.pitch).margin(1e-12));
        CHECK(back.insertion == Approx(pose.insertion));
        const Vec3 point = {2_mm, -3_mm, -15_mm}, target = {0.12, -0.35, 0.06};
        const TrocarPose there = poseAt(trocar, target, pose.roll, point);
        CHECK(distance(transform(pivotOf(trocar, there), point), target) < 1e-9);
        const Vec3 across = {0.3, 0.1, -0.8};
        const TrocarPose turned = poseAt(trocar, target, rollAcross(trocar, target, across));
        CHECK(std::abs(turned.roll) <= 90_deg + 1e-12);
        CHECK(dot(rotate(pivotOf(trocar, turned).orientation, {1, 0, 0}), across) == Approx(0.0).margin(1e-9));
    }
    const Pose straight = pivotOf(trocar, {.insertion = 0.1});
    CHECK(distance(rotate(straight.orientation, {0, 0, -1}), normalized(trocar.axis)) < 1e-12);
    const Pose right = pivotOf(trocar, {.yaw = 0.1, .insertion = 0.1});
    CHECK(dot(right.position - straight.position, rotate(straight.orientation, {1, 0, 0})) > 9_mm);
    const TrocarPose far = withinLimits(trocar, {.yaw = 1.4, .pitch = -1.2, .insertion = 3.0});
    CHECK_NOTHROW(checkLimits(trocar, far, "far"));
    CHECK(far.insertion == trocar.mostInsertion);
    for (const double yaw : {6.2, -6.2832, 40.0}) // more than once around
        CHECK_NOTHROW(checkLimits(trocar, withinLimits(trocar, {.yaw = yaw, .insertion = 0.1}), "around"));
}

TEST_CASE("a wrong trocar, start or motion is refused in one line that says the field and the bound")
{
    Simulation sim;
    const auto refused = [&](auto change) {
        LaparoscopicInstrumentDef def{.name = "left", .tool = {.groups = {}}};
        change(def);
        try {
            const LaparoscopicInstrument tool(sim, def);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string("no error");
    };
    using Def = LaparoscopicInstrumentDef;
    using Catch::Contains;
    CHECK_THAT(refused([](Def& def) { def.trocar.mostTilt = 2.0; }),
               Contains("instrument 'left': trocar: mostTilt must be in (0, 1.5]") && Contains("got 2"));
    CHECK_THAT(refused([](Def& def) { def.trocar.wallStiffness = 0.0; }), Contains("wallStiffness must be"));
    CHECK_THAT(refused([](Def& def) {
                   def.trocar.up = {0, 0, 3};
               }),
               Contains("'left': trocar.up must not be parallel to its axis"));
    CHECK_THAT(refused([](Def& def) { def.trocar.axis = {}; }), Contains("trocar.axis must have a length > 0"));
    CHECK_THAT(refused([](Def& def) { def.trocar.mostInsertion = 0.5; }),
               Contains("trocar.mostInsertion must be < hand.length (0.36 m), got 0.5 m"));
    CHECK_THAT(refused([](Def& def) { def.start.insertion = 0.3; }),
               Contains("'left': start: insertion must be in [0, 0.25] m, got 0.3"));
    CHECK_THAT(refused([](Def& def) { def.start.yaw = 1.2; }),
               Contains("the shaft must be within mostTilt (1 rad) of the axis, got yaw 1.2"));
    CHECK_THAT(refused([](Def& def) { def.start.roll = NAN; }), Contains("roll must be finite"));
    CHECK_THAT(refused([](Def& def) { def.tool.pose.position = {0, 0, 1}; }), Contains("tool.pose must be left out"));
    CHECK_THAT(refused([](Def& def) { def.tool.name = "x"; }), Contains("tool.name must be left out, got 'x'"));
    LaparoscopicInstrument tool(sim, {.name = "left", .tool = {.groups = {}}});
    CHECK_THROWS_WITH(tool.move({.insertion = 0.26}),
                      Contains("instrument 'left': insertion must be in [0, 0.25] m, got 0.26"));
    CHECK_THROWS_WITH(tool.move({.yaw = NAN}), Contains("yaw must be finite"));
}

TEST_CASE("a state saved while a wall yields is restored with it")
{
    Simulation sim;
    LaparoscopicInstrument tool(sim, level(800.0, 0.5));
    hang(sim, tool);
    sim.everyStep([&](double time) { tool.move({.yaw = 0.3 * time, .insertion = kInside + 0.02 * time}); });
    runtime::SteppedRun stepped(sim);
    const auto steps = [&](int count) {
        for (int i = 0; i < count; ++i) stepped.step();
        return sim.physics().hash();
    };
    steps(100);
    const auto state = stepped.save();
    const auto first = steps(200);
    stepped.restore(*state);
    CHECK(steps(200) == first);
}

TEST_CASE("every kind of laparoscopic instrument has a shaft and jaws that open and close")
{
    for (const InstrumentKind kind :
         {InstrumentKind::LaparoscopicGrasper, InstrumentKind::Dissector, InstrumentKind::LaparoscopicScissors}) {
        Simulation sim;
        LaparoscopicInstrument tool(sim, {.tool = {.kind = kind, .groups = {}}});
        tool.tool().open();
        run(sim, 700);
        CHECK(tool.tool().opening() == Approx(1.0).margin(1e-6));
        tool.tool().close();
        run(sim, 1500);
        CHECK(tool.tool().opening() < 0.02);
    }
}

} // namespace laparoscopic_instrument_test
