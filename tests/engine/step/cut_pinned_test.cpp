#include "filasofia/geometry/shapes.h"

#include "engine/stage.h"

#include <random>

namespace cut_pinned_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;
namespace shapes = filasofia::geometry::shapes;

namespace {

Vec3 randomDirection(std::mt19937& random)
{
    std::normal_distribution<double> number;
    const double x = number(random), y = number(random);
    return normalized(Vec3{x, y, number(random)});
}

} // namespace

// Edges of both lips that begin at a node that is pinned meet beside it, and hardly move there. They pushed with up to
// 3e9 N, and seven of eight such cuts ended inside out.
TEST_CASE("cuts through pinned tissue at any angle are calm, and their lips push with what the tissue can bear")
{
    constexpr double kStep = 1e-3, kSpeed = 0.2;
    const Vec3 half{20e-3, 10e-3, 10e-3};
    const double size = 2.0 * length(half);
    for (const unsigned seed : {1U, 2U, 3U, 4U, 5U, 6U}) {
        CAPTURE(seed);
        std::mt19937 random(seed);
        Stage stage;
        SoftBodyDef block{.name = "block", .mesh = shapes::block(2.0 * half, {8, 4, 4}), .gravity = false};
        block.material = FemMaterial{.youngModulus = 20e3, .poissonRatio = 0.45};
        block.dynamicTopology = true;
        block.collision = {{}};
        block.attachments = {{.box = geometry::Box{{-1, -1, -1}, {-half.x + 6e-3, 1, 1}}}};
        stage.add(block);
        // A sheet that goes through all of the block, near where it is pinned.
        const Vec3 normal = randomDirection(random), ahead = normalized(cross(normal, randomDirection(random)));
        const Vec3 along = cross(normal, ahead);
        const Vec3 from = Vec3{-12e-3, 0, 0} + 0.03 * size * randomDirection(random) - 0.7 * size * ahead;
        geometry::TriangleMesh sheet;
        for (const double back : {0.0, -0.4})
            for (const double side : {-0.7, 0.7}) sheet.vertices.push_back(size * (side * along + back * ahead));
        sheet.triangles = {{0, 1, 3}, {0, 3, 2}};
        RigidBodyDef blade{.name = "blade", .elements = {{from, {}}}};
        blade.collision = {{.mesh = std::make_shared<const geometry::TriangleMesh>(sheet), .cutting = true}};
        const BodyId knife = stage.add(blade);
        std::uint32_t flags = stage.run(10, kStep).flags;
        double most = 0.0; // [N]
        std::size_t met = 0, cuts = 0;
        for (double way = 0.0; way < 1.9 * size; way += kSpeed * kStep) {
            stage.post(SetPose{knife, 0, {from + way * ahead, {}}});
            const StepReport report = stage.step(kStep);
            flags |= report.flags;
            cuts += report.topology.ruptures.size();
            for (const auto& each : stage.world.scene().contactReports) {
                most = std::max(most, each.normalForce);
                met += each.normalForce > 0.0 ? 1 : 0;
            }
        }
        CHECK(flags == 0);
        CHECK(invertedElements(stage.model(), stage.soft()) == 0);
        CHECK(most < 1.0);
        CHECK(met > 100);
        CHECK(cuts > 10);
    }
}

} // namespace cut_pinned_test
