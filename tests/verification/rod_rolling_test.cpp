#include "verification/rods.h"

#include "filasofia/geometry/shapes.h"

namespace rod_rolling_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

struct Rolled {
    double acceleration = 0.0; ///< [m/s^2] down the plane
    double slip = 0.0;         ///< [-] velocity of its surface against the plane, over that of its axis
};

/// A straight rod across a plane that is inclined by `angle`.
Rolled rollDown(double angle, double friction)
{
    constexpr double radius = 1e-3, dt = 1e-3;
    constexpr int steps = 100;
    Stage stage;
    stage.world.scene().gravity = 9.81 * Vec3{std::sin(angle), -std::cos(angle), 0};
    RigidBodyDef plane{.name = "plane", .elements = {Pose{{0, -5e-3, 0}, {}}}};
    plane.mesh = geometry::shapes::box({0.4, 0.01, 0.4});
    plane.collision = {{.proximity = 0.5e-3}};
    plane.friction = friction;
    stage.add(plane);
    RodBodyDef def{.points = {{-0.1, radius, -0.02}, {-0.1, radius, 0.02}}, .spacing = 5e-3, .radius = radius};
    def.youngModulus = 1e9;
    def.rayleigh = {0.0, 0.0};
    def.collision = RodCollision{.self = false};
    def.friction = friction;
    stage.add(def);
    stage.run(20, dt); // it settles within the skin
    const auto speed = [&] {
        double sum = 0.0;
        for (Vec3 v : stage.soft().v) sum += v.x / static_cast<double>(stage.soft().v.size());
        return sum;
    };
    const double before = speed();
    stage.run(steps, dt);
    double spin = 0.0;
    for (double each : stage.soft().rod.spins) spin += each / static_cast<double>(stage.soft().rod.spins.size());
    // Its edges point along z: rolling towards x turns it about -z.
    return {(speed() - before) / (steps * dt), 1.0 + radius * spin / speed()};
}

} // namespace

TEST_CASE("a rod rolls down an inclined plane as a cylinder does, or slides if friction is too low for that")
{
    constexpr double g = 9.81, angle = 0.3;
    const Rolled rolls = rollDown(angle, 0.3);
    verify("rod: on a plane inclined by 0.3 rad, mu = 0.3: relative error of the acceleration of rolling, 2/3 g sin",
           std::abs(rolls.acceleration / (2.0 / 3.0 * g * std::sin(angle)) - 1.0), 1e-2);
    verify("rod: the same: velocity of its surface against the plane over that of its axis", std::abs(rolls.slip),
           1e-2);
    // Below mu = tan(angle) / 3 it slides, and friction turns it with 2 mu g cos / r.
    const Rolled slides = rollDown(angle, 0.05);
    verify("rod: the same, mu = 0.05: relative error of the acceleration of sliding, g (sin - mu cos)",
           std::abs(slides.acceleration / (g * (std::sin(angle) - 0.05 * std::cos(angle))) - 1.0), 1e-2);
    const double exact = 1.0 - 2.0 * 0.05 * std::cos(angle) / (std::sin(angle) - 0.05 * std::cos(angle));
    verify("rod: the same: difference of its slip from 1 - 2 mu cos / (sin - mu cos)", std::abs(slides.slip - exact),
           1e-2);
}

} // namespace rod_rolling_test
