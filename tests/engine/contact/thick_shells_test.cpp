#include "filasofia/geometry/shapes.h"

#include "engine/sheets.h"
#include "engine/stage.h"

namespace thick_shells_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

constexpr double kProximity = 0.5e-3, kThickness = 0.8e-3; // [m]

RigidBodyDef floorBelow()
{
    return {.elements = {Pose{{0, 0, -0.01}, {}}},
            .mesh = geometry::shapes::box({0.3, 0.3, 0.02}),
            .collision = {{.proximity = kProximity}}};
}

/// A square sheet of 6 cm at a height, not quite above its like.
SoftBodyDef sheetAt(double z, double aside = 0.0)
{
    return {.mesh = shared(sheetMesh({12, 12}, 0.06, 0.06)),
            .pose = {{-0.03 + aside, -0.03 + 0.4 * aside, z}, {}},
            .material = ShellMaterial{.youngModulus = 1e5, .thickness = kThickness},
            .rayleigh = {0.5, 0.01},
            .collision = {{.proximity = kProximity}}};
}

/// A closed shell of 1 cm.
SoftBodyDef ballAboveFloor()
{
    return {.mesh = geometry::shapes::sphere(0.01, 6),
            .pose = {{0, 0, 0.0115}, {}},
            .material = ShellMaterial{.youngModulus = 1e6, .thickness = kThickness},
            .rayleigh = {0.5, 0.01},
            .collision = {{.proximity = kProximity}}};
}

} // namespace

TEST_CASE("shells rest on a floor and on each other as thick as they are")
{
    Stage stage({.period = 0.002, .threads = 1});
    stage.add(floorBelow());
    stage.add(sheetAt(1e-3));
    stage.add(sheetAt(3e-3, 1.3e-3));
    stage.post(SetGravity{{0, 0, -9.81}});
    CHECK_FALSE(stage.run(500, 0.002).has(StepFlag::Intersecting));
    // A contact keeps surfaces apart by a hundredth of both proximities at most.
    constexpr double apart = 0.01 * 2.0 * kProximity;
    for (const Vec3& x : stage.soft(0).x) CHECK(std::abs(x.z - 0.5 * kThickness) < 2.0 * apart);
    for (std::size_t i = 0; i < stage.soft(1).x.size(); ++i) {
        const Vec3 x = stage.soft(1).x[i];
        if (std::max(std::abs(x.x), std::abs(x.y)) > 0.028) continue; // beyond the rim of the other
        CHECK(std::abs(x.z - 1.5 * kThickness) < 4.0 * apart);
    }
}

TEST_CASE("a closed shell rests on a floor as thick as it is")
{
    Stage stage({.period = 0.002, .threads = 1});
    stage.add(floorBelow());
    stage.add(ballAboveFloor());
    stage.post(SetGravity{{0, 0, -9.81}});
    stage.run(1000, 0.002);
    double lowest = 1.0;
    for (const Vec3& x : stage.soft().x) lowest = std::min(lowest, x.z);
    CHECK(std::abs(lowest - 0.5 * kThickness) < 0.04 * kProximity);
}

TEST_CASE("a closed shell is touched from inside, too")
{
    Stage stage({.period = 0.002, .threads = 1});
    stage.add(floorBelow());
    stage.add(ballAboveFloor());
    constexpr double radius = 0.004;
    stage.add(RigidBodyDef{.elements = {Pose{{0, 0, 0.0115}, {}}},
                           .mesh = geometry::shapes::sphere(radius, 8),
                           .dynamic = true,
                           .mass = TotalMass{1e-3},
                           .collision = {{.proximity = kProximity}}});
    stage.post(SetGravity{{0, 0, -9.81}});
    CHECK_FALSE(stage.run(1000, 0.002).has(StepFlag::Intersecting));
    // It lies in the shell, which stands on the floor, both half as thick as the shell away.
    const double height = stage.world.scene().rigid[1].state.poses[0].position.z;
    CHECK(height > kThickness + radius - 0.1 * kProximity);
    CHECK(height < kThickness + radius + 3.0 * kProximity);
    double lowest = 1.0;
    for (const Vec3& x : stage.soft().x) lowest = std::min(lowest, x.z);
    CHECK(std::abs(lowest - 0.5 * kThickness) < 0.1 * kProximity);
}

TEST_CASE("a cloth that slides down a ball is not pressed into it by contacts on the wrong side of its folds")
{
    Stage stage({.period = 0.001, .threads = 1});
    const Vec3 middle{0, 0.3, 0};
    stage.add(RigidBodyDef{
        .elements = {{middle, {}}}, .mesh = geometry::shapes::sphere(0.15), .collision = {{}}, .friction = 1});
    stage.add(SoftBodyDef{.mesh = geometry::shapes::sheet(0.6, 0.6, {20, 20}),
                          .pose = {{0, 0.5, 0}, {}},
                          .material = ShellMaterial{.youngModulus = 1e5, .poissonRatio = 0.2, .thickness = 2e-3},
                          .mass = TotalMass{0.3},
                          .rayleigh = {0.0, 1e-3},
                          .collision = {{}},
                          .friction = 1});
    stage.post(SetGravity{{0, -9.81, 0}});
    double inwards = 0.0, deepest = 0.0, largest = 0.0; // [N], [m], [N] on the cloth
    for (int i = 0; i < 800; ++i) {
        stage.step(0.001);
        double all = 0.0;
        for (const frame::Contact& each : stage.world.scene().contactReports) {
            const Vec3 onCloth = each.normal * (each.first == BodyId{2} ? each.normalForce : -each.normalForce);
            inwards = std::max(inwards, dot(onCloth, normalized(middle - each.point)));
            deepest = std::max(deepest, -each.gap);
            all += each.normalForce;
        }
        largest = std::max(largest, all);
    }
    INFO(inwards << " N, " << deepest << " m, " << largest << " N");
    CHECK(inwards < 0.1);  // was 24
    CHECK(deepest < 1e-3); // was 3.1 mm
    CHECK(largest < 40.0); // the cloth weighs 2.9 N
}

} // namespace thick_shells_test
