#include "filasofia/core/units.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/prefab/articulated_instrument.h"

#include <catch2/catch.hpp>

#include <random>

namespace suturing_instruments_test {

using namespace filasofia;
using prefab::ArticulatedInstrument;
using prefab::InstrumentKind;
using runtime::Simulation;

namespace {

constexpr double kArc = 9e-3, kRadius = 0.4e-3; // [m], the needle: half a circle, 28 mm long
constexpr Vec3 kGrip{0, 0, -9e-3};              // [m] between the jaws of a needle driver at the origin

/// The needle's line, whose middle is its origin, from the tip to the tail, in its plane z = 0.
std::vector<Vec3> halfCircle()
{
    std::vector<Vec3> line;
    for (int i = -12; i <= 12; ++i) {
        const double angle = i * M_PI / 24.0;
        line.push_back({kArc * std::sin(angle), kArc * (std::cos(angle) - 1.0), 0.0});
    }
    return line;
}

BodyId addNeedle(Simulation& sim, const Pose& pose)
{
    physics::RigidBodyDef def{.name = "needle",
                              .elements = {pose},
                              .mesh = geometry::shapes::tube(halfCircle(), kRadius, 8, true),
                              .dynamic = true,
                              .mass = physics::Density{7800.0}};
    def.collision = {{.proximity = 0.1_mm}};
    def.friction = 0.3;
    return sim.add(def);
}

void run(Simulation& sim, int steps) { sim.run({.headless = true, .backend = visual::Backend::Null, .steps = steps}); }

Pose poseOf(Simulation& sim, BodyId body) { return sim.physics().latest()->rigidBody(body)->poses.front(); }

/// The needle in the jaws, turned about the axis along which they open, and rolled about its own tangent there. It lies
/// across the jaws: along them, they would push it out.
struct Held {
    double turn, roll; ///< [rad]
};
std::vector<Held> orientations()
{
    std::mt19937 draw(7);
    std::uniform_real_distribution<double> any(-M_PI, M_PI), across(-M_PI / 4.0, M_PI / 4.0);
    std::vector<Held> all{{0.0, 0.0}, {M_PI / 4.0, M_PI / 2.0}};
    for (int i = 0; i < 4; ++i) all.push_back({across(draw), any(draw)});
    return all;
}

/// A thread that is wound once around a driver at the origin, so far behind its pivot [m]. `last` is the way of its end
/// from there.
BodyId addWound(Simulation& sim, double behind, const std::vector<Vec3>& last)
{
    physics::RodBodyDef def{.name = "thread",
                            .points = {{-30_mm, 2.7_mm, behind}},
                            .spacing = 0.4_mm,
                            .radius = 0.15_mm,
                            .youngModulus = 50_MPa,
                            .collision = physics::RodCollision{}};
    for (int i = 0; i <= 16; ++i)
        def.points.push_back({2.7_mm * std::sin(i * M_PI / 8), 2.7_mm * std::cos(i * M_PI / 8), behind + i * 0.1_mm});
    def.points.insert(def.points.end(), last.begin(), last.end());
    def.straight = false;
    def.rayleigh.mass = 20.0;
    return sim.add(def);
}
int endOf(Simulation& sim, BodyId thread)
{
    return static_cast<int>(sim.physics().latest()->softBody(thread)->positions.size()) - 1;
}

} // namespace

TEST_CASE("jaws that close on nothing hold no thread that is wound around the shaft, or around them")
{
    for (const double behind : {4_mm, -6_mm}) {
        CAPTURE(behind);
        Simulation sim({.physics = {.gravity = {}}});
        const BodyId thread = addWound(sim, behind, {{30_mm, 2.7_mm, behind + 1.6_mm}});
        ArticulatedInstrument driver(sim, {.kind = InstrumentKind::NeedleDriver, .opening = 0.02, .friction = 0.03});
        run(sim, 1);
        sim.physics().setForces(
            thread, {{.node = 0, .force = {-0.2, 0, 0}}, {.node = endOf(sim, thread), .force = {0.2, 0, 0}}});
        run(sim, 200);
        driver.close();
        run(sim, 400);
        const auto frame = sim.physics().latest();
        double pressed = 0.0; // [N] from above and from below
        for (const frame::Contact& each : frame->contacts)
            if (each.first == thread || each.second == thread) pressed += std::abs(each.normal.y) * each.normalForce;
        CHECK(pressed > 0.4);
        CHECK_FALSE(driver.holding());
    }
}

TEST_CASE("a thread that jaws hold slides around their shaft, and around them")
{
    for (const double behind : {4_mm, -6_mm}) {
        CAPTURE(behind);
        Simulation sim({.physics = {.gravity = {}}});
        const BodyId thread =
            addWound(sim, behind, {{9_mm, 3_mm, behind}, {12_mm, 1_mm, -11_mm}, {6_mm, 0, -11_mm}, {-6_mm, 0, -11_mm}});
        ArticulatedInstrument driver(sim, {.kind = InstrumentKind::NeedleDriver, .opening = 0.06, .friction = 0.03});
        driver.close();
        run(sim, 400);
        REQUIRE(driver.holding() == thread);
        const auto at = [&](int node) {
            return sim.physics().latest()->softBody(thread)->positions[static_cast<std::size_t>(node)];
        };
        const Vec3 first = at(0), last = at(endOf(sim, thread));
        sim.physics().setForces(thread, {{.node = 0, .force = {-0.2, 0, 0}}});
        run(sim, 400);
        CHECK(driver.holding() == thread);
        CHECK(first.x - at(0).x > 4_mm); // the way from the loop to the mouth becomes straight
        CHECK(distance(last, at(endOf(sim, thread))) < 1_mm);
    }
}

TEST_CASE("a needle driver holds a needle at any orientation, against a force and a moment, and lets it go")
{
    for (const Held& held : orientations()) {
        CAPTURE(held.turn, held.roll);
        Simulation sim({.physics = {.gravity = {}}});
        ArticulatedInstrument driver(sim, {.name = "driver", .kind = InstrumentKind::NeedleDriver, .opening = 0.4});
        const Quat turn = axisAngle({0, 1, 0}, held.turn) * axisAngle({1, 0, 0}, held.roll);
        const BodyId needle = addNeedle(sim, {kGrip, turn});
        driver.close();
        run(sim, 400);
        REQUIRE(driver.holding() == needle);
        const Pose before = poseOf(sim, needle);
        CHECK(distance(before.position, kGrip) < 3_mm); // one lies so that the closing jaws knock it 2.9 mm away

        // 0.4 N at the needle's tip, and the moment of it. A round needle would turn about itself at 0.7 N.
        const Vec3 pull{0.2, -0.24, 0.25};
        const Vec3 arm = rotate(before.orientation, halfCircle().front());
        sim.physics().setWrench(needle, pull, cross(arm, pull));
        run(sim, 200);
        const Pose loaded = poseOf(sim, needle);
        CHECK(driver.holding() == needle);
        CHECK(distance(loaded.position, before.position) < 0.1_mm);
        CHECK(length(rotationVector(conjugate(before.orientation) * loaded.orientation)) < 1_deg);

        // It goes where the driver goes, turned over.
        sim.physics().setWrench(needle, {}, {});
        const double start = sim.physics().latest()->time;
        sim.everyStep([&](double time) {
            const double part = std::clamp((time - start) / 0.5, 0.0, 1.0);
            driver.move({{20_mm * part, 0, 0}, axisAngle({0, 0, 1}, M_PI * part)});
        });
        run(sim, 700);
        CHECK(distance(poseOf(sim, needle).position,
                       Vec3{20_mm, 0, 0} + rotate(axisAngle({0, 0, 1}, M_PI), loaded.position)) < 0.1_mm);

        driver.open();
        run(sim, 200);
        CHECK_FALSE(driver.holding());
    }
}

TEST_CASE("a needle slips out of a needle driver beyond the friction of its jaws")
{
    Simulation sim({.physics = {.gravity = {}}});
    ArticulatedInstrument driver(sim, {.kind = InstrumentKind::NeedleDriver, .opening = 0.4});
    const BodyId needle = addNeedle(sim, {kGrip, {}});
    driver.close();
    run(sim, 400);
    REQUIRE(driver.holding() == needle);
    // 2 mu times the torque over the distance from the pivot.
    const double most = 2.0 * std::sqrt(0.8 * 0.3) * 0.15 / length(kGrip);
    sim.physics().setWrench(needle, {0.9 * most, 0, 0}, {});
    run(sim, 50);
    CHECK(driver.holding() == needle);
    CHECK(driver.pull() == Approx(0.9 * most).epsilon(0.05));
    sim.physics().setWrench(needle, {1.15 * most, 0, 0}, {});
    run(sim, 50);
    CHECK_FALSE(driver.holding());
    sim.physics().setWrench(needle, {}, {});
    driver.open();
    run(sim, 100);
    CHECK_FALSE(driver.holding());
}

TEST_CASE("pick-ups hold a thread, and suture scissors cut it")
{
    Simulation sim({.physics = {.gravity = {}}});
    physics::RodBodyDef def{.name = "thread",
                            .points = {{-30_mm, 0, -12_mm}, {30_mm, 0, -12_mm}},
                            .spacing = 1_mm,
                            .radius = 0.15_mm,
                            .collision = physics::RodCollision{},
                            .dynamicTopology = true};
    def.attachments = {{.nodes = {0}}, {.nodes = {60}}};
    const BodyId thread = sim.add(def);
    ArticulatedInstrument pickUps(sim,
                                  {.kind = InstrumentKind::PickUps, .pose = {{10_mm, 0, 3_mm}, {}}, .opening = 0.3});
    pickUps.close();
    run(sim, 400);
    CHECK(pickUps.holding() == thread);

    ArticulatedInstrument scissors(
        sim, {.kind = InstrumentKind::SutureScissors, .pose = {{-10_mm, 0, 0}, {}}, .opening = 1.0});
    run(sim, 10);
    scissors.close();
    run(sim, 700);
    CHECK_FALSE(scissors.holding());
    CHECK(sim.physics().latest()->softBody(thread)->cutEdges.size() == 1);
}

} // namespace suturing_instruments_test
