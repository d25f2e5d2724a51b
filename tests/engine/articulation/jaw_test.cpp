#include "engine/articulation/jaw.h"

#include <iostream>

namespace jaw_test {

using namespace filasofia;
using namespace filasofia::engine;
using physics::JointForce;
using physics::JointPosition;
using physics::SetJoint;

namespace {

/// A jaw above a cushion; ids 1 and 2.
struct JawScene {
    Stage stage;
    explicit JawScene(const physics::JointCommand& command, int threads = 1) : stage({.threads = threads})
    {
        physics::RigidBodyDef def = touchingJaw(command);
        def.articulation.joints[0].lower = -1.0;
        def.articulation.joints[0].upper = 1.0;
        def.articulation.joints[0].damping = 1e-4;
        stage.add(def);
        stage.add(cushion(-0.003));
    }
};

} // namespace

TEST_CASE("a jaw that closes with a torque stalls against tissue and keeps that torque within 2 %")
{
    for (const double torque : {-0.002, -0.01, -0.03}) {
        JawScene scene{JointForce{torque}};
        scene.stage.run(1000, 1e-3);
        const double before = joint(scene.stage).now.position;
        double load = 0.0, byFrame = 0.0, worst = 0.0;
        constexpr int steps = 20; // at single steps contacts that come and go shake it (docs/lab/contact.md)
        for (int i = 0; i < 10 * steps; ++i) {
            if (i % steps == 0) load = byFrame = 0.0;
            scene.stage.step(1e-3);
            load += joint(scene.stage).now.load / steps;
            byFrame += contactTorque(scene.stage, {1}) / steps;
            CHECK(std::abs(joint(scene.stage).now.load / -torque - 1.0) < 0.1);
            if (i % steps < steps - 1) continue;
            CHECK(std::abs(load / -torque - 1.0) < 0.02);
            CHECK(std::abs(byFrame / -torque - 1.0) < 0.02);
            worst = std::max({worst, std::abs(load / -torque - 1.0), std::abs(byFrame / -torque - 1.0)});
        }
        const frame::Joint now = joint(scene.stage).now;
        std::cout << "a jaw commanded to close with " << torque << " N m stands at " << now.position
                  << " rad; means of its load over 20 ms are off by up to " << 100.0 * worst << " %\n";
        CHECK(now.position < -0.005); // it has touched the tissue and sunk in
        CHECK(now.position == Approx(before).epsilon(0.02));
        CHECK(now.force == torque);
        CHECK(now.stop == 0.0);
    }
}

TEST_CASE("the force of a joint with a commanded position equals the resistance of the tissue")
{
    JawScene scene{JointPosition{-0.12}};
    scene.stage.run(1500, 1e-3);
    const frame::Joint now = joint(scene.stage).now;
    CHECK(now.position == -0.12);
    CHECK(now.force < -0.001);
    CHECK(now.force == -now.load);
    CHECK(now.load == Approx(contactTorque(scene.stage, {1})).epsilon(0.01));

    // The same torque as a command keeps the joint at its place. The mean is compared, since single steps fluctuate as
    // contacts appear and disappear.
    constexpr int steps = 100;
    double torque = 0.0;
    for (int i = 0; i < steps; ++i) {
        scene.stage.step(1e-3);
        torque += joint(scene.stage).now.force / steps;
    }
    scene.stage.post(SetJoint{{1}, 0, JointForce{torque}});
    scene.stage.run(1000, 1e-3);
    CHECK(joint(scene.stage).now.position == Approx(-0.12).epsilon(0.02));
    CHECK(joint(scene.stage).now.load == Approx(-torque).epsilon(0.02));
}

TEST_CASE("a jaw passes the angular momentum that it loses to a free box and adds no energy")
{
    // Without friction and gravity the sum of both angular momenta about the hinge's axis is conserved.
    for (const bool pressed : {false, true}) {
        physics::RigidBodyDef jaw = touchingJaw(JointForce{-0.02});
        jaw.friction = 0.0;
        jaw.articulation.joints[0].start = 0.3;
        Stage stage;
        stage.add(jaw);
        physics::RigidBodyDef box{.name = "box", .mesh = geometry::shapes::box({0.02, 0.02, 0.02})};
        box.elements = {Pose{{0.035, -0.02, 0.002}, {}}};
        box.dynamic = true;
        box.gravity = false;
        box.friction = 0.0;
        box.mass = physics::TotalMass{0.01};
        box.collision = {{}};
        stage.add(box);
        stage.run(20, 1e-3);
        if (!pressed) stage.post(SetJoint{{1}, 0, JointForce{0.0}});
        const auto angularMomentum = [&] {
            const physics::RigidInertia& inertia = stage.world.scene().rigid[1].model.inertias[0];
            const RigidState& other = stage.world.scene().rigid[1].state;
            const Vec3 centre = transform(other.poses[0], inertia.centre);
            const Mat3 turning = worldInertia(inertia.inertia, other.poses[0].orientation);
            return kHingeInertia * joint(stage).now.velocity + cross(centre, inertia.mass * other.velocities[0]).z +
                   (turning * other.angularVelocities[0]).z;
        };
        const auto energy = [&] {
            const physics::RigidInertia& inertia = stage.world.scene().rigid[1].model.inertias[0];
            const RigidState& other = stage.world.scene().rigid[1].state;
            const Vec3 w = other.angularVelocities[0];
            const Mat3 turning = worldInertia(inertia.inertia, other.poses[0].orientation);
            return 0.5 * kHingeInertia * joint(stage).now.velocity * joint(stage).now.velocity +
                   0.5 * inertia.mass * lengthSquared(other.velocities[0]) + 0.5 * dot(w, turning * w);
        };
        const double before = angularMomentum(), energyBefore = energy();
        double given = 0.0;
        bool touched = false;
        for (int i = 0; i < 100; ++i) {
            stage.step(1e-3);
            given += pressed ? -0.02 * 1e-3 : 0.0;
            touched = touched || joint(stage).now.load != 0.0;
            CHECK(joint(stage).now.load == Approx(contactTorque(stage, {1})).epsilon(0.02).margin(1e-9));
        }
        CHECK(touched);
        CHECK(length(stage.world.scene().rigid[1].state.velocities[0]) > 0.1);
        CHECK(angularMomentum() == Approx(before + given).epsilon(0.01));
        if (!pressed) CHECK(energy() <= energyBefore * (1.0 + 1e-6));
    }
}

TEST_CASE("a jaw on tissue is bit-identical with 1, 2 and 8 threads")
{
    std::vector<std::uint64_t> hashes;
    for (const int threads : {1, 2, 8}) {
        JawScene scene{JointForce{-0.01}, threads};
        scene.stage.run(200, 1e-3);
        CHECK(joint(scene.stage).now.load > 0.0);
        hashes.push_back(scene.stage.world.hash());
    }
    CHECK((hashes[1] == hashes[0] && hashes[2] == hashes[0]));
}

TEST_CASE("two jaws of one body hold tissue between them by their torques, and a grasp attaches it to both")
{
    physics::RigidBodyDef tool = touchingJaw(JointForce{-0.01});
    tool.friction = 1.0;
    physics::JointDef other = tool.articulation.joints[0];
    tool.articulation.joints[0].start = 0.5;
    tool.articulation.joints[0].damping = other.damping = 1e-4;
    other.child = 2;
    other.start = -0.5;
    other.command = JointForce{0.01};
    tool.articulation.joints.push_back(other);
    tool.collision.push_back(tool.collision[0]);
    tool.collision[1].element = 2;
    Stage stage;
    const BodyId gripper = stage.add(tool);
    physics::SoftBodyDef tissue = cushion(0.005);
    tissue.mesh = shared(boxMesh({3, 2, 3}, {0.02, 0.01, 0.02}));
    tissue.pose.position = {0.022, -0.005, -0.01};
    tissue.attachments = {};
    tissue.friction = 1.0;
    tissue.rayleigh = {2.0, 0.01};
    const BodyId held = stage.add(tissue);
    stage.run(600, 1e-3);
    CHECK(joint(stage, 0, 0).now.load == Approx(0.01).epsilon(0.05));
    CHECK(joint(stage, 0, 1).now.load == Approx(-0.01).epsilon(0.05));

    stage.post(physics::Grasp{{1}, gripper, held, {}});
    CHECK_FALSE(stage.step(1e-3).has(physics::StepFlag::NothingAttached));
    std::set<int> elements;
    for (const auto& pair : stage.world.scene().attachments.at(0).pairs) elements.insert(pair[1].element);
    CHECK(elements == std::set<int>{1, 2});
    const auto middle = [&] {
        Vec3 sum;
        for (Vec3 x : stage.soft().x) sum += x;
        return 1.0 / static_cast<double>(stage.soft().x.size()) * sum;
    };
    // If the second joint kept its force, both jaws would rotate together.
    stage.post(SetJoint{gripper, 1, JointPosition{joint(stage, 0, 1).now.position}});
    const Vec3 before = middle();
    for (int i = 1; i <= 400; ++i) {
        stage.post(physics::SetPose{gripper, 0, {{0, 5e-5 * i, 0}, {}}});
        stage.step(1e-3);
    }
    stage.run(300, 1e-3);
    CHECK((middle() - before).y == Approx(0.02).epsilon(0.1));
}

TEST_CASE("a blade that a joint moves cuts with a commanded position and with a commanded force")
{
    const auto rectangle = std::make_shared<const geometry::TriangleMesh>(
        geometry::TriangleMesh{.vertices = {{-0.02, 0, -0.05}, {0.02, 0, -0.05}, {0.02, 0, 0.05}, {-0.02, 0, 0.05}},
                               .triangles = {{0, 1, 2}, {0, 2, 3}},
                               .uv = {}});
    for (const bool force : {false, true}) {
        const physics::JointCommand command =
            force ? physics::JointCommand{JointForce{-0.01}} : physics::JointCommand{JointPosition{-0.5}};
        physics::RigidBodyDef blade = jawBody(command);
        blade.articulation.joints[0].start = 0.4;
        blade.articulation.joints[0].damping = 5e-3;
        blade.collision = {{.mesh = rectangle, .element = 1, .proximity = 0, .cutting = true}};
        Stage stage;
        stage.add(blade);
        physics::SoftBodyDef tissue = cushion(0.005);
        tissue.dynamicTopology = true;
        stage.add(tissue);
        double area = 0.0;
        for (int i = 0; i < 600; ++i)
            for (const physics::Rupture& each : stage.step(1e-3).topology.ruptures) area += each.area;
        CHECK(joint(stage).now.position < -0.05);
        CHECK(area > 1e-5);
    }
}

TEST_CASE("a tool that pushes a jaw against its stop leaves it finite, with a bounded load")
{
    physics::RigidBodyDef jaw = touchingJaw(JointForce{0.0});
    jaw.articulation.joints[0].lower = -0.5;
    jaw.articulation.joints[0].upper = 0.5;
    Stage stage;
    stage.add(jaw);
    physics::RigidBodyDef tool{.name = "tool", .mesh = geometry::shapes::box({0.02, 0.02, 0.02}), .collision = {{}}};
    tool.elements = {Pose{{0.03, 0.03, 0}, {}}};
    const BodyId id = stage.add(tool);
    double most = 0.0;
    for (int i = 0; i < 2000; ++i) {
        stage.post(physics::SetPose{id, 0, {{0.03, 0.03 - 3e-5 * i, 0}, {}}});
        stage.step(1e-3);
        const frame::Joint& now = joint(stage).now;
        CHECK((now.position >= -0.5 && now.position <= 0.5));
        most = std::max({most, std::abs(now.load), std::abs(now.stop)});
    }
    CHECK(most > 1.0);
    CHECK(most < 100.0); // 1 kN at 3 cm
}

TEST_CASE("a free tool, the body that it is attached to and the box that its jaw strikes conserve momentum")
{
    for (const bool commandsPosition : {false, true}) {
        physics::RigidBodyDef tool =
            touchingJaw(commandsPosition ? physics::JointCommand{JointPosition{-0.6}} : JointForce{-0.002});
        tool.dynamic = true;
        tool.mass = physics::GivenInertia{.mass = 0.05, .moments = {2e-5, 2e-5, 2e-5}};
        physics::RigidBodyDef hand{.name = "hand", .elements = {Pose{{-0.02, 0, 0}, {}}}};
        hand.dynamic = true;
        hand.gravity = false;
        hand.mass = physics::GivenInertia{.mass = 0.2, .moments = {1e-4, 1e-4, 1e-4}};
        physics::RigidBodyDef box{.name = "box", .mesh = geometry::shapes::box({0.02, 0.02, 0.02})};
        box.elements = {Pose{{0.035, -0.02, 0.002}, {}}};
        box.dynamic = true;
        box.gravity = false;
        box.mass = physics::TotalMass{0.01};
        box.collision = {{}};
        Stage stage;
        const BodyId first = stage.add(tool);
        hand.attachments = {{.to = first}};
        stage.add(hand);
        stage.add(box);
        const auto momentumOf = [&](std::size_t body) {
            const RigidModel& model = stage.world.scene().rigid[body].model;
            const RigidState& state = stage.world.scene().rigid[body].state;
            Vec3 sum;
            for (std::size_t e = 0; e < state.poses.size(); ++e) {
                const Vec3 arm = rotate(state.poses[e].orientation, model.inertias[e].centre);
                const bool link = state.poses.size() > 1; // otherwise the velocity is that of the centre
                sum += model.inertias[e].mass *
                       (state.velocities[e] + (link ? cross(state.angularVelocities[e], arm) : Vec3{}));
            }
            return sum;
        };
        double struck = 0.0;
        for (int i = 0; i < (commandsPosition ? 800 : 480); ++i) {
            stage.step(2.5e-4);
            struck = std::max(struck, std::abs(joint(stage).now.load));
        }
        CHECK(struck > 1e-3);
        CHECK(length(momentumOf(2)) > 1e-4);
        const double kept = length(momentumOf(0) + momentumOf(1) + momentumOf(2)) / length(momentumOf(2));
        std::cout << "a free tool strikes a box: " << 100.0 * kept << " % of the box's momentum is not accounted for\n";
        CHECK(kept < 0.01);
        const RigidState& base = stage.world.scene().rigid[0].state;
        CHECK(length(transform(inverse(base.poses[0]), stage.world.scene().rigid[1].state.poses[0].position) -
                     Vec3{-0.02, 0, 0}) < 1e-4); // attached all the time
    }
}

namespace {

/// Two jaws on hinges of one base, which a torque closes; the base's model overlaps both.
physics::RigidBodyDef scissorsJaws(bool self)
{
    physics::RigidBodyDef def = jawBody(JointForce{-0.02});
    def.articulation.joints[0].parentOffset = {{0, 0.005, 0}, {}};
    def.articulation.joints[0].start = 0.2;
    def.articulation.joints[0].damping = 1e-4;
    def.articulation.joints.push_back(def.articulation.joints[0]);
    physics::JointDef& lower = def.articulation.joints[1];
    lower.child = 2;
    lower.parentOffset.position.y = -0.005;
    lower.start = -0.2;
    lower.command = JointForce{0.02};
    const auto plate = geometry::shapes::box({0.04, 0.004, 0.02});
    def.collision = {{.mesh = geometry::shapes::box({0.03, 0.02, 0.02}), .element = 0, .self = self},
                     {.mesh = plate, .element = 1, .self = self},
                     {.mesh = plate, .element = 2, .self = self}};
    return def;
}

} // namespace

TEST_CASE("links with self meet each other, but not the link that a joint connects them to")
{
    for (const bool self : {false, true}) {
        Stage stage;
        const BodyId id = stage.add(scissorsJaws(self));
        stage.run(1000, 1e-3);
        const frame::Joint upper = joint(stage, 0, 0).now, lower = joint(stage, 0, 1).now;
        if (!self) {
            CHECK(stage.world.scene().contactReports.empty());
            CHECK(upper.position < -1.0); // it went through
            continue;
        }
        CHECK(upper.position == Approx(-lower.position).margin(1e-3));
        CHECK(upper.position > -0.2);
        double torque = 0.0; // on the upper jaw, about its hinge
        for (const frame::Contact& each : stage.world.scene().contactReports) {
            CHECK((each.first == id && each.second == id));
            const Vec3 force = each.normalForce * each.normal + each.friction;
            const double up = force.y > 0.0 ? 1.0 : -1.0; // towards the upper jaw, whichever is first
            torque += cross(each.point - Vec3{0, 0.005, 0}, up * force).z;
        }
        CHECK(torque == Approx(0.02).epsilon(0.02));
        CHECK(upper.load == Approx(0.02).epsilon(0.02));
    }
}

TEST_CASE("elements of one body that no joint connects meet if they have self")
{
    for (const bool self : {false, true}) {
        Stage stage;
        stage.post(physics::SetGravity{{0, -9.81, 0}});
        stage.add(physics::RigidBodyDef{
            .elements = {{{0, -0.01, 0}}}, .mesh = geometry::shapes::box({0.1, 0.02, 0.1}), .collision = {{}}});
        stage.add(physics::RigidBodyDef{.elements = {{{0, 0.012, 0}}, {{0, 0.035, 0}}},
                                        .mesh = geometry::shapes::box({0.02, 0.02, 0.02}),
                                        .dynamic = true,
                                        .collision = {{.self = self}, {.element = 1, .self = self}}});
        stage.run(800, 1e-3);
        const double height = stage.world.scene().rigid[1].state.poses[1].position.y;
        CHECK(height == Approx(self ? 0.03 : 0.01).margin(2e-3)); // on the other, or in it
    }
}

} // namespace jaw_test
