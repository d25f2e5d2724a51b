#include "engine/stage.h"

#include "filasofia/geometry/shapes.h"

#include <algorithm>

namespace trapped_test {

using namespace filasofia;
using namespace filasofia::engine;

// Rigid bodies between or on kinematic ones, alone and with tissue in the same island: the penalties differ, and so do
// the ways in which the carried impulses grow and go.
namespace {

physics::RigidBodyDef block(Vec3 size, Vec3 at, double mass)
{
    return {.elements = {{at, {}}},
            .mesh = geometry::shapes::box(size),
            .dynamic = mass > 0.0,
            .mass = physics::TotalMass{mass > 0.0 ? mass : 1.0},
            .collision = {{}}};
}

void addFloor(Stage& stage)
{
    stage.post(physics::SetGravity{{0, -9.81, 0}});
    stage.add(block({0.6, 0.02, 0.6}, {0, -0.01, 0}, 0.0));
}

void addOrgan(Stage& stage, double x)
{
    stage.add(physics::SoftBodyDef{.mesh = geometry::shapes::block({0.05, 0.03, 0.05}, {6, 4, 6}),
                                   .pose = {{x, 0.0152, 0}, {}},
                                   .material = physics::FemMaterial{.youngModulus = 10e3, .poissonRatio = 0.45},
                                   .collision = {{}}});
}

} // namespace

TEST_CASE("a plate that is pressed on a floor and on tissue stays above the floor")
{
    constexpr Vec3 size{0.15, 0.01, 0.15};
    for (const double press : {1.0, 20.0}) {
        Stage stage;
        addFloor(stage);
        addOrgan(stage, 0.0);
        const BodyId plate = stage.add(block(size, {0.05, 0.038, 0}, 0.2));
        stage.run(300, 1e-3);
        stage.post(physics::SetWrench{.id = plate, .force = {0, -press, 0}});
        double lowest = 1.0;
        std::uint32_t flags = 0;
        for (int i = 0; i < 700; ++i) {
            flags |= stage.step(1e-3).flags;
            const Pose& pose = stage.world.scene().rigid[1].state.poses[0];
            for (const double x : {-0.5, 0.5})
                for (const double z : {-0.5, 0.5})
                    lowest = std::min(lowest, transform(pose, {x * size.x, -0.5 * size.y, z * size.z}).y);
        }
        CAPTURE(press);
        CHECK(lowest > -0.1e-3); // at 20 N, it was 10 mm after 0.05 s, and the plate turned into the floor
        CHECK((flags & static_cast<std::uint32_t>(physics::StepFlag::Intersecting)) == 0);
    }
}

TEST_CASE("a bar that is jammed beside tissue is held by as much as without it, and let go without a jolt")
{
    std::array<double, 2> held = {};
    for (const bool beside : {false, true}) {
        Stage stage;
        addFloor(stage);
        const BodyId jaw = stage.add(block({0.02, 0.02, 0.02}, {0, 0.0202, 0}, 0.0));
        stage.add(block({0.06, 0.01, 0.02}, {0, 0.0051, 0}, 0.03));
        if (beside) addOrgan(stage, 0.055);
        stage.run(100, 1e-3);
        const auto moveTo = [&](double y) { stage.post(physics::SetPose{.id = jaw, .pose = {{0, y, 0}, {}}}); };
        for (int i = 1; i <= 500; ++i) {
            moveTo(0.0202 - 0.7e-3 * i / 500); // half a millimetre too little room
            stage.step(1e-3);
        }
        stage.run(500, 1e-3);
        frame::Frame frame;
        stage.world.capture(frame);
        for (const frame::Contact& contact : frame.contacts)
            if (contact.first == jaw || contact.second == jaw) held[beside ? 1 : 0] += contact.normalForce;
        moveTo(0.04);
        double fastest = 0.0;
        for (int i = 0; i < 50; ++i) {
            stage.step(1e-3);
            fastest = std::max(fastest, length(stage.world.scene().rigid[2].state.velocities[0]));
        }
        CAPTURE(beside);
        CHECK(fastest < 0.15); // 0.56 m/s alone and 5.4 beside tissue, if the impulse of the jam acts in the first step
    }
    CHECK(held[0] > 500.0);
    CHECK(std::abs(held[1] - held[0]) < 0.05 * held[0]);
}

TEST_CASE("tissue that jaws with sharp edges squeeze comes to rest, whatever its stiffness and the rate")
{
    // It shook for ever when only the nearest of the edges that cross the jaws' edges were contacts, others in each
    // step.
    for (const double young : {2e3, 20e3, 200e3})
        for (const double rate : {250.0, 1000.0}) {
            Stage stage;
            addFloor(stage);
            stage.add(physics::SoftBodyDef{.mesh = geometry::shapes::block({0.016, 0.02, 0.023}, {3, 4, 4}),
                                           .pose = {{0, 0.0131, 0}, {}},
                                           .material = physics::FemMaterial{.youngModulus = young, .poissonRatio = 0.4},
                                           .rayleigh = {.mass = 5.0},
                                           .collision = {{}}});
            std::array<BodyId, 2> jaws;
            for (const std::size_t k : {0u, 1u})
                jaws[k] = stage.add(block({0.0045, 0.009, 0.018}, {k == 0 ? -0.02 : 0.02, 0.0075, 0}, 0.0));
            std::vector<physics::StepReport> last;
            for (int i = 0; i < 3.0 * rate; ++i) {
                const double closed = std::min(1.0, i / (0.2 * rate));
                for (const std::size_t k : {0u, 1u}) {
                    const double x = 0.02 + (0.0068 - 0.02) * closed;
                    stage.post(physics::SetPose{jaws[k], 0, {{k == 0 ? -x : x, 0.0075, 0}, {}}});
                }
                const physics::StepReport report = stage.step(1.0 / rate);
                if (i >= 2.9 * rate) last.push_back(report);
            }
            double fastest = 0.0;
            for (const Vec3 v : stage.soft().v) fastest = std::max(fastest, length(v));
            CAPTURE(young, rate);
            CHECK(fastest < 1e-3); // 0.13 m/s at 2 kPa
            for (const physics::StepReport& report : last) CHECK(report.flags == 0);
            for (const physics::StepReport& report : last) CHECK(report.solves.front().iterations <= 10);
        }
}

} // namespace trapped_test
