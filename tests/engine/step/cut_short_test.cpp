// A deadline that ends the solve of touching bodies early in every step must not change their forces.
#include "engine/stage.h"

#include "filasofia/geometry/shapes.h"

namespace cut_short_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

/// [N] Force on a ball in every step while it is pressed 6 mm into a block and drawn 8 mm across it. The clock ticks
/// `ticks` times before the deadline.
std::vector<double> pokeForces(std::int64_t ticks)
{
    Stage stage;
    stage.add(physics::SoftBodyDef{.mesh = shared(boxMesh({10, 5, 10}, {0.1, 0.05, 0.1})),
                                   .material = physics::FemMaterial{.youngModulus = 8e3, .poissonRatio = 0.45},
                                   .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1e-6, 1}}}},
                                   .collision = {{}}});
    const auto at = [](double way) {
        return Pose{Vec3{0.046 + std::max(0.0, way - 0.006), 0.0601 - std::min(way, 0.006), 0.053}, {}};
    };
    const BodyId ball = stage.add(
        physics::RigidBodyDef{.elements = {at(0.0)}, .mesh = geometry::shapes::sphere(0.01), .collision = {{}}});
    std::int64_t clock = 0;
    std::vector<double> forces;
    for (int i = 1; i <= 280; ++i) {
        stage.post(physics::SetPose{ball, 0, at(5e-5 * i)});
        const physics::StepBudget budget{.now = [&] { return ++clock; }, .deadline = clock + ticks};
        stage.world.step({.dt = 1e-3, .commands = stage.commands, .budget = &budget});
        stage.commands.clear();
        double force = 0.0;
        for (const frame::Contact& contact : stage.world.scene().contactReports) force += contact.normalForce;
        forces.push_back(force);
    }
    return forces;
}

} // namespace

TEST_CASE("a contact that runs out of time in every step keeps its force")
{
    const std::vector<double> whole = pokeForces(1'000'000), cut = pokeForces(1);
    const double largest = *std::ranges::max_element(whole);
    CHECK(largest > 0.2);
    for (std::size_t i = 0; i < whole.size(); ++i) CHECK(std::abs(cut[i] - whole[i]) < 0.05 * largest);
}

} // namespace cut_short_test
