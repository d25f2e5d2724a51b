#include "filasofia/engine/native/native.h"
#include "filasofia/physics/physics_server.h"

#include "engine/rigid/rigid_bodies.h"

#include <numbers>

namespace rigid_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

Vec3 centreOf(Stage& stage) { return transform(rigidState(stage).poses[0], kBoxCentre); }

double angleBetween(Quat a, Quat b) { return length(rotationVector(a * conjugate(b))); }

} // namespace

TEST_CASE("density, total mass and a given inertia determine an element's mass")
{
    Stage stage;
    RigidBodyDef def = boxBody();
    def.elements = {Pose{}, Pose{{1, 0, 0}, {}}};
    stage.add(def);
    def.mass = TotalMass{3.0};
    stage.add(def);
    const Quat axes = axisAngle({0, 0, 1}, 0.5 * std::numbers::pi);
    def.mass = GivenInertia{.mass = 0.5, .centre = {1, 2, 3}, .moments = {2, 3, 4}, .axes = axes};
    stage.add(def);
    stage.step(0.0);
    const std::vector<RigidBody>& bodies = stage.world.scene().rigid;
    const Mat3 inertia = 1.0 / 12.0 * Mat3::diagonal({0.0125, 0.0425, 0.05}); // for 1 kg
    REQUIRE(bodies[0].model.inertias.size() == 2);
    for (const RigidInertia& each : bodies[0].model.inertias) {
        CHECK(each.mass == Approx(1.0));
        CHECK(distance(each.centre, kBoxCentre) < 1e-15);
        CHECK(frobeniusNorm(each.inertia - inertia) < 1e-15);
    }
    CHECK(bodies[1].model.inertias[1].mass == Approx(3.0));
    CHECK(frobeniusNorm(bodies[1].model.inertias[1].inertia - 3.0 * inertia) < 1e-15);
    CHECK(bodies[2].model.inertias[0].mass == 0.5);
    CHECK(bodies[2].model.inertias[0].centre == Vec3{1, 2, 3});
    CHECK(frobeniusNorm(bodies[2].model.inertias[0].inertia - Mat3::diagonal({3, 2, 4})) < 1e-15);
}

TEST_CASE("a force acts at the centre of mass, even if the mesh's centre is off the element's origin")
{
    Stage stage;
    RigidBodyDef def = boxBody();
    def.elements = {{{1, 2, 3}, axisAngle({1, 2, -1}, 0.7)}};
    stage.add(def);
    const Vec3 force{0.3, -2, 1};
    stage.post(SetWrench{BodyId{1}, 0, force, {}});
    stage.step(0.01);
    CHECK(distance(rigidState(stage).velocities[0], 0.01 * force) < 1e-15);
    CHECK(length(rigidState(stage).angularVelocities[0]) < 1e-15);
    CHECK(distance(rigidState(stage).poses[0].position, Vec3{1, 2, 3} + 1e-4 * force) < 1e-15);
    stage.step(0.01); // it acts until it is changed
    CHECK(distance(rigidState(stage).velocities[0], 0.02 * force) < 1e-15);
    stage.post(SetWrench{BodyId{1}, 0, {}, {}});
    stage.step(0.01);
    CHECK(distance(rigidState(stage).velocities[0], 0.02 * force) < 1e-15);
}

TEST_CASE("a torque rotates a body about its centre of mass, which stays in place")
{
    const double dt = 0.01, moment = 0.05 / 12.0; // about the element's z axis, for 1 kg
    Stage stage;
    RigidBodyDef def = boxBody();
    def.elements = {{{1, 2, 3}, axisAngle({1, 0, 0}, 0.5 * std::numbers::pi)}}; // that axis points along -y
    stage.add(def);
    stage.post(SetWrench{BodyId{1}, 0, {}, {0, -0.6, 0}});
    stage.step(0.0);
    const Vec3 before = centreOf(stage);
    for (int i = 1; i <= 20; ++i) {
        stage.step(dt);
        CHECK(distance(rigidState(stage).angularVelocities[0], {0, -i * dt * 0.6 / moment, 0}) < 1e-11);
        CHECK(distance(centreOf(stage), before) < 1e-14);
    }
    const double angle = dt * dt * 0.6 / moment * 20 * 21 / 2;
    CHECK(angleBetween(rigidState(stage).poses[0].orientation,
                       axisAngle({0, -1, 0}, angle) * def.elements[0].orientation) < 1e-12);
}

TEST_CASE("gravity moves dynamic bodies unless they refuse it, and no kinematic body")
{
    Stage stage;
    RigidBodyDef def = boxBody();
    stage.add(def);
    def.gravity = true;
    stage.add(def);
    stage.add(RigidBodyDef{});
    stage.post(SetGravity{{0, -10, 0}});
    stage.run(10, 0.01);
    CHECK(rigidState(stage, 0).poses[0] == Pose{});
    CHECK(rigidState(stage, 1).velocities[0].y == Approx(-1.0));
    CHECK(rigidState(stage, 2).poses[0] == Pose{});
}

TEST_CASE("a kinematic element moves with constant velocity and arrives exactly")
{
    Stage stage;
    stage.add(RigidBodyDef{.elements = {{{0, 1, 0}, axisAngle({0, 0, 1}, 3.0)}, Pose{}}});
    stage.step(0.01);
    const Pose there{{0.1, 1.02, 0}, axisAngle({0, 0, 1}, 3.4)}; // beyond half a turn: the short way is 0.4
    stage.post(SetPose{BodyId{1}, 0, there});
    stage.step(0.01);
    CHECK(rigidState(stage).poses[0] == there);
    CHECK(distance(rigidState(stage).velocities[0], {10, 2, 0}) < 1e-12);
    CHECK(distance(rigidState(stage).angularVelocities[0], {0, 0, 40}) < 1e-11);
    CHECK(rigidState(stage).velocities[1] == Vec3{});
    stage.step(0.01);
    CHECK(rigidState(stage).poses[0] == there);
    CHECK(rigidState(stage).velocities[0] == Vec3{});
    CHECK(rigidState(stage).angularVelocities[0] == Vec3{});
}

TEST_CASE("the plan's velocity of a kinematic element leads to its target for rotations of any size")
{
    std::mt19937 random(7);
    for (int i = 0; i < 100; ++i) {
        const Pose from{randomVec3(random, 1.0), randomRotation(random)};
        const Pose to{from.position + randomVec3(random, 0.01), randomRotation(random)};
        const RigidChange velocity = velocitiesBetween(from, to, 0.005);
        CHECK(length(velocity.angular) <= std::numbers::pi / 0.005 * (1 + 1e-12));
        const Pose arrived = moved(from, {}, velocity.linear, velocity.angular, 0.005);
        CHECK(distance(arrived.position, to.position) < 1e-14);
        CHECK(angleBetween(arrived.orientation, to.orientation) < 1e-13);
    }
}

TEST_CASE("a jump faster than 20 m/s arrives without a velocity")
{
    Stage stage;
    stage.add(RigidBodyDef{});
    stage.step(0.01);
    stage.post(SetPose{BodyId{1}, 0, {{0.199, 0, 0}, {}}});
    stage.step(0.01);
    CHECK(rigidState(stage).velocities[0].x == Approx(19.9));
    const Pose far{{0.4, 0, 0}, axisAngle({1, 0, 0}, 1.0)};
    stage.post(SetPose{BodyId{1}, 0, far});
    stage.step(0.01);
    CHECK(rigidState(stage).poses[0] == far);
    CHECK(rigidState(stage).velocities[0] == Vec3{});
    CHECK(rigidState(stage).angularVelocities[0] == Vec3{});
}

TEST_CASE("while paused a kinematic element is placed at once, and a dynamic one keeps its motion")
{
    PhysicsServer server(makeNativeEngine({.threads = 1}), {.gravity = {0, -10, 0}});
    const BodyId kinematic = server.add(RigidBodyDef{});
    RigidBodyDef def = boxBody();
    def.gravity = true;
    const BodyId box = server.add(def);
    server.step(0.1);
    server.pause(true);
    server.setPose(kinematic, {{0, 0, 1}, {}});
    server.step(0.1);
    CHECK(server.latest()->rigidBody(kinematic)->poses[0].position == Vec3{0, 0, 1});
    CHECK(server.latest()->rigidBody(kinematic)->velocities[0] == Vec3{});
    CHECK(server.latest()->rigidBody(box)->velocities[0].y == Approx(-1.0));
    CHECK(server.latest()->rigidBody(box)->poses[0].position.y == Approx(-0.1));
    server.pause(false);
    server.step(0.1);
    CHECK(server.latest()->rigidBody(kinematic)->poses[0].position == Vec3{0, 0, 1});
    CHECK(server.latest()->rigidBody(kinematic)->velocities[0] == Vec3{});
    CHECK(server.latest()->rigidBody(box)->poses[0].position.y == Approx(-0.3));
}

TEST_CASE("a pose command places a dynamic body at once and at rest")
{
    Stage stage;
    RigidBodyDef def = boxBody();
    def.velocity = {1, 0, 0};
    def.angularVelocity = {0, 3, 0};
    stage.add(def);
    stage.run(5, 0.01);
    const Pose there{{3, 4, 5}, axisAngle({0, 1, 0}, 1.0)};
    stage.post(SetPose{BodyId{1}, 0, there});
    stage.run(5, 0.01);
    CHECK(distance(rigidState(stage).poses[0].position, there.position) < 1e-14);
    CHECK(angleBetween(rigidState(stage).poses[0].orientation, there.orientation) < 1e-14);
    CHECK(rigidState(stage).velocities[0] == Vec3{});
    CHECK(rigidState(stage).angularVelocities[0] == Vec3{});
}

TEST_CASE("reset restores the poses and velocities that rigid bodies started with, and keeps their wrenches")
{
    Stage stage;
    RigidBodyDef def = boxBody();
    def.velocity = {1, 0, 0};
    def.angularVelocity = {1, 2, 3};
    stage.add(def);
    stage.add(RigidBodyDef{.elements = {{{0, 0, 9}, {}}}});
    stage.post(SetWrench{BodyId{1}, 0, {1, 2, 3}, {4, 5, 6}});
    std::vector<Pose> first;
    for (int i = 0; i < 20; ++i) {
        stage.step(0.01);
        first.push_back(rigidState(stage).poses[0]);
    }
    stage.post(SetPose{BodyId{2}, 0, {{0, 0, 9.01}, {}}}); // a reset clears an earlier pose command
    stage.post(Reset{});
    stage.step(0.0);
    CHECK(rigidState(stage).poses[0] == Pose{});
    CHECK(rigidState(stage).velocities[0] == Vec3{1, 0, 0});
    CHECK(rigidState(stage).angularVelocities[0] == Vec3{1, 2, 3});
    for (int i = 0; i < 20; ++i) {
        stage.step(0.01);
        REQUIRE(rigidState(stage).poses[0] == first[i]);
    }
    CHECK(rigidState(stage, 1).poses[0].position == Vec3{0, 0, 9});
}

TEST_CASE("adding or removing a rigid body leaves the others bit-identical")
{
    const auto build = [](Stage& stage) {
        for (double spin : {3.0, 5.0, 7.0}) stage.add(tumbling({1e-4, 2e-4, 2.5e-4}, {0.1, spin, 0}));
        stage.run(10, 0.01);
    };
    Stage all, fewer;
    build(all);
    build(fewer);
    fewer.post(RemoveBody{BodyId{2}});
    all.run(10, 0.01);
    fewer.run(10, 0.01);
    CHECK(rigidState(fewer, 0).poses == rigidState(all, 0).poses);
    CHECK(rigidState(fewer, 1).poses == rigidState(all, 2).poses);
    fewer.post(SetWrench{BodyId{3}, 0, {2, 0, 0}, {}}); // the id still finds its body
    fewer.step(0.01);
    CHECK(rigidState(fewer, 0).velocities[0] == Vec3{});
    CHECK(rigidState(fewer, 1).velocities[0].x == Approx(0.01));
}

TEST_CASE("a change of the plan between its two halves changes the motion")
{
    Stage stage;
    RigidBodyDef def = boxBody();
    def.velocity = {1, 0, 0};
    def.angularVelocity = {0, 0, 2};
    stage.add(def);
    stage.add(RigidBodyDef{.elements = {{{0, 5, 0}, {}}}});
    stage.step(0.0);
    Scene& scene = stage.world.scene();
    scene.gravity = {0, -10, 0};
    RigidPlan plan;
    planRigid(scene, 0.01, plan);
    REQUIRE(plan.size() == 2);
    CHECK(plan[0].dynamic);
    CHECK(plan[0].mass == Approx(1.0));
    CHECK(distance(plan[0].centre, kBoxCentre) < 1e-15);
    CHECK(plan[0].velocity == Vec3{1, 0, 0});
    CHECK((plan[1].body == 1 && !plan[1].dynamic && plan[1].mass == 0.0));
    CHECK(plan[1].centre == Vec3{0, 5, 0});

    plan[0].change = {-1.0 * plan[0].velocity, -1.0 * plan[0].angularVelocity}; // a wall that stops it
    StepReport report;
    WorkerPool pool(1);
    moveRigid({0.01, nullptr, ExactContact{}, pool, report}, plan, scene);
    CHECK(report.flags == 0);
    CHECK(distance(scene.rigid[0].state.poses[0].position, {}) < 1e-15);
    CHECK(scene.rigid[0].state.velocities[0] == Vec3{});
    CHECK(length(scene.rigid[0].state.angularVelocities[0]) < 1e-15);
}

TEST_CASE("an element whose new state would not be finite stays at rest, and the step reports it")
{
    Stage stage;
    RigidBodyDef def = boxBody();
    def.elements = {{{1, 2, 3}, {}}, {{4, 5, 6}, {}}};
    def.velocity = {1, 0, 0};
    stage.add(def);
    for (const Wrench wrench : {Wrench{{1e308, 0, 0}, {}}, Wrench{{0, 1e9, 0}, {}}, Wrench{{}, {0, 0, 1e300}}}) {
        stage.post(Reset{});
        stage.post(SetWrench{BodyId{1}, 0, wrench.force, wrench.torque});
        const StepReport report = stage.step(0.01);
        CHECK(report.has(StepFlag::Undone));
        CHECK(report.undone == std::vector{BodyId{1}});
        CHECK(rigidState(stage).poses[0] == def.elements[0]);
        CHECK(rigidState(stage).velocities[0] == Vec3{});
        CHECK(rigidState(stage).poses[1].position.x == Approx(4.01)); // the other one continues
    }
    stage.post(SetWrench{BodyId{1}, 0, {1, 0, 0}, {}});
    CHECK_FALSE(stage.step(0.01).has(StepFlag::Undone));
    CHECK(rigidState(stage).velocities[0].x == Approx(0.01));
}

TEST_CASE("a body that leaves the world is stopped at its boundary")
{
    Stage stage;
    RigidBodyDef def = boxBody();
    def.elements = {{{9999, 0, 0}, {}}};
    def.velocity = {100, 0, 0};
    stage.add(def);
    CHECK_FALSE(stage.step(0.005).has(StepFlag::Undone));
    CHECK(stage.step(0.01).has(StepFlag::Undone));
    CHECK(rigidState(stage).poses[0].position.x == Approx(9999.5));
    CHECK_FALSE(stage.step(0.01).has(StepFlag::Undone));
}

TEST_CASE("frames show the velocities of the centres of mass")
{
    PhysicsServer server(makeNativeEngine({.threads = 1}), {.gravity = {0, 0, 0}});
    RigidBodyDef def = boxBody();
    def.elements = {Pose{}, Pose{}};
    def.angularVelocity = {0, 0, 4};
    const BodyId box = server.add(def);
    server.step(0.01);
    server.setWrench(box, {5, 0, 0}, {}, 1);
    server.step(0.01);
    const frame::FrameRef frame = server.latest();
    REQUIRE(frame->rigidBody(box)->velocities.size() == 2);
    CHECK(length(frame->rigidBody(box)->velocities[0]) < 1e-15);
    CHECK(frame->rigidBody(box)->velocities[1].x == Approx(0.05));
    REQUIRE(frame->rigidBody(box)->angularVelocities.size() == 2);
    CHECK(frame->rigidBody(box)->angularVelocities[0].z == Approx(4.0));
}

} // namespace rigid_test
