#include "engine/stage.h"

#include "filasofia/geometry/shapes.h"

#include <cmath>
#include <numbers>

namespace round_bodies_test {

using namespace filasofia;
using namespace filasofia::engine;
namespace shapes = filasofia::geometry::shapes;

// Meshes that stand for balls and capsules collide with what is rigid as the exact ones.
namespace {

physics::RigidBodyDef bodyOf(std::shared_ptr<const geometry::TriangleMesh> mesh, Vec3 at)
{
    return {.elements = {{at, {}}}, .mesh = std::move(mesh), .dynamic = true, .collision = {{}}, .friction = 0.5};
}

Stage stageOnFloor(double tilt = 0.0)
{
    Stage stage;
    stage.post(physics::SetGravity{9.81 * Vec3{std::sin(tilt), -std::cos(tilt), 0.0}});
    physics::RigidBodyDef floor = bodyOf(shapes::box({10, 0.1, 0.4}), {0, -0.05, 0});
    floor.dynamic = false;
    stage.add(floor);
    return stage;
}

const RigidState& rigid(Stage& stage, std::size_t body = 1) { return stage.world.scene().rigid[body].state; }

double pressed(Stage& stage)
{
    double sum = 0.0;
    for (const frame::Contact& each : stage.world.scene().contactReports) sum += each.normalForce;
    return sum;
}

} // namespace

TEST_CASE("a ball touches a floor and another ball in one point each, a capsule that lies in two")
{
    const std::size_t contacts = [] {
        Stage stage = stageOnFloor();
        stage.add(bodyOf(shapes::sphere(0.01), {0, 0.01, 0}));
        stage.add(bodyOf(shapes::sphere(0.01), {0, 0.0301, 0}));
        stage.run(200, 1e-3);
        CHECK(rigid(stage, 2).poses[0].position.y == Approx(0.03).margin(1e-4));
        return stage.world.scene().contactReports.size();
    }();
    CHECK(contacts == 2);

    Stage stage = stageOnFloor();
    physics::RigidBodyDef capsule = bodyOf(shapes::capsule(0.01, 0.05), {0, 0.0101, 0});
    capsule.elements[0].orientation = axisAngle({0, 0, 1}, 0.5 * std::numbers::pi);
    capsule.mass = physics::TotalMass{0.1};
    stage.add(capsule);
    stage.run(300, 1e-3);
    CHECK(stage.world.scene().contactReports.size() == 2);
    CHECK(pressed(stage) == Approx(0.981).epsilon(1e-3));
    CHECK(length(rigid(stage).velocities[0]) < 1e-6);
}

TEST_CASE("a ball rolls on and down at any rate")
{
    // With the points of its mesh it had 0.5 of its speed after a second at 100 Hz.
    for (const double rate : {1000.0, 400.0, 100.0}) {
        CAPTURE(rate);
        Stage stage = stageOnFloor();
        physics::RigidBodyDef ball = bodyOf(shapes::sphere(0.01), {-1, 0.01, 0});
        ball.velocity = {1, 0, 0};
        ball.angularVelocity = {0, 0, -100};
        stage.add(ball);
        stage.run(static_cast<int>(rate), 1.0 / rate);
        CHECK(rigid(stage).velocities[0].x == Approx(1.0).epsilon(5e-3));

        Stage slope = stageOnFloor(0.2);
        slope.add(bodyOf(shapes::sphere(0.01), {-1, 0.01, 0}));
        slope.run(static_cast<int>(rate), 1.0 / rate);
        CHECK(rigid(slope).velocities[0].x == Approx(5.0 / 7.0 * 9.81 * std::sin(0.2)).epsilon(1e-2));
    }
}

TEST_CASE("tissue bears a ball and a capsule by their weights, and none of it is inside them")
{
    for (const bool isBall : {true, false}) {
        CAPTURE(isBall);
        Stage stage = stageOnFloor();
        stage.add(physics::SoftBodyDef{.mesh = shapes::block({0.06, 0.03, 0.06}, {8, 4, 8}),
                                       .pose = {{0, 0.0151, 0}, {}},
                                       .material = physics::FemMaterial{.youngModulus = 5e3, .poissonRatio = 0.45},
                                       .mass = physics::TotalMass{1e-3},
                                       .collision = {{}}});
        physics::RigidBodyDef body = bodyOf(isBall ? shapes::sphere(0.01) : shapes::capsule(8e-3, 0.03), {0, 0.041, 0});
        if (!isBall) body.elements[0].orientation = axisAngle({0, 0, 1}, 0.5 * std::numbers::pi);
        body.mass = physics::TotalMass{0.1};
        stage.add(body);
        stage.run(1000, 1e-3);
        const Pose& at = rigid(stage).poses[0];
        CHECK(length(rigid(stage).velocities[0]) < 1e-3);
        CHECK(at.position.y > 0.02);
        Vec3 force;
        for (const frame::Contact& each : stage.world.scene().contactReports)
            if (each.second == BodyId{3} || each.first == BodyId{3})
                force += (each.first == BodyId{3} ? 1.0 : -1.0) * (each.normalForce * each.normal + each.friction);
        CHECK(force.y == Approx(0.981).epsilon(5e-3));
        for (const Vec3 x : stage.soft().x) {
            const Vec3 local = transform(inverse(at), x);
            const Vec3 off = isBall ? local : local - Vec3{0, std::clamp(local.y, -0.015, 0.015), 0};
            REQUIRE(length(off) > (isBall ? 0.01 : 8e-3) - 2e-4);
        }
    }
}

TEST_CASE("an open dome is no ball")
{
    const auto whole = shapes::sphere(0.01);
    geometry::TriangleMesh dome{.vertices = whole->vertices, .triangles = {}, .uv = {}};
    for (const geometry::Triangle& t : whole->triangles)
        if (whole->vertices[static_cast<std::size_t>(t[0])].y + whole->vertices[static_cast<std::size_t>(t[1])].y > 0.0)
            dome.triangles.push_back(t);
    Stage stage;
    physics::RigidBodyDef body = bodyOf(std::make_shared<const geometry::TriangleMesh>(std::move(dome)), {});
    body.dynamic = false;
    stage.add(body);
    stage.step(1e-3);
    CHECK(stage.world.scene().rigid[0].model.collision.size() == 1);
}

TEST_CASE("a ball that is attached in a block is not told to pass through it")
{
    Stage stage;
    physics::RigidBodyDef block = bodyOf(shapes::box({0.04, 0.04, 0.04}), {});
    const BodyId around = stage.add(block);
    physics::RigidBodyDef ball = bodyOf(shapes::sphere(0.01), {0, 0.021, 0}); // 9 mm deep
    ball.attachments = {{.to = around}};
    stage.add(ball);
    for (int i = 0; i < 40; ++i) CHECK(stage.step(1e-3).intersections.empty());
}

TEST_CASE("a blade, and a mesh of which only some primitives collide, have no exact shape")
{
    const auto modelsOf = [](const physics::CollisionDef& collision) {
        Stage stage;
        physics::RigidBodyDef body = bodyOf(shapes::sphere(0.01), {});
        body.collision = {collision};
        stage.add(body);
        stage.step(1e-3);
        return stage.world.scene().rigid[0].model.collision.size();
    };
    CHECK(modelsOf({}) == 2);
    CHECK(modelsOf({.primitives = {.lines = false}}) == 1);
    CHECK(modelsOf({.cutting = true}) == 1);
}

} // namespace round_bodies_test
