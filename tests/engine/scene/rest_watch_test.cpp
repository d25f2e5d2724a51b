#include "filasofia/engine/scene/rest_watch.h"

#include "filasofia/geometry/shapes.h"

#include "engine/stage.h"

namespace rest_watch_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

constexpr double kStep = 0.01;

/// A box that turns without damping, far from a kinematic one.
struct Spinning {
    Stage stage;
    BodyId box, tool;

    explicit Spinning(double damping = 0.0)
    {
        RigidBodyDef def{.name = "box", .elements = {Pose{}}, .mesh = geometry::shapes::box({0.1, 0.1, 0.1})};
        def.dynamic = true;
        def.gravity = false;
        def.angularDamping = damping;
        def.angularVelocity = {0, 0, 1.0};
        box = stage.add(def);
        tool = stage.add(RigidBodyDef{.name = "tool", .elements = {Pose{{5, 0, 0}}}});
        stage.step(kStep);
    }
};

/// Follows one node of 1 kg whose height and velocity [m, m/s] are given at every second, as a scene without a drive.
struct Follower {
    RestWatch watch;
    Scene scene;

    Follower()
    {
        SoftBody& body = scene.soft.emplace_back();
        body.model.id = {1};
        body.model.masses = {1.0};
        body.state.x = body.state.v = {{}};
        scene.gravity = {0, 0, -10};
        follow(0.0, 0.0); // what drives it is new
        follow(0.0, 0.0);
    }
    StepReport follow(double height, double speed)
    {
        scene.soft[0].state.x[0].z = height;
        scene.soft[0].state.v[0].x = speed;
        StepReport report;
        watch.follow({.dt = 1.0}, scene, report);
        return report;
    }
};

} // namespace

TEST_CASE("rest watch: a body that turns on for ever is restless from the fifth second after the last drive")
{
    Spinning on;
    int first = 0;
    StepReport report;
    for (int i = 1; i <= 600; ++i) {
        report = on.stage.step(kStep);
        if (first == 0 && report.has(StepFlag::Restless)) first = i;
        CHECK(report.has(StepFlag::Restless) == (report.unrest.bodies == 1));
        CHECK(!report.has(StepFlag::EnergyGained));
    }
    CHECK(std::abs(first * kStep - 5.0) < 0.05);
    CHECK(report.unrest.body == on.box);
    CHECK(report.unrest.undriven == Approx(600 * kStep));
    const double gyration = std::sqrt(0.1 * 0.1 / 6); // [m] the cube's, about any axis
    CHECK(report.unrest.speed == Approx(gyration * 1.0).epsilon(0.02));
}

TEST_CASE("rest watch: whatever drives the scene ends unrest, and it takes five seconds to be found again")
{
    Spinning on;
    on.stage.run(550, kStep);
    CHECK(on.stage.step(kStep).has(StepFlag::Restless));
    const Pose moved{{5, 0, 0.1}};
    on.stage.post(SetPose{on.tool, 0, moved});
    CHECK(!on.stage.run(450, kStep).has(StepFlag::Restless));
    CHECK(on.stage.run(100, kStep).has(StepFlag::Restless));
    for (int i = 0; i < 10; ++i) { // a command that repeats the present state drives nothing
        on.stage.post(SetPose{on.tool, 0, moved});
        CHECK(on.stage.step(kStep).has(StepFlag::Restless));
    }
    const auto drives = [&](auto command) {
        on.stage.post(std::move(command));
        CHECK(!on.stage.step(kStep).has(StepFlag::Restless));
        CHECK(on.stage.run(550, kStep).has(StepFlag::Restless));
    };
    drives(SetGravity{{0, 0, -1e-9}});
    drives(SetWrench{on.box, 0, {1e-9, 0, 0}, {}});
    drives(Release{AttachmentId{1}});
    on.stage.post(Reset{});
    on.stage.step(0.0); // also while paused
    CHECK(!on.stage.run(450, kStep).has(StepFlag::Restless));
}

TEST_CASE("rest watch: motion that is braked, tissue that hangs, and steps without time are no unrest")
{
    Spinning braked(0.2);
    CHECK(!braked.stage.run(800, kStep).has(StepFlag::Restless));
    Stage hanging;
    hanging.add(SoftBodyDef{.mesh = shared(boxMesh({2, 2, 4}, {0.02, 0.02, 0.04})),
                            .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1, 1e-6}}}}});
    CHECK(!hanging.run(800, kStep).has(StepFlag::Restless));
    Spinning paused;
    paused.stage.run(400, kStep);
    CHECK(!paused.stage.run(600, 0.0).has(StepFlag::Restless));
}

TEST_CASE("rest watch: energy that is neither driven nor fallen for comes from nowhere")
{
    Follower growing;
    double speed = 0.01;
    int gained = 0;
    for (int second = 1; second <= 8; ++second, speed *= 1.2) {
        const StepReport report = growing.follow(0.0, speed);
        if (report.has(StepFlag::EnergyGained)) ++gained;
        CHECK(report.has(StepFlag::Restless) == (second >= 4));
    }
    CHECK(gained == 3); // restless from the fourth second on, for three windows in the sixth
    Follower falling;
    for (int second = 1; second <= 8; ++second)
        CHECK(!falling.follow(-0.5 * 10 * second * second, 10.0 * second).has(StepFlag::EnergyGained));
    Follower steady;
    for (int second = 1; second <= 8; ++second) CHECK(!steady.follow(0.0, 1.0).has(StepFlag::EnergyGained));
    Follower slow;
    for (int second = 1; second <= 8; ++second) CHECK(!slow.follow(0.0, 0.9e-3).has(StepFlag::Restless));
}

} // namespace rest_watch_test
