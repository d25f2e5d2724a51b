#include "engine/articulation/jaw.h"
#include "engine/rods.h"
#include "engine/stage.h"

namespace start_velocity_test {

using namespace filasofia;
using namespace filasofia::engine;
using Catch::Contains;

namespace {

constexpr Vec3 kVelocity{0.3, -0.2, 0.1}; // [m/s]

Vec3 momentumOf(Stage& stage)
{
    Vec3 sum;
    for (std::size_t i = 0; i < stage.model().masses.size(); ++i) sum += stage.model().masses[i] * stage.soft().v[i];
    return sum;
}

} // namespace

TEST_CASE("a soft body starts with its velocity, keeps it, and has it again after a reset")
{
    for (const bool assembled : {false, true}) {
        Stage stage;
        physics::SoftBodyDef def = freeBody(boxMesh({2, 2, 2}, {0.02, 0.02, 0.02}));
        def.solver = physics::ConjugateGradient{.assembled = assembled};
        def.velocity = kVelocity;
        stage.add(def);
        stage.step(0.0);
        const double mass = 1000.0 * 0.02 * 0.02 * 0.02;
        CHECK(distance(momentumOf(stage), mass * kVelocity) < 1e-15);
        const Vec3 before = stage.soft().x[3];
        stage.run(100, 1e-3);
        CHECK(distance(momentumOf(stage), mass * kVelocity) < 1e-6 * mass);
        CHECK(distance(stage.soft().x[3], before + 0.1 * kVelocity) < 1e-6);
        stage.post(physics::SetForces{{1}, {{0, {0, 1, 0}}}});
        stage.run(10, 1e-3);
        CHECK(distance(momentumOf(stage), mass * kVelocity) > 0.1 * mass * length(kVelocity));
        stage.post(physics::Reset{});
        stage.step(0.0);
        CHECK(distance(momentumOf(stage), mass * kVelocity) < 1e-15);
        CHECK(stage.soft().x[3] == before);
    }
}

TEST_CASE("nodes that are pinned do not start to move, those of a rod neither")
{
    Stage stage;
    physics::RodBodyDef def = rods::thread();
    def.velocity = kVelocity;
    stage.add(def);
    stage.step(0.0);
    for (std::size_t i = 0; i < stage.soft().v.size(); ++i) CHECK(stage.soft().v[i] == (i < 2 ? Vec3{} : kVelocity));
}

TEST_CASE("a joint starts with its velocity, carries its link, and has it again after a reset")
{
    Stage stage;
    physics::RigidBodyDef def = jawBody(physics::JointForce{});
    def.articulation.joints[0].velocity = 2.0;
    stage.add(def);
    stage.step(0.0);
    const auto isAtStart = [&] {
        const RigidState& state = stage.world.scene().rigid[0].state;
        CHECK(state.joints[0].now.velocity == 2.0);
        CHECK(state.joints[0].now.position == 0.0);
        CHECK(distance(state.velocities[1], {0, 2.0 * kArm, 0}) < 1e-15);
        CHECK(stage.world.energyOf({1}).kinetic == Approx(0.5 * kHingeInertia * 4.0).epsilon(1e-12));
    };
    isAtStart();
    stage.run(100, 1e-3); // nothing brakes it
    CHECK(stage.world.scene().rigid[0].state.joints[0].now.position == Approx(0.2).epsilon(1e-9));
    stage.post(physics::SetJoint{{1}, 0, physics::JointForce{1e-3}});
    stage.run(10, 1e-3);
    stage.post(physics::Reset{});
    stage.step(0.0);
    isAtStart();
}

TEST_CASE("velocities that no body can start with are refused")
{
    physics::SoftBodyDef soft = freeBody(tetrahedronMesh());
    soft.velocity = {2e4, 0, 0};
    CHECK_THROWS_WITH(physics::check(soft), Contains("velocity must have a length < 10000, got 20000 0 0"));
    physics::RodBodyDef rod = rods::thread();
    rod.velocity = {0, 0, -2e4};
    CHECK_THROWS_WITH(physics::check(rod), Contains("rod 'silk': velocity must have a length < 10000"));
    physics::RigidBodyDef jaw = jawBody(physics::JointPosition{});
    jaw.articulation.joints[0].velocity = 1.0;
    CHECK_THROWS_WITH(physics::check(jaw),
                      Contains("articulation.joints[0].velocity must be 0 rad/s unless the joint's command is a "
                               "JointForce (0 lets it move freely) or a JointSpring, got 1"));
    jaw.articulation.joints[0].command.reset();
    CHECK_THROWS_WITH(physics::check(jaw), Contains("joints[0].velocity must be 0 rad/s"));
    jaw.articulation.joints[0].command = physics::JointForce{};
    CHECK_NOTHROW(physics::check(jaw));
    jaw.articulation.joints[0].velocity = -1e4;
    CHECK_THROWS_WITH(physics::check(jaw), Contains("joints[0].velocity must be in (-10000, 10000) rad/s, got -10000"));
}

} // namespace start_velocity_test
