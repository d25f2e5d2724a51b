#include "sofa/sofa_stage.h"

namespace rigid_body_test {

using namespace filasofia;
using namespace filasofia::physics;
using namespace filasofia::sofa_test;

namespace {

RigidBodyDef ball() { return {.name = "ball", .dynamic = true, .mass = GivenInertia{.mass = 0.2}}; }

} // namespace

TEST_CASE("a rigid body falls, turns and is pushed as backward Euler says")
{
    const auto server = serverWith("sofa");
    RigidBodyDef def = ball();
    def.elements = {Pose{}, {{1, 0, 0}, {}}};
    def.angularVelocity = {0, 0, 2};
    const BodyId body = server->add(def);
    server->setWrench(body, {0.4, 0, 0}, {}, 1);
    steps(*server, 100, 1e-3);
    const auto frame = server->latest();
    const auto& state = *frame->rigidBody(body);
    REQUIRE(state.poses.size() == 2);
    const double way = 1e-6 * 100 * 101 / 2; // per unit of acceleration
    CHECK(state.poses[0].position.y == Approx(-9.81 * way).epsilon(1e-9));
    CHECK(state.poses[0].position.x == Approx(0.0).margin(1e-12));
    CHECK(state.poses[1].position.x == Approx(1 + 2.0 * way).epsilon(1e-9)); // 0.4 N on 0.2 kg
    CHECK(length(rotationVector(state.poses[0].orientation) - Vec3{0, 0, 0.2}) < 1e-6);
    CHECK(state.angularVelocities[0].z == Approx(2.0).epsilon(1e-9));
}

TEST_CASE("the origin of an element is not its centre of mass")
{
    const auto server = serverWith("sofa", 1e-3, {});
    RigidBodyDef def = ball();
    def.mass = GivenInertia{.mass = 0.2, .centre = {0.1, 0, 0}};
    def.angularVelocity = {0, 0, 3};
    const BodyId body = server->add(def);
    steps(*server, 200, 1e-3);
    const Pose pose = server->latest()->rigidBody(body)->poses[0];
    CHECK(length(transform(pose, {0.1, 0, 0}) - Vec3{0.1, 0, 0}) < 1e-9); // the centre stays
    CHECK(length(pose.position) > 0.01);
}

TEST_CASE("a kinematic body is where its command says at the end of the step")
{
    const auto server = serverWith("sofa");
    const BodyId body = server->add(RigidBodyDef{.name = "tool"});
    const Pose target{{0.004, 0, 0}, axisAngle({0, 0, 1}, 0.01)};
    server->setPose(body, target);
    server->step(1e-3);
    const auto& moved = *server->latest()->rigidBody(body);
    CHECK(moved.poses[0] == target);
    CHECK(length(moved.velocities[0] - Vec3{4, 0, 0}) < 1e-9);
    CHECK(moved.angularVelocities[0].z == Approx(10.0));
    server->step(1e-3);
    CHECK(length(server->latest()->rigidBody(body)->velocities[0]) == 0.0);
    server->setPose(body, {{1, 0, 0}, {}}); // faster than 20 m/s: it jumps
    server->step(1e-3);
    CHECK(server->latest()->rigidBody(body)->poses[0].position.x == 1.0);
    CHECK(length(server->latest()->rigidBody(body)->velocities[0]) == 0.0);
}

TEST_CASE("damping slows a rigid body, and without gravity it stays")
{
    const auto server = serverWith("sofa");
    RigidBodyDef damped = ball(), still = ball();
    damped.gravity = still.gravity = false;
    damped.velocity = {1, 0, 0};
    damped.linearDamping = damped.angularDamping = 2.0;
    const BodyId a = server->add(damped), b = server->add(still);
    steps(*server, 1000, 1e-3);
    const auto frame = server->latest();
    CHECK(frame->rigidBody(a)->velocities[0].x == Approx(std::pow(1 + 2e-3, -1000)).epsilon(1e-6));
    CHECK(length(frame->rigidBody(b)->poses[0].position) < 1e-12);
}

TEST_CASE("a body that tumbles freely keeps its angular momentum and its energy, and turns as in the native engine")
{
    const Vec3 moments{1e-4, 2e-4, 2.5e-4};
    Quat end[2];
    int e = 0;
    for (const std::string engine : {"native", "sofa"}) {
        CAPTURE(engine);
        const auto server = serverWith(engine, 1e-3, {});
        RigidBodyDef def = ball();
        def.mass = GivenInertia{.mass = 0.2, .moments = moments};
        def.angularVelocity = {0.1, 5, 0.2}; // about the middle axis: it turns over
        const BodyId body = server->add(def);
        double overturned = 1.0;
        for (int i = 0; i < 4000; ++i) {
            server->step(1e-3);
            const auto frame = server->latest();
            const Pose pose = frame->rigidBody(body)->poses[0];
            const Vec3 w = rotate(conjugate(pose.orientation), frame->rigidBody(body)->angularVelocities[0]);
            const Vec3 own{moments.x * w.x, moments.y * w.y, moments.z * w.z};
            overturned = std::min(overturned, rotate(pose.orientation, {0, 1, 0}).y);
            if (i % 500 != 499) continue;
            CHECK(length(rotate(pose.orientation, own) - Vec3{1e-5, 1e-3, 5e-5}) < 1e-8);
            CHECK(0.5 * dot(own, w) == Approx(0.5 * (1e-4 * 0.01 + 2e-4 * 25 + 2.5e-4 * 0.04)).epsilon(1e-5));
        }
        CHECK(overturned < -0.9);
        end[e++] = server->latest()->rigidBody(body)->poses[0].orientation;
    }
    CHECK(length(rotationVector(end[0] * conjugate(end[1]))) < 5e-3); // after 20 rad
}

TEST_CASE("the axis of a top that is free goes around its momentum with L / I")
{
    const auto server = serverWith("sofa", 1e-3, {});
    RigidBodyDef def = ball();
    const double across = 1e-4, along = 1.6e-4;
    def.mass = GivenInertia{.mass = 0.2, .moments = {across, along, across}};
    def.angularVelocity = {3, 10, 0};
    const BodyId body = server->add(def);
    const Vec3 momentum{across * 3, along * 10, 0};
    steps(*server, 1000, 1e-3);
    const Vec3 axis = rotate(server->latest()->rigidBody(body)->poses[0].orientation, {0, 1, 0});
    const Vec3 expected =
        rotate(axisAngle(normalized(momentum), std::fmod(length(momentum) / across, 2 * M_PI)), {0, 1, 0});
    CHECK(length(axis - expected) < 1e-3);
}

} // namespace rigid_body_test
