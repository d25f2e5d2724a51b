#include "engine/rigid/rigid_bodies.h"
#include "verification/verification.h"

#include <numbers>

namespace rigid_verification_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

constexpr Vec3 kMoments{1e-4, 2e-4, 3e-4}; // principal moments of the body that tumbles about its middle axis
constexpr Vec3 kNearMiddle{0.01, 10.0, 0.02};

/// [rad/s] Angular velocity in the element's own axes.
Vec3 inElement(Stage& stage)
{
    const RigidState& state = rigidState(stage);
    return rotate(conjugate(state.poses[0].orientation), state.angularVelocities[0]);
}

double angleBetween(Quat a, Quat b) { return length(rotationVector(a * conjugate(b))); }

struct Drift {
    double momentum = 0.0; ///< [-] largest, relative to the start
    double energy = 0.0;   ///< [-] largest, relative to the start
    int turnovers = 0;     ///< number of times that the middle axis reversed
};

Drift tumble(Vec3 moments, Vec3 angularVelocity, double dt, int steps)
{
    Stage stage;
    stage.add(tumbling(moments, angularVelocity));
    stage.step(0.0);
    const Vec3 momentum = angularMomentum(stage);
    const double energy = turningEnergy(stage);
    Drift drift;
    for (int i = 0; i < steps; ++i) {
        const double before = inElement(stage).y;
        REQUIRE_FALSE(stage.step(dt).has(StepFlag::Undone));
        drift.momentum = std::max(drift.momentum, distance(angularMomentum(stage), momentum) / length(momentum));
        drift.energy = std::max(drift.energy, std::abs(turningEnergy(stage) / energy - 1.0));
        drift.turnovers += before * inElement(stage).y < 0.0;
    }
    return drift;
}

/// A tumbling body's orientation after one second.
Quat afterASecond(int steps)
{
    Stage stage;
    stage.add(tumbling(kMoments, kNearMiddle));
    stage.run(steps, 1.0 / steps);
    return rigidState(stage).poses[0].orientation;
}

} // namespace

TEST_CASE("a falling body follows the discrete closed form")
{
    const double dt = 0.004;
    const int steps = 500;
    const Vec3 gravity{0, -9.81, 0}, start{1, 2, -0.5};
    Stage stage;
    RigidBodyDef def = boxBody();
    def.gravity = true;
    def.velocity = start;
    def.elements = {{{1, 2, 3}, axisAngle({1, 1, 0}, 1.0)}};
    stage.add(def);
    stage.post(SetGravity{gravity});
    stage.run(steps, dt);
    const Vec3 v = start + steps * dt * gravity;
    const Vec3 x = Vec3{1, 2, 3} + steps * dt * start + 0.5 * steps * (steps + 1) * dt * dt * gravity;
    verify("falling body after 500 steps, position off the discrete closed form [m]",
           distance(rigidState(stage).poses[0].position, x), 1e-12);
    verify("falling body after 500 steps, velocity off the discrete closed form [m/s]",
           distance(rigidState(stage).velocities[0], v), 1e-12);
}

TEST_CASE("damping slows a body as in the discrete closed form, whatever the step")
{
    for (const double dt : {0.001, 0.1, 10.0}) {
        const double c = 0.7, d = 1.3;
        const int steps = 20;
        Stage stage;
        RigidBodyDef def = tumbling({1e-4, 1e-4, 1e-4}, {0, 0, 5});
        def.gravity = true;
        def.velocity = {3, 0, 0};
        def.linearDamping = c;
        def.angularDamping = d;
        stage.add(def);
        stage.post(SetGravity{{0, -9.81, 0}});
        stage.run(steps, dt);
        const double linear = std::pow(1.0 + dt * c, -steps), angular = std::pow(1.0 + dt * d, -steps);
        const Vec3 end = Vec3{0, -9.81 / c, 0}; // terminal velocity: fall and damping are in balance
        const Vec3 v = end + linear * (Vec3{3, 0, 0} - end);
        verify(text("damped body after 20 steps of ", dt, " s, velocity off the discrete closed form [m/s]"),
               distance(rigidState(stage).velocities[0], v), 1e-12);
        verify(text("damped body after 20 steps of ", dt, " s, spin off the discrete closed form [rad/s]"),
               distance(rigidState(stage).angularVelocities[0], {0, 0, 5 * angular}), 1e-12);
    }
}

TEST_CASE("a spin about a principal axis is exact at any step")
{
    for (const double dt : {0.001, 0.02, 0.5}) {
        Stage stage;
        stage.add(tumbling(kMoments, {0, 0, 7}));
        stage.run(1000, dt);
        verify(text("1000 steps of ", dt, " s of spin at 7 rad/s, angle off [rad]"),
               angleBetween(rigidState(stage).poses[0].orientation, axisAngle({0, 0, 1}, 7000 * dt)), 1e-10);
        CHECK(distance(rigidState(stage).angularVelocities[0], {0, 0, 7}) < 1e-10);
    }
}

// A symmetric top without torque precesses about its angular momentum at |L| / A, with its axis at a constant angle
// (Goldstein 5.6).
TEST_CASE("a symmetric top precesses as in theory, with second order in the step")
{
    const double a = 1e-4, c = 1.8e-4;
    const Vec3 w{2, 0, 9}, momentum{a * w.x, a * w.y, c * w.z};
    const Vec3 axis = rotate(axisAngle(momentum, length(momentum) / a), {0, 0, 1}); // after one second
    double before = 1.0;
    for (const int steps : {50, 100, 200, 400}) {
        Stage stage;
        stage.add(tumbling({a, a, c}, w));
        stage.run(steps, 1.0 / steps);
        const double off = distance(rotate(rigidState(stage).poses[0].orientation, {0, 0, 1}), axis);
        if (before < 1.0) CHECK(before / off == Approx(4.0).epsilon(0.03));
        before = off;
    }
    verify("symmetric top precessing for 1 s at 2.5 ms, its axis off [-]", before, 2e-4);
}

TEST_CASE("a tumbling body's orientation converges with the square of the step")
{
    const Quat fine = afterASecond(6400);
    const double coarse = angleBetween(afterASecond(200), fine), half = angleBetween(afterASecond(400), fine);
    verifyWithin("tumbling body, error at 5 ms over error at 2.5 ms [-]", coarse / half, 3.8, 4.3);
}

// The middle axis reverses again and again (Dzhanibekov). A free body keeps momentum and energy.
TEST_CASE("a body that tumbles about its middle axis for 10 s keeps momentum and energy")
{
    const Drift drift = tumble(kMoments, kNearMiddle, 0.001, 10000);
    CHECK(drift.turnovers >= 4);
    verify("tumbling body, 10 s at 1 ms, drift of angular momentum [-]", drift.momentum, 1e-10);
    verify("tumbling body, 10 s at 1 ms, drift of energy [-]", drift.energy, 1e-5);
}

TEST_CASE("a tumbling body's energy error does not grow: 100 s lose no more than 10 s")
{
    const Drift first = tumble(kMoments, kNearMiddle, 0.001, 10000);
    const Drift all = tumble(kMoments, kNearMiddle, 0.001, 100000);
    verify("tumbling body, largest drift of energy in 100 s over that in 10 s [-]", all.energy / first.energy, 1.1);
}

TEST_CASE("at 100 rad/s and 20 ms a tumbling body keeps its momentum, and roughly its energy")
{
    std::mt19937 random(5);
    double momentum = 0.0, energy = 0.0;
    for (int i = 0; i < 20; ++i) {
        const Drift drift = tumble(kMoments, 100.0 * normalized(randomVec3(random, 1.0)), 0.02, 500);
        momentum = std::max(momentum, drift.momentum);
        energy = std::max(energy, drift.energy);
    }
    verify("tumbling at 100 rad/s by steps of 20 ms, drift of angular momentum [-]", momentum, 1e-11);
    verify("tumbling at 100 rad/s by steps of 20 ms, drift of energy [-]", energy, 0.5);
}

TEST_CASE("no step is too long for a fast tumbling body: the size of its momentum is kept, which bounds its energy")
{
    std::mt19937 random(5);
    for (const auto& [speed, dt] : {std::pair{100.0, 0.1}, {1000.0, 0.02}, {3000.0, 1.0}})
        for (int i = 0; i < 5; ++i) {
            Stage stage;
            stage.add(tumbling(kMoments, speed * normalized(randomVec3(random, 1.0))));
            stage.step(0.0);
            const double momentum = length(angularMomentum(stage));
            for (int k = 0; k < 500; ++k) {
                REQUIRE_FALSE(stage.step(dt).has(StepFlag::Undone));
                CHECK(std::abs(length(angularMomentum(stage)) / momentum - 1.0) < 1e-11);
                const double energy = turningEnergy(stage) / (0.5 * momentum * momentum);
                CHECK(energy < (1.0 + 1e-11) / kMoments.x);
                CHECK(energy > (1.0 - 1e-11) / kMoments.z);
            }
        }
}

TEST_CASE("every number of threads yields the same hash of rigid bodies")
{
    const auto hashWith = [](int threads) {
        Stage stage({.threads = threads});
        stage.add(freeBody(boxMesh({3, 3, 3}, {0.1, 0.1, 0.1})));
        for (int i = 0; i < 50; ++i) {
            RigidBodyDef def = tumbling(kMoments, {0.1 * i, 3, 1});
            def.gravity = true;
            stage.add(def);
        }
        stage.post(SetGravity{{0, -9.81, 0}});
        stage.run(50, 0.001);
        return stage.world.hash();
    };
    const std::uint64_t one = hashWith(1);
    for (const int threads : {2, 3, 8}) CHECK(hashWith(threads) == one);
}

} // namespace rigid_verification_test
