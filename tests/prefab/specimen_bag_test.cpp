#include "filasofia/prefab/specimen_bag.h"

#include "filasofia/core/error.h"
#include "filasofia/core/units.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/prefab/laparoscopic_instrument.h"

#include <catch2/catch.hpp>

#include <numbers>

namespace specimen_bag_test {

using namespace filasofia;
using namespace filasofia::prefab;
using runtime::Simulation;

namespace {

constexpr double kGravity = 9.81, kBall = 0.05; // [kg]
constexpr double kDensity = 1150.0, kThickness = 0.1e-3;
const Vec3 kMiddle = {0, 0, -65_mm * std::cos(std::numbers::pi / 6) * 2.0 / 3.0}; // the mouth's, from the pivot
const double kRoll = 0.5 * std::numbers::pi;                                      // the mouth lies, the bag hangs down

ArticulatedInstrumentDef holderOf(const Pose& pose, double opening = 1.0)
{
    return {.name = "holder", .kind = InstrumentKind::SpecimenBag, .pose = pose, .groups = {}, .opening = opening};
}
BodyId addBall(Simulation& sim, Vec3 at)
{
    physics::RigidBodyDef def{
        .name = "ball", .elements = {{at, {}}}, .mesh = geometry::shapes::sphere(12_mm, 4), .dynamic = true};
    def.mass = physics::TotalMass{kBall};
    def.collision = {{.proximity = 0.5_mm}};
    return sim.add(def);
}
double massOf(Simulation& sim, BodyId film)
{
    const auto mesh = physics::worldShell(std::get<physics::SoftBodyDef>(*sim.physics().def(film)));
    double area = 0.0;
    for (const auto& [a, b, c] : mesh.triangles) {
        const auto at = [&](int i) { return mesh.vertices[static_cast<std::size_t>(i)]; };
        area += 0.5 * length(cross(at(b) - at(a), at(c) - at(a)));
    }
    return area * kThickness * kDensity;
}

/// An instrument along -z whose arms spread in the plane xz, a bag that hangs down from them, and a ball in it.
struct Theatre {
    Simulation sim{runtime::SimulationDef{.physics = {.threads = 1}}};
    ArticulatedInstrument tool{sim, holderOf({{}, axisAngle({0, 0, 1}, kRoll)})};
    SpecimenBag bag{sim, tool};
    BodyId ball = addBall(sim, kMiddle + Vec3{0, -55_mm, 0});

    runtime::RunReport run(int steps)
    {
        return sim.run({.headless = true, .backend = visual::Backend::Null, .steps = steps});
    }
    Pose ballPose() { return sim.physics().latest()->rigidBody(ball)->poses[0]; }
};

} // namespace

TEST_CASE("a bag carries a ball: within a second it is at rest, and the instrument bears its weight and the film's")
{
    Theatre it;
    const double weight = kGravity * (kBall + massOf(it.sim, it.bag.body()));
    const auto report = it.run(1000);
    CHECK(report.intersecting == 0);
    CHECK(report.undone == 0);
    CHECK(report.notConverged == 0);
    const auto frame = it.sim.physics().latest();
    CHECK(length(frame->rigidBody(it.ball)->velocities[0]) < 1e-3);
    for (const Vec3& each : frame->softBody(it.bag.body())->velocities) CHECK(length(each) < 2e-3);
    CHECK(-it.bag.load().y == Approx(weight).epsilon(0.02));
    CHECK(std::hypot(it.bag.load().x, it.bag.load().z) < 0.02 * weight);
    CHECK(it.bag.share(it.ball) == 1.0);
    CHECK(it.ballPose().position.y > -75_mm); // the film gives way by less than 5 mm

    it.tool.close(); // the mouth becomes a slit, and the ball stays
    CHECK(it.run(1000).intersecting == 0);
    const auto& film = it.sim.physics().latest()->softBody(it.bag.body())->positions;
    CHECK(distance(film[8], film[16]) < 5_mm);
    CHECK(it.bag.share(it.ball) == 1.0);
    CHECK(-it.bag.load().y == Approx(weight).epsilon(0.02));
}

TEST_CASE("the hand of a trocar feels what is in a bag by the law of the lever")
{
    Simulation sim{runtime::SimulationDef{.physics = {.threads = 1}}};
    LaparoscopicInstrumentDef def{.name = "holder", .tool = holderOf({})};
    def.tool.name = ArticulatedInstrumentDef{}.name;
    def.start = {.insertion = 0.1, .roll = kRoll};
    def.trocar.wallStiffness = physics::kHard;
    LaparoscopicInstrument tool(sim, def);
    SpecimenBag bag(sim, tool.tool());
    const auto run = [&](int steps) { sim.run({.headless = true, .backend = visual::Backend::Null, .steps = steps}); };
    const double outside = def.hand.length - def.start.insertion;
    addBall(sim, Vec3{0, -55_mm, -0.1} + kMiddle);
    run(1200);
    const double weight = kGravity * (kBall + massOf(sim, bag.body()));
    CHECK(-bag.load().y == Approx(weight).epsilon(0.02));
    CHECK(std::abs(tool.report().force.y) == Approx(weight * (0.1 - kMiddle.z) / outside).epsilon(0.02));
}

TEST_CASE("a bag knows what is in it")
{
    Theatre it;
    physics::RigidBodyDef far{.name = "far", .elements = {{kMiddle + Vec3{0, 5_mm, 0}}, {kMiddle + Vec3{0, -5_mm, 0}}}};
    const BodyId two = it.sim.add(far);
    physics::SoftBodyDef soft{.name = "soft", .mesh = geometry::shapes::block({10_mm, 40_mm, 10_mm}, {2, 8, 2})};
    soft.pose.position = kMiddle + Vec3{0, 2.5_mm, 0}; // three of its nine layers of nodes are above the mouth
    soft.gravity = false;
    const BodyId block = it.sim.add(soft);
    CHECK(it.bag.share(it.ball) == 0.0); // nothing is known before the first step
    it.run(1);
    CHECK(it.bag.share(it.ball) == 1.0);
    CHECK(it.bag.share(two) == 0.5);
    CHECK(it.bag.share(block) == Approx(4.0 / 9.0));
    CHECK(it.bag.share(it.tool.body()) == 0.0);
    CHECK(distance(it.bag.mouth(), kMiddle) < 0.1_mm);
}

TEST_CASE("a bag says what is wrong with its Def")
{
    Simulation sim{runtime::SimulationDef{}};
    ArticulatedInstrument closed(sim, holderOf({}, 0.0)), open(sim, holderOf({}));
    CHECK_THROWS_WITH(SpecimenBag(sim, closed),
                      Catch::Contains("specimen bag 'specimen bag': the tool must be open at the start"));
    CHECK_THROWS_WITH(SpecimenBag(sim, open, {.cells = 2}), Catch::Contains("cells must be in [3, 100], got 2"));
    const BodyId plain = sim.add(physics::RigidBodyDef{.name = "plain"});
    CHECK_THROWS_WITH(SpecimenBag(sim, plain), Catch::Contains("must be a rigid body with two joints"));
}

} // namespace specimen_bag_test
