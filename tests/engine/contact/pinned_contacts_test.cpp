#include "filasofia/geometry/shapes.h"

#include "engine/stage.h"

namespace pinned_contacts_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;
namespace shapes = filasofia::geometry::shapes;

namespace {

constexpr double kStep = 1e-3;

/// A block of 20 x 20 x 5 mm, pinned in this box, and a cube of 4 mm beside it.
struct Driven {
    Stage stage;
    BodyId cube;
    Vec3 at; // its foremost edge is 2.6 mm before that, and 1.1 mm above

    explicit Driven(const geometry::Box& pins, Vec3 start = {-12.9e-3, 0, -3.4e-3}) : at(start)
    {
        SoftBodyDef block{.name = "block", .mesh = shapes::block({20e-3, 20e-3, 5e-3}, {5, 5, 1}), .gravity = false};
        block.material = FemMaterial{.youngModulus = 20e3, .poissonRatio = 0.45};
        block.collision = {{}};
        block.attachments = {{.box = pins}};
        stage.add(block);
        RigidBodyDef def{.name = "cube", .elements = {{at, axisAngle({0, 1, 0}, 0.4)}}};
        def.mesh = shapes::box({4e-3, 4e-3, 4e-3});
        def.collision = {{}};
        cube = stage.add(def);
        stage.run(2, kStep);
    }
    [[nodiscard]] double force()
    {
        double sum = 0.0;
        for (const auto& each : stage.world.scene().contactReports) sum += each.normalForce;
        return sum;
    }
    /// Moves the cube by this much along x [m], at 50 mm/s; the largest sum of forces.
    double drive(double way)
    {
        double most = 0.0;
        for (double done = 0.0; done < std::abs(way); done += 50e-3 * kStep) {
            at.x += std::copysign(50e-3 * kStep, way);
            stage.post(SetPose{cube, 0, {at, axisAngle({0, 1, 0}, 0.4)}});
            stage.step(kStep);
            most = std::max(most, force());
        }
        return most;
    }
};

const geometry::Box kAll{{-1, -1, -1}, {1, 1, 1}}, kBottom{{-1, -1, -1}, {1, 1, -2.4e-3}};

} // namespace

TEST_CASE("what is driven into tissue beside its pins feels a spring")
{
    Driven it(kBottom);
    const double most = it.drive(1.3e-3);
    CHECK(most > 0.1);
    CHECK(most < 100.0);
    it.stage.run(200, kStep);
    CHECK(it.force() > 0.1);
    CHECK(it.force() <= 1.01 * most);
}

TEST_CASE("pinned tissue pushes on what comes nearer, and goes on then, not on what overlaps it")
{
    Driven moved(kAll);
    CHECK(moved.force() == 0.0);
    const double most = moved.drive(1.1e-3);
    CHECK(most > 0.5);
    CHECK(most < 100.0);
    moved.stage.run(200, kStep);
    CHECK(moved.force() == Approx(most).epsilon(0.2));
    Driven stays(kAll, {-11.6e-3, 0, -3.4e-3});
    stays.stage.run(50, kStep);
    CHECK(stays.force() == 0.0);
    // Away only its side comes nearer to something: 1.1 N, as the corners of its front were pushed with 10.1 N.
    CHECK(stays.drive(-0.5e-3) < 0.15 * most);
}

} // namespace pinned_contacts_test
