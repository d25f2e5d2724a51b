#include "filasofia/engine/contact/turned_contact.h"

#include "engine/stage.h"

#include "filasofia/geometry/shapes.h"

namespace turned_contact_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

constexpr double kArm = 0.1, kSpeed = 3.0, dt = 1e-3;

/// Two plates above and below a block that is kArm beside their origin. By the velocity at the start of each step it
/// would creep outwards by kArm kSpeed^2 dt / 2 = 0.45 mm/s.
geometry::TriangleMesh plates(double gap)
{
    geometry::TriangleMesh out;
    for (double side : {-1.0, 1.0}) {
        const geometry::TriangleMesh plate = *geometry::shapes::box({0.03, 0.01, 0.03});
        const auto first = static_cast<int>(out.vertices.size());
        for (Vec3 vertex : plate.vertices) out.vertices.push_back(vertex + Vec3{kArm, side * (0.005 + 0.5 * gap), 0});
        for (const geometry::Triangle& t : plate.triangles)
            out.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
    return out;
}

physics::RigidBodyDef gripper(double gap)
{
    return {.name = "plates",
            .elements = {Pose{}},
            .mesh = std::make_shared<const geometry::TriangleMesh>(plates(gap)),
            .collision = {{}},
            .friction = 0.8};
}

void addBlock(Stage& stage)
{
    stage.add(physics::RigidBodyDef{.name = "block",
                                    .elements = {Pose{{kArm, 0, 0}, {}}},
                                    .mesh = geometry::shapes::box({0.016, 0.016, 0.016}),
                                    .dynamic = true,
                                    .collision = {{}},
                                    .friction = 0.8});
}

double fromAxis(Vec3 place) { return std::hypot(place.x, place.z); }

Pose turned(double angle) { return {{}, axisAngle({0, 1, 0}, angle)}; }

} // namespace

TEST_CASE("what friction holds between plates that turn about an axis beside them does not creep outwards")
{
    for (const bool soft : {false, true}) {
        CAPTURE(soft);
        Stage stage;
        if (soft)
            stage.add(physics::SoftBodyDef{.mesh = geometry::shapes::block({0.016, 0.016, 0.016}, {3, 3, 3}),
                                           .pose = {{kArm, 0, 0}, {}},
                                           .material = physics::FemMaterial{.youngModulus = 5e4},
                                           .collision = {{}},
                                           .friction = 0.8});
        else
            addBlock(stage);
        const BodyId held = stage.add(gripper(soft ? 0.015 : 0.01599));
        stage.run(300, dt);
        double angle = 0.0;
        const auto place = [&] {
            if (!soft) return stage.world.scene().rigid[0].state.poses[0].position;
            Vec3 sum;
            for (Vec3 x : stage.soft().x) sum += 1.0 / static_cast<double>(stage.soft().x.size()) * x;
            return sum;
        };
        const double start = fromAxis(place());
        for (int i = 0; i < 2000; ++i) {
            angle += kSpeed * dt * std::min(1.0, i / 500.0);
            stage.post(physics::SetPose{held, 0, turned(angle)});
            CHECK((stage.step(dt).flags & ~static_cast<std::uint32_t>(physics::StepFlag::NotConverged)) == 0);
        }
        CHECK(std::abs(fromAxis(place()) - start) < 2e-5);
    }
}

TEST_CASE("what friction holds in the arm of a free joint does not creep outwards")
{
    Stage stage;
    addBlock(stage);
    physics::RigidBodyDef arm = gripper(0.01599);
    arm.elements = {Pose{}};
    arm.collision = {{.element = 1}};
    arm.articulation.joints = {{.axis = {0, 1, 0}, .command = physics::JointForce{0.0}}};
    const BodyId held = stage.add(arm);
    stage.run(100, dt);
    const auto joint = [&] { return stage.world.scene().rigid[1].state.joints[0].now; };
    stage.post(physics::SetJoint{held, 0, physics::JointForce{1e-2}});
    while (joint().velocity < kSpeed && stage.world.scene().step < 5000) stage.step(dt);
    REQUIRE(joint().velocity >= kSpeed);
    stage.post(physics::SetJoint{held, 0, physics::JointForce{0.0}});
    stage.run(2000, dt);
    const double creep = fromAxis(stage.world.scene().rigid[0].state.poses[0].position) - kArm;
    INFO(creep);
    CHECK(joint().velocity == Approx(kSpeed).epsilon(0.02));
    CHECK(std::abs(creep) < 2e-5);
}

TEST_CASE("a block on a turntable stays where it is below the speed at which it slips, and flies off above it")
{
    const double slips = std::sqrt(0.3 * 9.81 / kArm);
    for (const double part : {0.95, 1.05}) {
        CAPTURE(part);
        Stage stage;
        physics::RigidBodyDef block{.elements = {Pose{{kArm, 5.01e-3, 0}, {}}},
                                    .mesh = geometry::shapes::box({0.01, 0.01, 0.01}),
                                    .dynamic = true,
                                    .collision = {{}},
                                    .friction = 0.3};
        stage.add(block);
        const BodyId table = stage.add(physics::RigidBodyDef{.elements = {Pose{{0, -0.01, 0}, {}}},
                                                             .mesh = geometry::shapes::box({0.4, 0.02, 0.4}),
                                                             .collision = {{}},
                                                             .friction = 0.3});
        stage.post(physics::SetGravity{{0, -9.81, 0}});
        stage.run(50, dt);
        double angle = 0.0;
        for (int i = 0; i < 4000; ++i) {
            angle += part * slips * dt * std::min(1.0, i / 3000.0);
            stage.post(physics::SetPose{table, 0, {{0, -0.01, 0}, axisAngle({0, 1, 0}, angle)}});
            stage.step(dt);
        }
        const double away = fromAxis(stage.world.scene().rigid[0].state.poses[0].position) - kArm;
        INFO(away);
        CHECK((part < 1.0 ? std::abs(away) < 2e-5 : away > 1e-3));
    }
}

} // namespace turned_contact_test
