#include "engine/rigid/rigid_bodies.h"

#include <functional>
#include <limits>

namespace rigid_check_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::string refusalOf(const RigidBodyDef& def)
{
    try {
        static_cast<void>(World({.threads = 1}).build(def));
    } catch (const Error& error) {
        return error.what();
    }
    return "accepted";
}

std::string checkOf(Stage& stage)
{
    try {
        check(stage.world.scene().rigid[0].model, stage.world.scene().rigid[0].state);
    } catch (const Error& error) {
        return error.what();
    }
    return "accepted";
}

} // namespace

TEST_CASE("the hash covers every number of a dynamic body, and the poses of a kinematic one")
{
    Stage stage;
    stage.add(boxBody());
    stage.add(RigidBodyDef{});
    stage.run(3, 0.01);
    const std::uint64_t before = stage.world.hash();
    const auto changes = [&](double& number) {
        const double old = number;
        number += 1.0;
        const bool changed = stage.world.hash() != before;
        number = old;
        return changed;
    };
    RigidState &box = rigidState(stage, 0), &kinematic = rigidState(stage, 1);
    for (int axis = 0; axis < 3; ++axis) {
        CHECK(changes((&box.poses[0].position.x)[axis]));
        CHECK(changes((&box.velocities[0].x)[axis]));
        CHECK(changes((&box.angularVelocities[0].x)[axis]));
        CHECK(changes((&box.wrenches[0].force.x)[axis]));
        CHECK(changes((&box.wrenches[0].torque.x)[axis]));
        CHECK(changes((&kinematic.poses[0].position.x)[axis]));
    }
    CHECK_FALSE(changes(kinematic.velocities[0].x)); // no result depends on it
}

TEST_CASE("a rigid body whose numbers allow no step is refused when built")
{
    CHECK(refusalOf(boxBody()) == "accepted");
    RigidBodyDef def = boxBody();
    geometry::TriangleMesh mesh = *boxSurface(kBoxSize);
    mesh.triangles.pop_back();
    def.mesh = std::make_shared<const geometry::TriangleMesh>(mesh);
    CHECK_THAT(refusalOf(def),
               Catch::Contains("rigid body 'box': mesh: must be a closed surface; the edge between vertices") &&
                   Catch::Contains("'filasofia mesh FILE -o NAME.msh --parts FOLDER' repairs it"));
    def.dynamic = false; // nobody asks for its inertia
    CHECK(refusalOf(def) == "accepted");
    def = boxBody();
    def.mass = Density{1e-320};
    CHECK_THAT(refusalOf(def), Catch::Contains("rigid body 'box': inertias[0].mass must be > 0 kg"));
    CHECK_THAT(refusalOf(tumbling({1e-30, 1e-4, 1e-4}, {})), Catch::Contains("inertia must be > 0 about every axis"));
    CHECK_THAT(refusalOf(tumbling({1e-320, 1e-320, 1e-320}, {})), Catch::Contains("inertia must be > 0 kg m^2"));
}

TEST_CASE("a changed rigid model or state is checked as if it had just been built")
{
    using Change = std::function<void(RigidModel&, RigidState&)>;
    const std::pair<Change, const char*> wrong[] = {
        {[](auto& m, auto&) { m.inertias.pop_back(); }, "inertias must have 1 entries, got 0"},
        {[](auto& m, auto&) { m.inertias[0].mass = 0; }, "inertias[0].mass must be > 0 kg, got 0"},
        {[](auto& m, auto&) { m.inertias[0].centre.y = kNan; }, "inertias[0].centre must lie within"},
        {[](auto& m, auto&) { m.inertias[0].inertia[0].y = 1; }, "inertias[0].inertia must be symmetric"},
        {[](auto& m, auto&) {
             m.inertias[0].inertia = Mat3::diagonal({1, 1, 2.1});
         },
         "sum of the other two"},
        {[](auto& m, auto&) {
             m.inertias[0].inertia = Mat3::diagonal({-1, 1, 1});
         },
         "must be > 0 about every axis"},
        {[](auto& m, auto&) { m.linearDamping = -1; }, "linearDamping must be >= 0, got -1"},
        {[](auto& m, auto&) { m.angularDamping = kNan; }, "angularDamping must be >= 0, got nan"},
        {[](auto& m, auto&) { m.friction = -0.1; }, "friction must be >= 0, got -0.1"},
        {[](auto& m, auto&) { m.startVelocity.x = 1e5; }, "velocities must be < 10000 m/s"},
        {[](auto&, auto& s) { s.velocities[0].x = kNan; }, "velocities must be < 10000 m/s"},
        {[](auto&, auto& s) { s.angularVelocities[0].x = 1e5; }, "velocities must be < 10000 m/s"},
        {[](auto&, auto& s) { s.velocities.clear(); }, "velocities must have 1 entries, got 0"},
        {[](auto&, auto& s) { s.angularVelocities.clear(); }, "angularVelocities must have 1 entries, got 0"},
        {[](auto&, auto& s) { s.wrenches.clear(); }, "wrenches must have 1 entries, got 0"},
        {[](auto&, auto& s) { s.wrenches[0].torque.z = kNan; }, "wrenches must be finite"},
        {[](auto&, auto& s) { s.targets.clear(); }, "targets must have 1 entries, got 0"},
        {[](auto&, auto& s) { s.targets[0] = Pose{}; }, "a dynamic body has no targets"},
        {[](auto&, auto& s) {
             s.targets[0] = Pose{{kNan, 0, 0}, {}};
         },
         "poses must be finite"},
        {[](auto&, auto& s) { s.poses[0].orientation.w = 2; }, "unit quaternion"},
    };
    for (const auto& [change, says] : wrong) {
        Stage stage;
        stage.add(boxBody());
        stage.step(0.01);
        REQUIRE(checkOf(stage) == "accepted");
        change(stage.world.scene().rigid[0].model, rigidState(stage));
        CHECK_THAT(checkOf(stage), Catch::Contains("rigid body 'box'") && Catch::Contains(says));
    }
}

} // namespace rigid_check_test
