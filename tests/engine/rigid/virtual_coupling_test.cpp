#include "engine/rigid/rigid_bodies.h"

namespace virtual_coupling_test {

using namespace filasofia;
using namespace filasofia::engine;
using physics::HapticTarget;
using physics::SetHaptic;

namespace {

MotionState centreOf(Stage& stage)
{
    const RigidState& state = rigidState(stage);
    const Vec3 centre = stage.world.scene().rigid[0].model.inertias[0].centre;
    return {{transform(state.poses[0], centre), state.poses[0].orientation},
            state.velocities[0],
            state.angularVelocities[0]};
}

/// The force of the coupling on the body at the end of the last step.
CouplingForce couplingForceOn(Stage& stage, const HapticTarget& hand)
{
    const Vec3 centre = stage.world.scene().rigid[0].model.inertias[0].centre;
    return couplingForce(hand.coupling, atPoint({hand.pose, hand.velocity, hand.angularVelocity}, centre),
                         centreOf(stage));
}

} // namespace

TEST_CASE("a coupling changes an element's momentum by its force at the step's end times the step")
{
    for (const double dt : {1e-4, 1e-3, 5e-2}) {
        Stage stage;
        stage.add(boxBody());
        const HapticTarget hand{.pose = {{0.01, -0.02, 0.03}, axisAngle({1, 2, 3}, 1e-4)},
                                .velocity = {0.1, 0, 0},
                                .coupling = {.linearStiffness = 800, .linearDamping = 3}};
        stage.post(SetHaptic{BodyId{1}, 0, hand});
        stage.step(dt);
        const CouplingForce pull = couplingForceOn(stage, hand);
        CHECK(distance(centreOf(stage).velocity, dt * pull.force) < 1e-12 * length(pull.force));     // 1 kg
        CHECK(distance(angularMomentum(stage), dt * pull.torque) < 1e-3 * dt * length(pull.torque)); // first order
    }
}

TEST_CASE("a coupled element comes to rest at the device's pose for every step and stiffness")
{
    for (const double dt : {1e-4, 1e-3, 2e-2, 5e-2})
        for (const double stiffness : {1.0, 1e3, 1e6}) {
            Stage stage;
            stage.add(boxBody());
            const HapticTarget hand{.pose = {{0.05, 0.1, -0.02}, axisAngle({1, 1, 0}, 1.0)},
                                    .coupling = {.linearStiffness = stiffness,
                                                 .linearDamping = 2.0 * std::sqrt(stiffness),
                                                 .angularStiffness = 1e-2 * stiffness,
                                                 .angularDamping = 2e-2 * std::sqrt(stiffness)}};
            stage.post(SetHaptic{BodyId{1}, 0, hand});
            const int steps = static_cast<int>(40.0 / std::sqrt(stiffness) / dt) + 100;
            double farthest = 0.0;
            const Vec3 goal = hand.pose.position;
            for (int i = 0; i < steps; ++i) {
                stage.step(dt);
                farthest = std::max(farthest, distance(rigidState(stage).poses[0].position, goal));
            }
            INFO("dt " << dt << " s, " << stiffness << " N/m");
            CHECK(distance(rigidState(stage).poses[0].position, goal) < 1e-5);
            CHECK(length(rotationVector(rigidState(stage).poses[0].orientation * conjugate(hand.pose.orientation))) <
                  1e-4);
            CHECK(farthest < 2.0 * length(goal) + 0.2); // on its way it rotates about its centre
        }
}

TEST_CASE("a coupling carries the weight, and the body hangs lower by weight over stiffness")
{
    Stage stage;
    physics::RigidBodyDef def = boxBody();
    def.gravity = true;
    stage.add(def);
    stage.post(physics::SetGravity{{0, -9.81, 0}});
    const HapticTarget hand{.coupling = {.linearStiffness = 1000, .linearDamping = 60, .angularDamping = 0.1}};
    stage.post(SetHaptic{BodyId{1}, 0, hand});
    stage.run(2000, 1e-3);
    CHECK(rigidState(stage).poses[0].position.y == Approx(-9.81e-3).epsilon(1e-6));
    CHECK(distance(couplingForceOn(stage, hand).force, {0, 9.81, 0}) < 1e-6);

    HapticTarget weak = hand;
    weak.coupling.forceLimit = 5.0; // too weak: the body sinks as under half its weight
    stage.post(SetHaptic{BodyId{1}, 0, weak});
    for (int i = 0; i < 100; ++i) {
        stage.step(1e-3);
        CHECK(length(couplingForceOn(stage, weak).force) < 5.0 + 1e-12);
    }
    CHECK(rigidState(stage).velocities[0].y < -0.3);

    stage.post(SetHaptic{BodyId{1}, 0, {.coupling = {0, 0, 0, 0}}}); // zero stiffness releases it
    CHECK_FALSE(rigidState(stage).couplings.empty());
    const double before = rigidState(stage).velocities[0].y;
    stage.step(0.1);
    CHECK(rigidState(stage).couplings.empty());
    CHECK(rigidState(stage).velocities[0].y == Approx(before - 0.981));
}

TEST_CASE("a coupled element that is blocked presses with the coupling's force")
{
    Stage stage;
    physics::RigidBodyDef floor{.name = "floor", .mesh = boxSurface({1, 1, 1})};
    floor.elements = {{{-0.5, -1, -0.5}, {}}};
    floor.collision = {{}};
    physics::RigidBodyDef box = boxBody();
    box.elements = {{{0, 1e-3, 0}, {}}};
    box.collision = {{}};
    stage.add(floor);
    stage.add(box);
    const HapticTarget hand{.pose = {{0, -0.01, 0}, {}}, .coupling = {.linearStiffness = 400, .linearDamping = 20}};
    stage.post(SetHaptic{BodyId{2}, 0, hand});
    stage.run(1000, 1e-3);
    const double apart = rigidState(stage, 1).poses[0].position.y + 0.01;
    const Vec3 pressed = frame::forceOn(BodyId{2}, stage.world.scene().contactReports);
    CHECK(apart == Approx(0.01).epsilon(0.1)); // it rests on the floor
    CHECK(pressed.y == Approx(400 * apart).epsilon(1e-3));
}

TEST_CASE("a coupled kinematic body goes to the device's pose, and no coupling is kept")
{
    Stage stage;
    stage.add(physics::RigidBodyDef{.name = "probe", .elements = {Pose{}, Pose{}}});
    const HapticTarget hand{.pose = {{0.001, 0, 0}, axisAngle({0, 0, 1}, 0.01)}};
    stage.post(SetHaptic{BodyId{1}, 1, hand});
    stage.step(1e-3);
    CHECK(rigidState(stage).poses[1] == hand.pose);
    CHECK(rigidState(stage).poses[0] == Pose{});
    CHECK(rigidState(stage).couplings.empty());
}

TEST_CASE("a coupling is part of the state: the hash covers it, a reset keeps it, and dt = 0 moves nothing")
{
    Stage held, free;
    for (Stage* stage : {&held, &free}) stage->add(boxBody());
    held.post(SetHaptic{BodyId{1}, 0, {.pose = {{0, 0.1, 0}, {}}}});
    held.step(0.0);
    free.step(0.0);
    CHECK(held.world.hash() != free.world.hash());
    CHECK(rigidState(held).poses[0].position == Vec3{});
    held.post(physics::Reset{});
    held.step(1e-3);
    CHECK(rigidState(held).velocities[0].y > 0.0);

    RigidState& state = rigidState(held);
    const RigidModel& model = held.world.scene().rigid[0].model;
    check(model, state);
    state.couplings[0].element = 1;
    CHECK_THROWS_WITH(check(model, state), Catch::Contains("couplings[0].element must be in [0, 1), got 1"));
    state.couplings[0] = {0, {.velocity = {std::numeric_limits<double>::quiet_NaN(), 0, 0}}};
    CHECK_THROWS_WITH(check(model, state), Catch::Contains("velocity"));
}

} // namespace virtual_coupling_test
