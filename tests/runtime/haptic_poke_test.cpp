#include "filasofia/device/servo_loop.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/physics/physics_server.h"

#include <numbers>

namespace haptic_poke_test {

using namespace filasofia;
using namespace filasofia::device;

/// Compares the force on the hand with that on the tissue: the servo at its rate, the step at its own, on one fake
/// clock.
namespace {

constexpr double kTop = 0.097; ///< [m], height of its back

struct Poke {
    physics::PhysicsServer server;
    BodyId probe;

    Poke(bool dynamic, Vec3 at, double period)
        : server(engine::makeNativeEngine({.period = period, .threads = 1}), {.gravity = {}})
    {
        server.add(physics::SoftBodyDef{.name = "bunny",
                                        .mesh = FILASOFIA_SOURCE_DIR "/assets/meshes/bunny_756.msh",
                                        .material = physics::FemMaterial{.youngModulus = 5e3, .poissonRatio = 0.4},
                                        .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 0.05, 1}}}},
                                        .collision = {{}}});
        probe = server.add(physics::RigidBodyDef{.name = "probe",
                                                 .elements = {{at, {}}},
                                                 .mesh = geometry::shapes::sphere(8e-3),
                                                 .dynamic = dynamic,
                                                 .mass = physics::TotalMass{0.05},
                                                 .gravity = false,
                                                 .collision = {{}}});
    }
    Vec3 pressed() const
    {
        return frame::forceOn(probe, const_cast<physics::PhysicsServer&>(server).latest()->contacts);
    }
    MotionState probeNow() const
    {
        const auto frame = const_cast<physics::PhysicsServer&>(server).latest();
        const frame::RigidBodyFrame* body = frame->rigidBody(probe);
        return {body->poses[0], body->velocities[0], body->angularVelocities[0]};
    }
};

struct Felt {
    Vec3 onHand, onBody, pressed;
    Pose probe;
};

/// Moves the hand from above the bunny down by `depth` within one second and holds it there for another. Returns means
/// over the last quarter.
Felt pokeByHand(Vec3 above, double depth, double physicsRate, double servoRate)
{
    Poke poke(true, above, 1.0 / physicsRate);
    ServoDef def{
        .rate = servoRate,
        .coupling = {.linearStiffness = 300, .linearDamping = 4, .angularStiffness = 1, .angularDamping = 0.01},
        .forceLimit = 20,
        .stepPeriod = 1.0 / physicsRate};
    ServoLoop loop(def);
    loop.setCapabilities({.force = true});
    const auto handAt = [&](double t) {
        const double s = std::min(t, 1.0), w = std::numbers::pi;
        return MotionState{{above - Vec3{0, 0.5 * depth * (1.0 - std::cos(w * s)), 0}, {}},
                           {0, t < 1.0 ? -0.5 * depth * w * std::sin(w * s) : 0.0, 0},
                           {}};
    };
    BodySample body;
    Felt felt;
    int ticks = 0, steps = 0;
    double nextStep = 0.0;
    const int all = static_cast<int>(2.0 * servoRate);
    for (int i = 0; i < all; ++i) {
        const double t = i / servoRate;
        const auto now = static_cast<Nanoseconds>(std::llround(t * 1e9));
        while (nextStep <= t + 1e-12) {
            const MotionState hand = handAt(nextStep);
            poke.server.setHaptic(poke.probe, {hand.pose, hand.velocity, hand.angularVelocity, sceneCoupling(def)});
            poke.server.step(1.0 / physicsRate);
            ++body.number;
            body.time = static_cast<Nanoseconds>(std::llround(nextStep * 1e9));
            body.body = poke.probeNow();
            nextStep += 1.0 / physicsRate;
            if (t < 1.75) continue;
            felt.onBody += couplingForce(sceneCoupling(def), hand, body.body).force;
            felt.pressed += poke.pressed();
            ++steps;
        }
        const ServoTick tick = loop.tick(now, {.hand = handAt(t)}, &body);
        if (t < 1.75) continue;
        felt.onHand += tick.onHand.force;
        ++ticks;
    }
    felt.onHand *= 1.0 / ticks;
    felt.onBody *= 1.0 / steps;
    felt.pressed *= 1.0 / steps;
    felt.probe = body.body.pose;
    return felt;
}

} // namespace

TEST_CASE("a hand that pokes the soft bunny feels the engine's quasi-static force, whatever the rates")
{
    const Vec3 above{0.015, kTop + 0.010, 0.015};
    for (const double physicsRate : {1000.0, 100.0}) {
        const Felt first = pokeByHand(above, 0.02, physicsRate, 1000.0);
        // The same probe, moved kinematically to where it came to rest and held there: the reaction of the tissue
        // alone.
        Poke still(false, above, 1e-3);
        const int steps = 1000;
        for (int i = 1; i <= steps; ++i) {
            const double s = static_cast<double>(i) / steps;
            still.server.setPose(still.probe, {(1 - s) * above + s * first.probe.position, first.probe.orientation});
            still.server.step(1e-3);
        }
        for (int i = 0; i < 1000; ++i) still.server.step(1e-3);
        const Vec3 quasiStatic = still.pressed();
        INFO("quasi-static " << length(quasiStatic) << " N, physics at " << physicsRate << " Hz");
        CHECK(length(quasiStatic) > 0.1);
        for (const double servoRate : {250.0, 1000.0, 5000.0}) {
            const Felt felt = pokeByHand(above, 0.02, physicsRate, servoRate);
            INFO("servo at " << servoRate << " Hz: hand " << length(felt.onHand) << " N, body " << length(felt.onBody)
                             << " N, tissue " << length(felt.pressed) << " N");
            CHECK(distance(felt.onHand, quasiStatic) < 0.05 * length(quasiStatic));
            CHECK(length(felt.onHand + felt.onBody) < 0.05 * length(felt.onBody));
            CHECK(length(felt.pressed + felt.onBody) < 0.05 * length(felt.onBody));
        }
    }
}

} // namespace haptic_poke_test
