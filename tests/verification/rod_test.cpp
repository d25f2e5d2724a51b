#include "verification/rods.h"

#include "filasofia/geometry/shapes.h"

#include <optional>

namespace rod_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

/// The shape of a heavy cantilever that is horizontal where it is clamped (the elastica): B theta'' = -w (L - s) cos
/// theta, theta = 0 at s = 0, theta' = 0 at s = L, by shooting and Runge-Kutta's method. Returns the end of the rod.
Vec3 elastica(double weightPerLength, double bend, double length)
{
    constexpr int steps = 4000;
    const double h = length / steps;
    struct State {
        double theta, slope, x, y;
    };
    const auto rate = [&](double s, State u) {
        return State{u.slope, weightPerLength * (length - s) / bend * std::cos(u.theta), std::cos(u.theta),
                     std::sin(u.theta)};
    };
    const auto plus = [](State u, double k, State r) {
        return State{u.theta + k * r.theta, u.slope + k * r.slope, u.x + k * r.x, u.y + k * r.y};
    };
    const auto shoot = [&](double slope) {
        State u{0.0, slope, 0.0, 0.0};
        for (int i = 0; i < steps; ++i) {
            const double s = i * h;
            const State a = rate(s, u), b = rate(s + h / 2, plus(u, h / 2, a)), c = rate(s + h / 2, plus(u, h / 2, b)),
                        d = rate(s + h, plus(u, h, c));
            u = plus(plus(plus(plus(u, h / 6, a), h / 3, b), h / 3, c), h / 6, d);
        }
        return u;
    };
    double low = -100.0 / length, high = 0.0; // theta' at the clamp: theta is negative below the horizontal
    for (int i = 0; i < 80; ++i) {
        const double middle = 0.5 * (low + high);
        (shoot(middle).slope > 0.0 ? high : low) = middle;
    }
    const State end = shoot(0.5 * (low + high));
    return {end.x, end.y, 0.0};
}

} // namespace

TEST_CASE("a rod that is clamped at one end sags under its weight as the elastica does")
{
    constexpr double length = 0.2;
    for (const double slender : {1.0, 10.0, 60.0}) { // w L^3 / B
        RodBodyDef def = clampedRod(length, 100);
        def.gravity = true;
        const double weight = def.density * areaOf(def) * 9.81;
        def.youngModulus *= weight * length * length * length / slender / bendOf(def);
        Stage stage;
        stage.world.scene().gravity = {0, -9.81, 0};
        stage.add(def);
        settle(stage, 0.02, 4000);
        const Vec3 exact = elastica(weight, bendOf(def), length), found = stage.soft().x.back();
        const double error = distance(exact, found) / length;
        verify(text("rod: heavy cantilever, w L^3 / B = ", slender, ": distance of its end from the elastica's over L"),
               error, 1e-3);
    }
}

TEST_CASE("a rod bends under a small load at its end as a beam does")
{
    constexpr double length = 0.2;
    RodBodyDef def = clampedRod(length, 100);
    const double load = 1e-3 * 3.0 * bendOf(def) / (length * length);
    def.forces = {{.node = 101, .force = {0, -load, 0}}};
    Stage stage;
    stage.add(def);
    settle(stage, 0.02, 2000);
    const double exact = load * length * length * length / (3.0 * bendOf(def)), found = -stage.soft().x.back().y;
    verify("rod: load at its end: relative error of the deflection", std::abs(found / exact - 1.0), 1e-3);
}

TEST_CASE("a quarter of a ring, curved at rest, bends and twists under a load across it as a curved beam does")
{
    constexpr double radius = 0.1;
    constexpr int edges = 200;
    // Nodes on the circle: their polygon has the curvature of the circle at its nodes.
    RodBodyDef def = clampedArc(radius, 0.5 * kPi, edges);
    const double load = 1e-3 * bendOf(def) / (radius * radius);
    def.forces = {{.node = edges + 1, .force = {0, 0, load}}};
    Stage stage;
    stage.add(def);
    settle(stage, 0.02, 4000);
    // Castigliano: M = F R sin(phi), moment about the rod F R (1 - cos(phi)).
    const double r3 = radius * radius * radius;
    const double exact = load * r3 * (0.25 * kPi / bendOf(def) + (0.75 * kPi - 2.0) / twistOf(def));
    const double found = stage.soft().x.back().z;
    verify("rod: quarter of a ring, curved at rest, load across it: relative error of the deflection",
           std::abs(found / exact - 1.0), 1e-3);
}

TEST_CASE("a helix that is curved at rest is as stiff along its axis as a helical spring")
{
    // Between clamps that are moved along the axis: 1 / k = L R^2 (cos^2 a / T + sin^2 a / B), for a pitch angle a that
    // is small.
    constexpr int turns = 4, edges = 480;
    constexpr double radius = 0.01, pitch = 2e-4, way = 2e-5;
    RodBodyDef def = clampedRod(radius, 10);
    def.straight = false;
    def.spacing = {};
    def.radius = 0.4e-3;
    def.points.clear();
    for (int i = -1; i <= edges + 1; ++i) {
        const double angle = 2.0 * kPi * turns * i / edges;
        def.points.push_back({radius * std::cos(angle), radius * std::sin(angle), pitch * angle / (2.0 * kPi)});
    }
    Stage stage;
    stage.world.scene().gravity = {};
    const BodyId hand = stage.add(RigidBodyDef{.elements = {Pose{def.points.back()}}});
    def.attachments.push_back({.nodes = {edges + 1, edges + 2}, .to = hand});
    stage.add(def);
    stage.step(0.0);
    stage.post(SetPose{hand, 0, Pose{def.points.back() + Vec3{0, 0, way}}});
    settle(stage, 1.0, 60);
    frame::Frame frame;
    stage.world.capture(frame);
    REQUIRE(frame.attachments.size() == 2);
    const double a = std::atan(pitch / (2.0 * kPi * radius)), length = 2.0 * kPi * radius * turns / std::cos(a);
    const double compliance =
        length * radius * radius * (std::pow(std::cos(a), 2) / twistOf(def) + std::pow(std::sin(a), 2) / bendOf(def));
    verify("rod: helix, curved at rest, drawn along its axis: relative error of its stiffness",
           std::abs(frame.attachments[1].force.z * compliance / way - 1.0), 5e-3);
}

TEST_CASE("twist spreads evenly between two clamps, and its moment is that of torsion")
{
    constexpr double length = 0.2;
    RodBodyDef def = clampedRod(length, 100);
    def.points.back().x += length / 100;
    def.attachments = {{.nodes = {0, 1, 101, 102}}};
    def.twist = 1.3;
    Stage stage;
    stage.add(def);
    stage.step(0.0);
    // All of it at one place, to begin with.
    RodState& rod = stage.soft().rod;
    for (std::size_t e = 1; e + 1 < rod.directors.size(); ++e) rod.directors[e] = rod.directors.front();
    std::ranges::fill(rod.twists, 0.0);
    rod.twists.back() = 1.3;
    settle(stage, 0.01, 200);
    const SoftModel& model = stage.model();
    const std::vector<RodJoint> joints = stiffJoints(model.rod, model.pins.hard);
    double worst = 0.0;
    const double exact = twistOf(def) * 1.3 / length;
    for (std::size_t j = 0; j < joints.size(); ++j)
        worst = std::max(worst, std::abs(joints[j].twist * rod.twists[j] / exact - 1.0));
    verify("rod: twist between two clamps: relative error of its moment anywhere", worst, 1e-3);
}

TEST_CASE("a clamped straight rod buckles under twist at Greenhill's moment")
{
    constexpr double length = 0.2;
    const auto growth = [&](double moment) { // relative to Greenhill's
        RodBodyDef def = clampedRod(length, 100);
        def.points.back().x += length / 100;
        def.attachments = {{.nodes = {0, 1, 101, 102}}};
        // Both ends clamped: M L / (2 B) is the first root of tan(z) = z.
        const double critical = 2.0 * 4.493409457909064 * bendOf(def) / length;
        def.twist = moment * critical * length / twistOf(def);
        Stage stage;
        stage.add(def);
        stage.step(0.0);
        for (std::size_t i = 2; i <= 100; ++i) {
            const double s = (static_cast<double>(i) - 1.0) / 100.0;
            stage.soft().x[i] += 1e-9 * std::sin(kPi * s) * Vec3{0, std::cos(kPi * s), std::sin(kPi * s)};
        }
        const auto size = [&] {
            double sum = 0.0;
            for (Vec3 x : stage.soft().x) sum += x.y * x.y + x.z * x.z;
            return std::sqrt(sum);
        };
        const double omega = 22.37 / (length * length) * std::sqrt(bendOf(def) / (def.density * areaOf(def)));
        stage.run(300, 0.3 / omega); // what else there is in it dies
        const double before = size();
        stage.run(300, 0.3 / omega);
        return std::log(size() / before);
    };
    const double below = growth(0.98), above = growth(1.02);
    verify("rod: Greenhill, 0.98 of the moment: logarithm of a disturbance's growth", below, 0.0);
    verifyWithin("rod: Greenhill, 1.02 of the moment: logarithm of a disturbance's growth", above, 0.0, 100.0);
}

TEST_CASE("the energy of a free rod does not grow, and its momentum stays")
{
    for (const double dt : {1e-4, 1e-3}) {
        RodBodyDef def = clampedRod(0.2, 60);
        def.attachments.clear();
        def.straight = false;
        def.points = {{0, 0, 0}, {0.07, 0.02, 0}, {0.12, -0.02, 0.04}, {0.2, 0, 0.02}};
        def.spacing = 0.2 / 60;
        def.twist = 2.0;
        Stage stage;
        stage.add(def);
        stage.step(0.0);
        std::mt19937 random(3);
        for (Vec3& v : stage.soft().v) v = randomVec3(random, 0.3);
        const SoftModel& model = stage.model();
        const std::vector<RodJoint> joints = stiffJoints(model.rod, model.pins.hard);
        const auto energy = [&] {
            const SoftState& state = stage.soft();
            double sum = 0.0;
            for (std::size_t i = 0; i < state.x.size(); ++i) sum += 0.5 * model.masses[i] * lengthSquared(state.v[i]);
            for (std::size_t e = 0; e < model.rod.edges.size(); ++e)
                sum += springEnergy(model.rod.edges[e], state.x[e], state.x[e + 1]) +
                       0.5 * model.rod.inertias[e] * state.rod.spins[e] * state.rod.spins[e];
            for (std::size_t j = 0; j < joints.size(); ++j) sum += rodEnergy(joints[j], placeAt(state.rod, state.x, j));
            return sum;
        };
        const auto momentum = [&] {
            Vec3 sum;
            for (std::size_t i = 0; i < model.masses.size(); ++i) sum += model.masses[i] * stage.soft().v[i];
            return sum;
        };
        const double start = energy();
        const Vec3 moved = momentum();
        double most = start;
        for (int i = 0; i < 2000; ++i) {
            CHECK((stage.step(dt).flags & ~static_cast<std::uint32_t>(StepFlag::Restless)) == 0);
            most = std::max(most, energy());
        }
        verify(text("rod: free, with random velocities, steps of ", dt, " s: largest energy over that at the start"),
               most / start, 1.0 + 1e-9);
        CHECK(distance(momentum(), moved) < 1e-9 * length(moved));
    }
}

TEST_CASE("a rod that turns as a whole keeps its angular momentum, whatever damps its deformation")
{
    for (const double damping : {0.0, 0.01}) {
        RodBodyDef def = clampedRod(0.2, 60);
        def.attachments.clear();
        def.straight = false;
        def.rayleigh.stiffness = damping;
        def.spacing = {};
        def.points.clear();
        for (int i = 0; i <= 60; ++i) // a helix
            def.points.push_back({0.01 * std::cos(0.2 * i), 0.01 * std::sin(0.2 * i), 5e-4 * i});
        Stage stage;
        stage.add(def);
        stage.step(0.0);
        const SoftModel& model = stage.model();
        SoftState& state = stage.soft();
        Vec3 centre;
        double mass = 0.0;
        for (std::size_t i = 0; i < model.masses.size(); ++i) {
            centre += model.masses[i] * state.x[i];
            mass += model.masses[i];
        }
        centre = centre / mass;
        const Vec3 spin{0, 0, 5.0};
        for (std::size_t i = 0; i < state.x.size(); ++i) state.v[i] = cross(spin, state.x[i] - centre);
        for (std::size_t e = 0; e < 60; ++e) state.rod.spins[e] = dot(spin, normalized(state.x[e + 1] - state.x[e]));
        const auto momentum = [&] {
            Vec3 sum;
            for (std::size_t i = 0; i < model.masses.size(); ++i)
                sum += model.masses[i] * cross(stage.soft().x[i] - centre, stage.soft().v[i]);
            return sum;
        };
        const Vec3 before = momentum();
        stage.run(100, 1e-3);
        verify(text("rod: helix, curved at rest, that turns with 5 rad/s for 0.1 s, stiffness damping of ", damping,
                    " s: relative change of the angular momentum"),
               distance(momentum(), before) / length(before), 5e-3);
    }
}

namespace {

/// A cylinder about the z axis that does not move.
RigidBodyDef fixedCylinder(double radius, double length, double friction, int quarter)
{
    RigidBodyDef def{.name = "cylinder", .elements = {Pose{{}, axisAngle({1, 0, 0}, 0.5 * kPi)}}};
    def.mesh = geometry::shapes::cylinder(radius, length, quarter);
    def.collision = {{.proximity = 0.2e-3}};
    def.friction = friction;
    return def;
}

/// Draws a thread over a cylinder at a steady speed, against a force at its other end. Returns the ratio of the two
/// forces.
double drawnOver(double angle, double friction)
{
    constexpr double radius = 0.02, spacing = 1e-3, tail = 0.03, hold = 1.0, dt = 1e-3, speed = 0.03;
    constexpr int ramp = 100, steps = 500;
    RodBodyDef thread{.name = "thread", .radius = 0.15e-3, .youngModulus = 1e10, .gravity = false};
    thread.collision = RodCollision{.self = false};
    thread.friction = friction;
    const double around = radius + thread.radius;
    const auto add = [&](Vec3 p) { thread.points.push_back(p); };
    const int edges = static_cast<int>(std::round(angle * around / spacing)), ends = static_cast<int>(tail / spacing);
    for (int i = ends; i > 0; --i) add({around, -i * spacing, 0});
    for (int i = 0; i <= edges; ++i)
        add({around * std::cos(angle * i / edges), around * std::sin(angle * i / edges), 0});
    const Vec3 along{-std::sin(angle), std::cos(angle), 0}, end = thread.points.back();
    for (int i = 1; i <= ends; ++i) add(end + i * spacing * along);
    const int last = static_cast<int>(thread.points.size()) - 1;

    Stage stage;
    stage.world.scene().gravity = {};
    stage.add(fixedCylinder(radius, 0.02, friction, 250));
    const BodyId hand = stage.add(RigidBodyDef{.name = "hand", .elements = {Pose{thread.points.back()}}});
    thread.attachments = {{.nodes = {last}, .to = hand}};
    const BodyId drawn = stage.add(thread);
    Vec3 place = thread.points.back();
    double sum = 0.0;
    int count = 0;
    frame::Frame frame;
    for (int i = 0; i < steps; ++i) {
        if (i < ramp) stage.post(SetForces{drawn, {{.node = 0, .force = {0, -hold * (i + 1) / ramp, 0}}}});
        place += speed * dt * along;
        stage.post(SetPose{hand, 0, Pose{place}});
        const StepReport report = stage.step(dt);
        CHECK((report.flags & ~static_cast<std::uint32_t>(StepFlag::Restless)) == 0);
        stage.world.capture(frame);
        if (i < steps - 100) continue;
        sum += length(frame.attachments.at(0).force);
        ++count;
    }
    return sum / count / hold;
}

void drawOver(double turns, double friction)
{
    const double angle = 2.0 * kPi * turns, exact = std::exp(friction * angle), found = drawnOver(angle, friction);
    verify(text("rod: drawn over a cylinder, ", 360.0 * turns, " degrees, mu = ", friction,
                ": relative error of the ratio of forces"),
           std::abs(found / exact - 1.0), 0.02);
}

} // namespace

TEST_CASE("a thread that is drawn over a cylinder needs the force of Euler's and Eytelwein's capstan")
{
    drawOver(0.25, 0.3);
    drawOver(0.5, 0.3);
}

TEST_CASE("a thread that is drawn once and twice around a cylinder needs the capstan's force", "[long]")
{
    drawOver(1.0, 0.2);
    drawOver(2.0, 0.15);
}

} // namespace rod_test
