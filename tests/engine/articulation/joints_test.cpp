#include "engine/articulation/jaw.h"

#include <numbers>

namespace joints_test {

using namespace filasofia;
using namespace filasofia::engine;
using physics::JointForce;
using physics::JointPosition;
using physics::JointSpring;
using physics::SetJoint;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kGravity = 9.81;

/// A jaw that swings under gravity, integrated by the classical Runge-Kutta method: angle and rate after `time` [s].
std::array<double, 2> pendulum(double angle, double rate, double damping, double time)
{
    const int steps = 20000;
    const double h = time / steps;
    const auto gain = [&](double q, double w) {
        return -(kJawMass * kGravity * kArm * std::cos(q) + damping * w) / kHingeInertia;
    };
    for (int i = 0; i < steps; ++i) {
        const double k1 = gain(angle, rate), k2 = gain(angle + 0.5 * h * rate, rate + 0.5 * h * k1),
                     k3 = gain(angle + 0.5 * h * (rate + 0.5 * h * k1), rate + 0.5 * h * k2),
                     k4 = gain(angle + h * (rate + 0.5 * h * k2), rate + h * k3);
        angle += h * rate + h * h / 6.0 * (k1 + k2 + k3);
        rate += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    return {angle, rate};
}

double swingError(double dt, double damping)
{
    physics::RigidBodyDef def = jawBody(JointForce{});
    def.gravity = true;
    def.articulation.joints[0].start = -0.3;
    def.articulation.joints[0].damping = damping;
    Stage stage;
    stage.post(physics::SetGravity{{0, -kGravity, 0}});
    stage.add(def);
    stage.run(static_cast<int>(std::lround(0.5 / dt)), dt);
    return std::abs(joint(stage).now.position - pendulum(-0.3, 0.0, damping, 0.5)[0]);
}

} // namespace

TEST_CASE("a jaw that swings freely follows its equation of motion, more closely with shorter steps")
{
    for (const double damping : {0.0, 2e-5}) {
        const double coarse = swingError(1e-3, damping), fine = swingError(2.5e-4, damping);
        CHECK(coarse < 0.02);
        CHECK(fine < 0.3 * coarse);
        CHECK(swingError(1e-4, damping) < 2e-3);
    }
}

TEST_CASE("a swinging jaw neither gains nor loses energy over many periods")
{
    physics::RigidBodyDef def = jawBody(JointForce{});
    def.gravity = true;
    Stage stage;
    stage.post(physics::SetGravity{{0, -kGravity, 0}});
    stage.add(def);
    const auto energy = [&] {
        const frame::Joint& now = joint(stage).now;
        return 0.5 * kHingeInertia * now.velocity * now.velocity + kJawMass * kGravity * kArm * std::sin(now.position);
    };
    double lowest = 0.0, highest = 0.0;
    for (int i = 0; i < 10000; ++i) {
        stage.step(1e-3);
        lowest = std::min(lowest, energy());
        highest = std::max(highest, energy());
    }
    const double scale = kJawMass * kGravity * kArm;
    CHECK(lowest > -0.02 * scale);
    CHECK(highest < 0.02 * scale);
}

TEST_CASE("a joint moves to its commanded position at its speed and then stays there bit-exactly")
{
    physics::RigidBodyDef def = jawBody(JointPosition{0.0});
    def.articulation.joints[0].speed = 2.0;
    Stage stage;
    stage.add(def);
    stage.post(SetJoint{{1}, 0, JointPosition{0.5}});
    stage.step(1e-3);
    CHECK(joint(stage).now.position == Approx(0.002));
    CHECK(joint(stage).now.velocity == Approx(2.0));
    const RigidState& body = stage.world.scene().rigid[0].state;
    CHECK(length(body.velocities[1]) == Approx(2.0 * kArm).epsilon(1e-3));
    CHECK(body.angularVelocities[1].z == Approx(2.0));
    stage.run(250, 1e-3);
    CHECK(joint(stage).now.position == 0.5);
    CHECK(joint(stage).now.velocity == 0.0);
    CHECK(length(body.poses[1].position - kArm * Vec3{std::cos(0.5), std::sin(0.5), 0}) < 1e-15);

    stage.post(physics::SetPose{{1}, 0, {{0, 0.01, 0}, axisAngle({0, 0, 1}, 0.1)}}); // the base carries the jaw along
    stage.step(1e-2);
    CHECK(length(body.poses[1].position - Vec3{0, 0.01, 0} - kArm * Vec3{std::cos(0.6), std::sin(0.6), 0}) < 1e-15);
    CHECK(body.angularVelocities[1].z == Approx(10.0));
}

TEST_CASE("a joint with a mimic is where the other one is, in proportion, and keeps it within its own limits")
{
    physics::RigidBodyDef def = jawBody(JointPosition{0.3});
    def.articulation.joints[0].start = 0.2;
    physics::JointDef slide{.kind = physics::JointKind::Prismatic, .axis = {1, 0, 0}, .child = 2, .upper = 0.05};
    slide.mimic = physics::JointMimic{.joint = 0, .multiplier = -0.1, .offset = 0.06};
    def.articulation.joints.push_back(slide);
    Stage stage;
    stage.add(def);
    stage.step(0.0);
    const auto place = [&] { return stage.world.scene().rigid[0].state.poses[2].position.x; };
    CHECK(place() == Approx(0.04).epsilon(1e-14)); // -0.1 * 0.2 + 0.06
    double before = joint(stage, 0, 1).now.position;
    for (int i = 0; i < 400; ++i) {
        if (i == 150) stage.post(SetJoint{{1}, 0, JointPosition{-0.2}});
        stage.step(1e-3);
        const frame::Joint own = joint(stage, 0, 0).now, other = joint(stage, 0, 1).now;
        CHECK(other.position == Approx(-0.1 * own.position + 0.06).epsilon(1e-14));
        CHECK(other.velocity == Approx((other.position - before) / 1e-3).margin(1e-12));
        before = other.position;
    }
    CHECK(joint(stage).now.position == Approx(0.1)); // where the other one is at its limit
    CHECK(place() == Approx(0.05));
    stage.post(SetJoint{{1}, 0, JointPosition{0.3}});
    stage.run(100, 1e-3);
    CHECK(place() == Approx(0.03));
    stage.post(physics::Reset{});
    stage.step(1e-3);
    CHECK(place() == Approx(0.04).margin(0.1 * 3.0 * 1e-3)); // a step from its start
}

TEST_CASE("two jaws of which one mimics the other swing as one, and a torque on either moves both")
{
    physics::RigidBodyDef def = jawBody(JointForce{});
    def.gravity = true;
    def.articulation.joints[0].damping = 2e-5;
    physics::JointDef second = def.articulation.joints[0];
    second.command.reset();
    second.child = 2;
    second.mimic = physics::JointMimic{.joint = 0};
    Stage one, both;
    one.add(def);
    def.articulation.joints.push_back(second);
    both.add(def);
    for (Stage* each : {&one, &both}) each->post(physics::SetGravity{{0, -kGravity, 0}});
    for (int i = 0; i < 300; ++i) {
        one.step(1e-3), both.step(1e-3);
        CHECK(joint(both).now.position == Approx(joint(one).now.position).margin(1e-9));
        CHECK(joint(both, 0, 1).now.position == joint(both).now.position);
    }
    CHECK(std::abs(joint(both).now.position) > 0.5);
    CHECK(both.world.energyOf({1}).kinetic == Approx(2.0 * one.world.energyOf({1}).kinetic));

    def.gravity = false; // one jaw against the other, with a drive that has an inertia of its own
    def.articulation.joints[0].damping = def.articulation.joints[1].damping = 0.0;
    def.articulation.joints[1].mimic->multiplier = -2.0;
    def.articulation.joints[1].inertia = 3e-6;
    for (const int link : {1, 2}) {
        Stage stage;
        stage.add(def);
        stage.post(physics::SetWrench{.id = {1}, .element = link, .torque = {0, 0, 1e-3}});
        stage.step(1e-3);
        const double inertia = kHingeInertia + 4.0 * (kHingeInertia + 3e-6);
        const double velocity = (link == 1 ? 1.0 : -2.0) * 1e-6 / inertia;
        CHECK(joint(stage).now.velocity == Approx(velocity).epsilon(1e-4));
        CHECK(joint(stage, 0, 1).now.velocity == -2.0 * joint(stage).now.velocity);
        const RigidState& body = stage.world.scene().rigid[0].state;
        CHECK(body.angularVelocities[2].z == Approx(-2.0 * velocity).epsilon(1e-4));
    }
}

TEST_CASE("a joint comes to rest at its stop, whose reaction balances the force and the weight")
{
    for (const bool upper : {false, true}) {
        physics::RigidBodyDef def = jawBody(JointForce{upper ? 0.02 : -0.01});
        def.gravity = true;
        def.articulation.joints[0].lower = -0.4;
        def.articulation.joints[0].upper = 0.7;
        Stage stage;
        stage.post(physics::SetGravity{{0, -kGravity, 0}});
        stage.add(def);
        for (int i = 0; i < 500; ++i) {
            stage.step(1e-3);
            CHECK(joint(stage).now.position >= -0.4);
            CHECK(joint(stage).now.position <= 0.7);
        }
        const frame::Joint now = joint(stage).now;
        CHECK(now.position == Approx(upper ? 0.7 : -0.4).epsilon(1e-6));
        CHECK(now.velocity == Approx(0.0).margin(1e-6));
        const double weight = -kJawMass * kGravity * kArm * std::cos(now.position);
        CHECK(now.stop == Approx(-(now.force + weight)).epsilon(1e-4));
        stage.post(SetJoint{{1}, 0, JointForce{upper ? -0.02 : 0.02}}); // it leaves the stop at once
        stage.run(30, 1e-3);
        CHECK(joint(stage).now.stop == 0.0);
        CHECK(std::abs(joint(stage).now.position - now.position) > 0.05);
    }
}

TEST_CASE("dry friction holds a joint up to its limit and brakes a faster one with that limit")
{
    physics::RigidBodyDef def = jawBody(JointForce{0.004});
    def.articulation.joints[0].friction = 0.005;
    Stage stage;
    stage.add(def);
    stage.run(500, 1e-3);
    CHECK(std::abs(joint(stage).now.position) < 1e-3);
    CHECK(std::abs(joint(stage).now.velocity) < 1e-6);
    stage.post(SetJoint{{1}, 0, JointForce{0.006}});
    const double before = joint(stage).now.velocity;
    stage.run(100, 1e-3);
    CHECK(joint(stage).now.velocity - before == Approx(0.1 * 0.001 / kHingeInertia).epsilon(0.02));
    stage.post(SetJoint{{1}, 0, JointForce{0.0}});
    stage.run(200, 1e-3);
    CHECK(std::abs(joint(stage).now.velocity) < 1e-6);
}

TEST_CASE("a spring swings a joint as its equation of motion says, more closely with shorter steps")
{
    constexpr double start = 0.3, target = 0.1, stiffness = 0.01, damping = 1e-4, time = 0.4;
    const double decay = 0.5 * damping / kHingeInertia;
    const double rate = std::sqrt(stiffness / kHingeInertia - decay * decay);
    const double exact = target + (start - target) * std::exp(-decay * time) *
                                      (std::cos(rate * time) + decay / rate * std::sin(rate * time));
    const auto error = [&](double dt) {
        physics::RigidBodyDef def = jawBody(JointSpring{.value = target, .stiffness = stiffness, .damping = damping});
        def.articulation.joints[0].start = start;
        Stage stage;
        stage.add(def);
        stage.run(static_cast<int>(std::lround(time / dt)), dt);
        return std::abs(joint(stage).now.position - exact);
    };
    CHECK(error(1e-3) < 0.04);
    CHECK(error(1e-4) < 4e-3);
    CHECK(error(1e-4) < 0.15 * error(1e-3));
}

TEST_CASE("a spring bears the weight where its force equals it, and no more than its strength")
{
    physics::RigidBodyDef def = jawBody(JointSpring{.stiffness = 0.02, .damping = 5e-4});
    def.gravity = true;
    def.articulation.joints[0].lower = -1.0;
    Stage stage;
    stage.post(physics::SetGravity{{0, -kGravity, 0}});
    const BodyId body = stage.add(def);
    stage.run(3000, 1e-3);
    const auto weight = [&] { return kJawMass * kGravity * kArm * std::cos(joint(stage).now.position); };
    CHECK(joint(stage).now.position < -0.2);
    CHECK(-0.02 * joint(stage).now.position == Approx(weight()).epsilon(1e-6));
    CHECK(joint(stage).now.force == Approx(weight()).epsilon(1e-6));
    // Too weak to hold it: the jaw falls to its stop, which bears the rest.
    stage.post(SetJoint{body, 0, JointSpring{.value = 3.0, .stiffness = 0.02, .strength = 1e-3}});
    stage.run(2000, 1e-3);
    CHECK(joint(stage).now.position == Approx(-1.0).margin(1e-4));
    CHECK(joint(stage).now.force == Approx(1e-3).epsilon(1e-6));
    CHECK(joint(stage).now.stop == Approx(weight() - 1e-3).epsilon(1e-3));
    stage.post(SetJoint{body, 0, JointSpring{.value = 3.0, .stiffness = 0.02, .strength = 0.0}});
    stage.step(1e-3);
    CHECK(joint(stage).now.force == 0.0);
}

TEST_CASE("a spring that reaches its strength accelerates the joint by that, and none is too stiff for a step")
{
    Stage stage;
    stage.add(jawBody(JointSpring{.value = 100.0, .stiffness = 1.0, .strength = 2e-4}));
    stage.run(100, 1e-3);
    CHECK(joint(stage).now.velocity == Approx(2e-4 / kHingeInertia * 0.1).epsilon(1e-6));
    for (const double dt : {1e-4, 1e-3, 2e-2}) {
        physics::RigidBodyDef def = jawBody(JointSpring{.stiffness = 1e9});
        def.articulation.joints[0].start = 0.5;
        Stage stiff;
        stiff.add(def);
        double most = 0.0;
        for (int i = 0; i < 200; ++i) {
            stiff.step(dt);
            most = std::max(most, std::abs(joint(stiff).now.position));
        }
        CAPTURE(dt);
        CHECK(most < 0.5);
        CHECK(std::abs(joint(stiff).now.position) < 1e-3);
    }
}

TEST_CASE("a spring moves the joint that mimics its own, and one of a slide bears weight up to dry friction")
{
    physics::RigidBodyDef def = jawBody(JointSpring{.value = 0.4, .stiffness = 0.01, .damping = 1e-4});
    Stage one;
    one.add(def);
    def.articulation.joints[0].command = JointSpring{.value = 0.4, .stiffness = 0.02, .damping = 2e-4};
    physics::JointDef second = def.articulation.joints[0];
    second.command.reset();
    second.child = 2;
    second.mimic = physics::JointMimic{.joint = 0};
    def.articulation.joints.push_back(second);
    Stage both; // twice the inertia, twice the spring
    both.add(def);
    for (int i = 0; i < 200; ++i) {
        one.step(1e-3), both.step(1e-3);
        CHECK(joint(both).now.position == Approx(joint(one).now.position).margin(1e-9));
        CHECK(joint(both, 0, 1).now.position == joint(both).now.position);
    }
    CHECK(joint(both).now.position > 0.1);

    physics::RigidBodyDef slide = jawBody(JointSpring{.stiffness = 10.0, .damping = 2.0});
    slide.gravity = true;
    slide.articulation.joints[0].kind = physics::JointKind::Prismatic;
    slide.articulation.joints[0].axis = {0, 1, 0};
    for (const double friction : {0.0, 0.05}) {
        slide.articulation.joints[0].friction = friction;
        Stage stage;
        stage.post(physics::SetGravity{{0, -kGravity, 0}});
        stage.add(slide);
        stage.run(4000, 1e-3);
        const double weight = kJawMass * kGravity;
        CHECK(joint(stage).now.position == Approx(-(weight - friction) / 10.0).epsilon(1e-3));
        CHECK(joint(stage).now.force == Approx(weight - friction).epsilon(1e-3));
        CHECK(std::abs(joint(stage).now.velocity) < 1e-9);
    }
}

TEST_CASE("an accelerated base or prismatic joint accelerates the links that hang on it")
{
    // A damped jaw on a base that accelerates with a along x comes to rest in the direction of gravity minus a.
    physics::RigidBodyDef def = jawBody(JointForce{});
    def.gravity = true;
    def.articulation.joints[0].start = -kPi / 2;
    def.articulation.joints[0].damping = 3e-4;
    Stage stage;
    stage.post(physics::SetGravity{{0, -kGravity, 0}});
    stage.add(def);
    const double a = 2.0, dt = 1e-3;
    for (int i = 1; i <= 2000; ++i) {
        stage.post(physics::SetPose{{1}, 0, {{0.5 * a * dt * dt * i * (i + 1), 0, 0}, {}}});
        stage.step(dt);
    }
    CHECK(joint(stage).now.position == Approx(-kPi / 2 - std::atan2(a, kGravity)).epsilon(1e-3));

    // A prismatic joint that carries the hinge has the same effect.
    def.articulation.joints[0].parent = 1;
    def.articulation.joints[0].child = 2;
    def.articulation.joints.push_back({.kind = physics::JointKind::Prismatic, .axis = {1, 0, 0}, .speed = 100.0});
    Stage sliding;
    sliding.post(physics::SetGravity{{0, -kGravity, 0}});
    sliding.add(def);
    for (int i = 1; i <= 2000; ++i) {
        sliding.post(SetJoint{{1}, 1, JointPosition{0.5 * a * dt * dt * i * (i + 1)}});
        sliding.step(dt);
    }
    CHECK(joint(sliding).now.position == Approx(joint(stage).now.position).epsilon(1e-9));
}

TEST_CASE("reset restores the positions and the commands that joints were added with")
{
    physics::RigidBodyDef def = jawBody(JointForce{0.003});
    def.articulation.joints[0].start = 0.2;
    Stage stage;
    stage.add(def);
    stage.step(1e-3);
    const std::uint64_t first = stage.world.hash();
    stage.post(SetJoint{{1}, 0, JointPosition{1.0}});
    stage.post(physics::SetPose{{1}, 0, {{0, 0.1, 0}, {}}});
    stage.run(100, 1e-3);
    stage.post(physics::Reset{});
    stage.step(0.0);
    CHECK(joint(stage).now.position == 0.2);
    CHECK(joint(stage).now.velocity == 0.0);
    CHECK(std::get<JointForce>(joint(stage).command).value == 0.003);
    const RigidState body = stage.world.scene().rigid[0].state;
    CHECK(length(body.poses[1].position - kArm * Vec3{std::cos(0.2), std::sin(0.2), 0}) < 1e-15);
    stage.world.scene().step = 0;
    stage.world.scene().time = 0.0;
    stage.step(1e-3);
    CHECK(stage.world.hash() == first);
}

TEST_CASE("a base follows the element that it is attached to, and stays in place if that body is removed")
{
    Stage stage;
    const BodyId arm = stage.add(physics::RigidBodyDef{.name = "arm", .elements = {Pose{}, Pose{{1, 0, 0}, {}}}});
    physics::RigidBodyDef def = jawBody(JointPosition{0.0});
    def.articulation.to = arm;
    def.articulation.toElement = 1;
    def.articulation.offset = {{0, 0, 0.1}, axisAngle({0, 0, 1}, kPi / 2)};
    const BodyId jaw = stage.add(def);
    physics::RigidBodyDef more = jawBody(JointPosition{0.0});
    more.articulation.to = jaw;
    more.articulation.offset = {{0, 0, 0.1}, {}};
    stage.add(more);
    stage.step(0.0);
    const auto pose = [&](std::size_t body, std::size_t element) {
        return stage.world.scene().rigid[body].state.poses[element];
    };
    CHECK(length(pose(1, 0).position - Vec3{1, 0, 0.1}) < 1e-15);
    CHECK(length(pose(1, 1).position - Vec3{1, kArm, 0.1}) < 1e-15);
    CHECK(length(pose(2, 1).position - Vec3{1, kArm, 0.2}) < 1e-15);

    stage.post(physics::SetPose{arm, 1, {{1.002, 0, 0}, {}}});
    stage.step(1e-3);
    CHECK(length(pose(1, 1).position - Vec3{1.002, kArm, 0.1}) < 1e-15);
    CHECK(length(pose(2, 1).position - Vec3{1.002, kArm, 0.2}) < 1e-15);
    CHECK(stage.world.scene().rigid[2].state.velocities[1].x == Approx(2.0));

    stage.post(physics::RemoveBody{arm});
    stage.step(1e-3);
    CHECK(length(pose(0, 1).position - Vec3{1.002, kArm, 0.1}) < 1e-15);
    CHECK(length(stage.world.scene().rigid[0].state.velocities[1]) == 0.0);
    stage.post(physics::SetPose{jaw, 0, {{1.003, 0, 0}, {}}}); // the base now accepts poses
    stage.step(1e-3);
    CHECK(pose(0, 1).position.x == Approx(1.003 + kArm));
    CHECK(pose(1, 1).position.x == Approx(1.003 + kArm)); // without the base's rotation
    stage.post(physics::Reset{});
    stage.step(0.0);
    CHECK(pose(1, 0).position == pose(0, 0).position + Vec3{0, 0, 0.1});
}

TEST_CASE("a joint that diverges is stopped and reported")
{
    physics::RigidBodyDef def = jawBody(JointForce{1e9});
    def.articulation.joints[0].kind = physics::JointKind::Prismatic;
    def.articulation.joints[0].axis = {1, 0, 0};
    Stage stage;
    stage.add(def);
    const physics::StepReport report = stage.run(3, 1e-3);
    CHECK(report.has(physics::StepFlag::Undone));
    CHECK(report.undone == std::vector{BodyId{1}});
    CHECK(std::isfinite(joint(stage).now.position));
    CHECK(joint(stage).now.velocity == 0.0);
    stage.post(SetJoint{{1}, 0, JointPosition{0.01}}); // the joint can be used again
    CHECK_FALSE(stage.run(2000, 1e-3).has(physics::StepFlag::Undone));
    CHECK(joint(stage).now.position == 0.01);
}

namespace {

/// A jaw on a free base of 50 g, without gravity.
physics::RigidBodyDef freeTool(const physics::JointCommand& command)
{
    physics::RigidBodyDef def = jawBody(command);
    def.dynamic = true;
    def.mass = physics::GivenInertia{.mass = 0.05, .centre = {-0.01, 0.002, 0.001}, .moments = {2e-5, 3e-5, 4e-5}};
    return def;
}

/// Linear momentum, angular momentum about the origin and energy of all links of the first rigid body.
struct Motion {
    Vec3 momentum, spin;
    double energy = 0.0;
};
Motion motionOf(Stage& stage)
{
    const RigidModel& model = stage.world.scene().rigid[0].model;
    const RigidState& state = stage.world.scene().rigid[0].state;
    Motion sum;
    for (std::size_t e = 0; e < state.poses.size(); ++e) {
        const physics::RigidInertia& own = model.inertias[e];
        const Vec3 w = state.angularVelocities[e], centre = transform(state.poses[e], own.centre);
        const Vec3 v = state.velocities[e] + cross(w, centre - state.poses[e].position);
        const Vec3 turning = worldInertia(own.inertia, state.poses[e].orientation) * w;
        sum.momentum += own.mass * v;
        sum.spin += cross(centre, own.mass * v) + turning;
        sum.energy += 0.5 * own.mass * dot(v, v) + 0.5 * dot(w, turning);
    }
    return sum;
}

} // namespace

TEST_CASE("a free tool that drives its own joints conserves linear and angular momentum")
{
    for (const double dt : {1e-3, 1e-4}) {
        Stage stage;
        physics::RigidBodyDef def = freeTool(JointForce{1e-4});
        def.articulation.joints[0].axis = {0.3, 0.5, 1.0};
        def.velocity = {0.1, 0.0, 0.05};
        def.angularVelocity = {0.5, -1.0, 0.7};
        stage.add(def);
        stage.step(dt);
        const Motion before = motionOf(stage);
        stage.run(static_cast<int>(0.3 / dt), dt);
        const Motion after = motionOf(stage);
        CHECK(std::abs(joint(stage).now.velocity) > 0.5); // the joint has moved
        CHECK(length(after.momentum - before.momentum) < 20.0 * dt * length(before.momentum));
        CHECK(length(after.spin - before.spin) < 20.0 * dt * length(before.spin));
    }
}

TEST_CASE("a free tool falls with its weight, and a wrench on its base moves all of it")
{
    Stage stage;
    physics::RigidBodyDef def = freeTool(JointForce{});
    def.gravity = true;
    stage.post(physics::SetGravity{{0, -kGravity, 0}});
    stage.add(def);
    stage.run(100, 1e-3);
    CHECK(length(motionOf(stage).momentum - Vec3{0, -0.07 * kGravity * 0.1, 0}) < 1e-9);
    CHECK(std::abs(joint(stage).now.velocity) < 1e-9);
    stage.post(physics::SetGravity{});
    stage.post(physics::SetPose{{1}, 0, {{0, 1, 0}, {}}}); // placed at once and at rest
    stage.step(0.0);
    CHECK(length(stage.world.scene().rigid[0].state.poses[1].position - Vec3{kArm, 1, 0}) < 1e-9);
    stage.post(physics::SetWrench{{1}, 0, {0.07, 0, 0}, {}});
    stage.run(10, 1e-3);
    CHECK(motionOf(stage).momentum.x == Approx(0.07 * 0.01).epsilon(1e-3));
    CHECK(motionOf(stage).energy > 0.0);
}

TEST_CASE("a jaw on a heavy free base, or on a light attached one, swings as on a kinematic base")
{
    const auto swing = [](bool dynamic, double mass, bool held) {
        physics::RigidBodyDef def = jawBody(JointForce{});
        def.gravity = !dynamic || held;
        def.articulation.joints[0].command = JointForce{dynamic && !held ? 2e-3 : 0.0};
        if (!dynamic && mass > 0.0) {
            def.gravity = false;
            def.articulation.joints[0].command = JointForce{2e-3};
        }
        def.dynamic = dynamic;
        const double moment = 0.01 * std::max(mass, 1.0);
        def.mass = physics::GivenInertia{.mass = std::max(mass, 1e-3), .moments = {moment, moment, moment}};
        if (held) def.attachments = {{.element = 0}};
        Stage stage;
        stage.post(physics::SetGravity{{0, -kGravity, 0}});
        stage.add(def);
        stage.run(100, 1e-3);
        return joint(stage).now.position;
    };
    CHECK(swing(true, 1e4, false) == Approx(swing(false, 1e4, false)).epsilon(1e-4));
    CHECK(swing(true, 0.0, true) == Approx(swing(false, 0.0, false)).epsilon(1e-3));
}

TEST_CASE("the rotation of a free body with joints is damped as that of one without, also if it has no other damping")
{
    constexpr double perSecond = 5.0, dt = 1e-3, start = 2.0;
    physics::RigidBodyDef def{.name = "tool", .dynamic = true, .gravity = false};
    def.mass = physics::GivenInertia{.mass = 0.05, .moments = {2e-5, 3e-5, 4e-5}};
    def.articulation.joints = {
        {.command = JointForce{0.0}}}; // both centres lie on its axis, which is also the axis of rotation
    def.articulation.joints[0].mass = physics::GivenInertia{.mass = kJawMass, .moments = {1e-6, 2e-6, 3e-6}};
    def.velocity = {0.1, 0, 0};
    def.angularVelocity = {0, 0, start};
    def.angularDamping = perSecond;
    Stage stage;
    stage.add(def);
    constexpr int steps = 300;
    stage.run(steps, dt);
    const RigidState& state = stage.world.scene().rigid[0].state;
    for (const Vec3& spin : state.angularVelocities)
        CHECK(spin.z == Approx(start * std::pow(1.0 + perSecond * dt, -steps)).epsilon(1e-9));
    CHECK(state.angularVelocities[0].z == Approx(start * std::exp(-perSecond * steps * dt)).epsilon(5e-3));
    CHECK(std::abs(joint(stage).now.velocity) < 1e-9);
    CHECK(state.velocities[0].x == Approx(0.1).epsilon(1e-9)); // only the rotation is damped
}

} // namespace joints_test
