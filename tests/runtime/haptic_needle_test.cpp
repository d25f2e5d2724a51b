#include "filasofia/device/servo_loop.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/physics/physics_server.h"

#include <numbers>

namespace haptic_needle_test {

using namespace filasofia;
using namespace filasofia::device;

/// A needle that a hand on a device pushes into tissue and draws out again: the servo and the step on one fake clock.
namespace {

constexpr double kThick = 0.025, kLength = 0.03, kRadius = 0.4e-3; ///< [m]
constexpr double kToTip = 0.5 * kLength + kRadius;
constexpr int kStrokes = 3; ///< each takes a second
const physics::PunctureDef kSkin{.force = 0.6, .cutting = 0.2, .friction = 20.0};

struct Scene {
    physics::PhysicsServer server;
    BodyId needle;

    explicit Scene(double period, Pose at)
        : server(engine::makeNativeEngine({.period = period, .threads = 1}), {.gravity = {}})
    {
        physics::SoftBodyDef tissue{.name = "tissue", .mesh = geometry::shapes::block({0.03, kThick, 0.03}, {8, 8, 8})};
        tissue.pose.position.y = -0.5 * kThick;
        tissue.material = physics::FemMaterial{.youngModulus = 3e4, .poissonRatio = 0.45};
        tissue.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, -0.999 * kThick, 1}}}};
        tissue.collision = {{.proximity = 0.3e-3}};
        tissue.friction = 0.0;
        tissue.puncture = kSkin;
        server.add(tissue);
        physics::RigidBodyDef def{.name = "needle",
                                  .elements = {at},
                                  .mesh = geometry::shapes::capsule(kRadius, kLength),
                                  .dynamic = true,
                                  .mass = physics::TotalMass{0.02}};
        def.gravity = false;
        def.collision = {{.proximity = 0.3e-3}};
        def.needle = physics::NeedleDef{.line = {{0, -kToTip, 0}, {0, kToTip, 0}}, .radius = kRadius};
        needle = server.add(def);
    }
};

struct Felt {
    double most = -1.0; ///< [J] that the hand had got, net, at any time
    double given = 0.0; ///< [J] that it gave in all
    double told = 0.0;  ///< [J] the servo's own account
    double dissipated =
        0.0;            ///< [J] by cutting and friction, as the law of the tissue says for the depths that were met
    double force = 0.0; ///< [N] largest
    int strokes = 0;    ///< that pierced
};

/// Moves the hand with the needle's tip from 3 mm above the skin to 15 mm below it and back.
Felt strokes(double physicsRate)
{
    constexpr double kServoRate = 1000.0;
    const auto handAt = [](double t) {
        const double w = 2.0 * std::numbers::pi, high = 0.003, low = -0.015;
        const double y = low + 0.5 * (high - low) * (1.0 + std::cos(w * t));
        return MotionState{{{0.4e-3, y + kToTip, 0.3e-3}, {}}, {0, -0.5 * w * (high - low) * std::sin(w * t), 0}, {}};
    };
    Scene scene(1.0 / physicsRate, handAt(0.0).pose);
    const ServoDef def{
        .rate = kServoRate,
        .coupling = {.linearStiffness = 500, .linearDamping = 2, .angularStiffness = 1, .angularDamping = 0.01},
        .forceLimit = 20,
        .stepPeriod = 1.0 / physicsRate};
    ServoLoop loop(def);
    loop.setCapabilities({.force = true});
    BodySample body;
    Felt felt;
    double got = 0.0, nextStep = 0.0, depth = 0.0;
    Vec3 force;
    Pose last = handAt(0.0).pose;
    for (int i = 0; i <= kStrokes * static_cast<int>(kServoRate); ++i) {
        const double t = i / kServoRate;
        const MotionState hand = handAt(t);
        while (nextStep <= t + 1e-12) {
            const MotionState now = handAt(nextStep);
            scene.server.setHaptic(scene.needle, {now.pose, now.velocity, now.angularVelocity, sceneCoupling(def)});
            const physics::StepReport report = scene.server.step(1.0 / physicsRate);
            CHECK(report.flags == 0);
            const auto frame = scene.server.latest();
            const frame::RigidBodyFrame& at = *frame->rigidBody(scene.needle);
            body = {++body.number,
                    static_cast<Nanoseconds>(std::llround(nextStep * 1e9)),
                    {at.poses[0], at.velocities[0], at.angularVelocities[0]}};
            nextStep += 1.0 / physicsRate;
            if (!frame->channels.empty()) {
                depth = std::max(depth, frame->channels[0].length);
            } else if (depth > 0.0) { // in: cutting and friction; out: friction
                felt.dissipated += kSkin.cutting * depth + kSkin.friction * depth * depth;
                felt.strokes += 1;
                depth = 0.0;
            }
        }
        got += dot(force, hand.pose.position - last.position);
        last = hand.pose;
        felt.most = std::max(felt.most, got);
        const ServoTick tick = loop.tick(static_cast<Nanoseconds>(std::llround(t * 1e9)), {.hand = hand}, &body);
        force = tick.onHand.force;
        felt.force = std::max(felt.force, length(force));
        felt.told = tick.energy;
    }
    felt.given = -got;
    return felt;
}

} // namespace

TEST_CASE("a hand that pushes a needle into tissue gives what cutting and friction take, and never gets any back")
{
    for (const double physicsRate : {1000.0, 200.0}) {
        const Felt felt = strokes(physicsRate);
        INFO("physics at " << physicsRate << " Hz: gave " << felt.given << " J, the tissue took " << felt.dissipated
                           << " J, most got " << felt.most << " J, at most " << felt.force << " N");
        CHECK(felt.strokes == kStrokes);
        CHECK(felt.force > 0.5 * kSkin.force);
        CHECK(felt.most < 1e-9);
        CHECK(std::abs(felt.told + felt.given) < 0.02 * felt.given);
        CHECK(felt.given > felt.dissipated);
        CHECK(felt.given < 1.2 * felt.dissipated); // the skin is pressed in before each puncture, and springs back
    }
}

} // namespace haptic_needle_test
