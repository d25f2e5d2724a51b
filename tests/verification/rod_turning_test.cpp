#include "verification/rods.h"

namespace rod_turning_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

/// A rod as clampedRod() has it, but what clamps its first edge is a body, and its last edge is pinned.
RodBodyDef turnedRod(double length, int edges, BodyId hand)
{
    RodBodyDef def = clampedRod(length, edges);
    def.points.back().x += length / edges;
    def.attachments = {{.nodes = {0, 1}, .to = hand}, {.nodes = {edges + 1, edges + 2}}};
    return def;
}

/// Turns a kinematic body about x, by so much in each of so many steps.
void turn(Stage& stage, BodyId hand, double step, int steps, double dt)
{
    for (int i = 1; i <= steps; ++i) {
        stage.post(SetPose{hand, 0, Pose{{}, axisAngle({1, 0, 0}, step * i)}});
        stage.step(dt);
    }
}

frame::Attachment heldBy(Stage& stage, BodyId hand)
{
    frame::Frame frame;
    stage.world.capture(frame);
    for (const frame::Attachment& each : frame.attachments)
        if (each.to == hand) return each;
    return {};
}

} // namespace

TEST_CASE("a body that turns about a rod's axis twists the rod: its moment is that of torsion at both ends")
{
    constexpr double length = 0.2, step = 0.06;
    constexpr int edges = 100, steps = 100;
    Stage stage;
    const BodyId hand = stage.add(RigidBodyDef{.name = "hand", .elements = {Pose{}}});
    const RodBodyDef def = turnedRod(length, edges, hand);
    stage.add(def);
    turn(stage, hand, step, steps, 0.01);
    settle(stage, 0.01, 400);
    const double exact = twistOf(def) * step * steps / length;
    const SoftModel& model = stage.model();
    const double far = -stiffJoints(model.rod, model.pins.hard).back().twist * stage.soft().rod.twists.back();
    verify("rod: turned by a body through 6 rad: relative error of the moment at the far clamp",
           std::abs(far / exact - 1.0), 1e-3);
    const Vec3 torque = heldBy(stage, hand).torque; // the rod pulls back, so the body pushes on
    verify("rod: turned by a body through 6 rad: relative error of the moment that the body needs",
           distance(torque, {exact, 0, 0}) / exact, 1e-3);
}

TEST_CASE("a quarter of a ring that a body clamps bends and twists as one that is pinned")
{
    constexpr double radius = 0.1;
    constexpr int edges = 100;
    Stage stage;
    const BodyId hand = stage.add(RigidBodyDef{.name = "hand", .elements = {Pose{}}});
    RodBodyDef def = clampedArc(radius, 0.5 * kPi, edges);
    const double load = 1e-3 * bendOf(def) / (radius * radius);
    def.forces = {{.node = edges + 1, .force = {0, 0, load}}};
    def.attachments = {{.nodes = {0, 1}, .to = hand}};
    stage.add(def);
    settle(stage, 0.02, 4000);
    const double r3 = radius * radius * radius; // Castigliano, as in rod_test.cpp
    const double exact = load * r3 * (0.25 * kPi / bendOf(def) + (0.75 * kPi - 2.0) / twistOf(def));
    verify("rod: quarter of a ring, clamped by a body, load across it: relative error of the deflection",
           std::abs(stage.soft().x.back().z / exact - 1.0), 1e-3);
}

TEST_CASE("a free body and a rod that is clamped on it exchange angular momentum, and none is lost")
{
    constexpr double dt = 1e-4;
    Stage stage;
    const BodyId block = stage.add(RigidBodyDef{.name = "block",
                                                .elements = {Pose{}},
                                                .dynamic = true,
                                                .mass = GivenInertia{.mass = 2e-4, .moments = {2e-10, 3e-10, 3.5e-10}},
                                                .gravity = false});
    RodBodyDef def = clampedRod(0.05, 25);
    def.attachments = {{.nodes = {0, 1}, .to = block}};
    stage.add(def);
    stage.step(0.0);
    stage.world.scene().rigid[0].state.angularVelocities[0] = {40.0, 2.0, 0.0};
    const auto momentum = [&] {
        const Scene& scene = stage.world.scene();
        const RigidState& rigid = scene.rigid[0].state;
        const RigidInertia& inertia = scene.rigid[0].model.inertias[0];
        const Quat q = rigid.poses[0].orientation;
        Vec3 sum = rotate(q, inertia.inertia * rotate(conjugate(q), rigid.angularVelocities[0])) +
                   inertia.mass * cross(transform(rigid.poses[0], inertia.centre), rigid.velocities[0]);
        const SoftModel& rod = stage.model();
        const SoftState& state = stage.soft();
        for (std::size_t i = 0; i < rod.masses.size(); ++i) sum += rod.masses[i] * cross(state.x[i], state.v[i]);
        for (std::size_t e = 0; e < rod.rod.inertias.size(); ++e)
            sum += rod.rod.inertias[e] * state.rod.spins[e] * normalized(state.x[e + 1] - state.x[e]);
        return sum;
    };
    const Vec3 before = momentum();
    const double spin = stage.world.scene().rigid[0].state.angularVelocities[0].x;
    stage.run(1000, dt);
    verify("rod: clamped on a free body that spins about it: relative change of the angular momentum in 0.1 s",
           distance(momentum(), before) / length(before), 5e-3);
    CHECK(stage.world.scene().rigid[0].state.angularVelocities[0].x < 0.99 * spin); // the rod turns with it
}

namespace {

/// A curved rod in a curved tube of no play, as wide as a plane arc: T phi'' = B k k0 sin(phi), with phi the angle of
/// its own bend against the tube's. Turned by `angle` at its base and free at its end. Returns phi at the end and the
/// moment at the base, in T / L, on the branch that starts at phi = 0 (shooting, Runge-Kutta's method).
std::pair<double, double> whip(double stiffness, double angle)
{
    constexpr int steps = 2000;
    const auto base = [&](double tip) { // integrates from the tip, where phi' = 0
        double phi = tip, slope = 0.0;
        constexpr double h = 1.0 / steps;
        for (int i = 0; i < steps; ++i) {
            const auto f = [&](double p) { return stiffness * std::sin(p); };
            const double k1 = slope, l1 = f(phi), k2 = slope + h / 2 * l1, l2 = f(phi + h / 2 * k1);
            const double k3 = slope + h / 2 * l2, l3 = f(phi + h / 2 * k2), k4 = slope + h * l3, l4 = f(phi + h * k3);
            phi += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
            slope += h / 6 * (l1 + 2 * l2 + 2 * l3 + l4);
        }
        return std::pair{phi, slope};
    };
    double low = 0.0, high = kPi;
    for (int i = 0; i < 80; ++i) {
        const double middle = 0.5 * (low + high);
        (base(middle).first > angle ? high : low) = middle;
    }
    return {low, base(low).second};
}

} // namespace

TEST_CASE("a curved rod that is turned in a curved tube needs the moment of the pendulum's equation")
{
    // The tube: nodes are held on an arc by springs, so that the edges may turn about themselves. With springs a
    // hundred thousand times softer the end of the rod bends its own way over 3 % of the length, and the moment is off
    // by that.
    constexpr double radius = 0.1, arc = 0.6;
    constexpr int edges = 240; // the free end is half an edge too short: an error of the first order
    Stage stage;
    const BodyId hand = stage.add(RigidBodyDef{.name = "hand", .elements = {Pose{}}});
    RodBodyDef def = clampedArc(radius, arc, edges);
    const double length = radius * arc, edge = 2.0 * radius * std::sin(0.5 * arc / edges);
    std::vector<int> tube;
    for (int i = 2; i <= edges + 1; ++i) tube.push_back(i);
    def.attachments = {{.nodes = {0, 1}, .to = hand}, {.nodes = tube, .stiffness = 1e12 * bendOf(def) / length}};
    stage.add(def);
    // B k k0 L^2 / T: the curvature at rest is that of the tube.
    const double stiffness = bendOf(def) / twistOf(def) * arc * arc;
    const Vec3 along = normalized(def.points[1] - def.points[0]);
    double worst = 0.0, turned = 0.0;
    for (const double angle : {0.5, 1.5, 2.5}) {
        for (; turned < angle - 1e-9; turned += 0.05) {
            stage.post(SetPose{hand, 0, Pose{{}, axisAngle(along, turned + 0.05)}});
            stage.step(0.01);
        }
        settle(stage, 0.02, 300);
        const double exact = whip(stiffness, angle).second * twistOf(def) / (edge * edges);
        worst = std::max(worst, std::abs(dot(heldBy(stage, hand).torque, along) / exact - 1.0));
    }
    verify("rod: curved, turned in a curved tube by 0.5, 1.5, 2.5 rad: relative error of the moment at the hand", worst,
           1e-2);
}

} // namespace rod_turning_test
