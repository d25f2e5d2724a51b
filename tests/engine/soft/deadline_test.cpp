#include "engine/soft/hanging_bunny.h"

namespace deadline_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

TEST_CASE("a deadline that has passed ends every solve at the minimum of iterations, and no energy is gained")
{
    std::int64_t now = 10;
    const StepBudget budget{.now = [&] { return now; }, .deadline = 5};
    for (const auto& [dt, material] :
         {std::pair{0.001, FemMaterial{}}, std::pair{0.005, FemMaterial{}}, std::pair{0.005, FemMaterial{1e6, 0.49}}})
        for (int fewest : {1, 4}) {
            Stage stage = hangingBunny(756, material, dt, ConjugateGradient{.minIterations = fewest}, {0.0, 0.0});
            stage.step(0.0);
            const double before = mechanicalEnergy(stage);
            for (int i = 0; i < 300; ++i) {
                const StepReport report = stage.world.step({.dt = dt, .budget = &budget});
                REQUIRE(report.solves[0].iterations <= fewest);
                REQUIRE((report.flags & ~static_cast<std::uint32_t>(StepFlag::OutOfTime)) == 0);
                REQUIRE(mechanicalEnergy(stage) <= before + 1e-9 * std::abs(before));
            }
        }
}

TEST_CASE("a step that its deadline cut short is reproduced from the iterations it made")
{
    Stage cut = hangingBunny(1492, FemMaterial{}, 0.005), again = hangingBunny(1492, FemMaterial{}, 0.005);
    cut.step(0.005);
    again.step(0.005);
    int asked = 0, cuts = 0;
    for (int i = 0; i < 30; ++i) {
        asked = 0;
        const StepBudget budget{.now = [&] { return std::int64_t{++asked}; }, .deadline = 5 + i % 4};
        const StepReport report = cut.world.step({.dt = 0.005, .budget = &budget});
        cuts += report.has(StepFlag::OutOfTime);
        const StepBudget replay{.iterations = {report.solves[0].iterations}};
        again.world.step({.dt = 0.005, .budget = &replay});
        REQUIRE(cut.world.hash() == again.world.hash());
    }
    CHECK(cuts > 10);
}

TEST_CASE("bodies share a deadline by their size, so the first leaves enough time for the last")
{
    Stage stage({.period = 0.005, .threads = 1});
    for (int k = 0; k < 3; ++k)
        stage.add(SoftBodyDef{.mesh = bunnyFile(1492),
                              .solver = ConjugateGradient{.tolerance = 1e-5, .minIterations = 0},
                              .attachments = {{.box = geometry::Box{{-1, 0.105, -1}, {1, 1, 1}}}}});
    stage.post(SetGravity{{0, -9.81, 0}});
    stage.run(20, 0.005);
    std::int64_t now = 0; // each read of the clock counts one, and so does each iteration
    const StepBudget budget{.now = [&] { return ++now; }, .deadline = 24};
    const StepReport report = stage.world.step({.dt = 0.005, .budget = &budget});
    REQUIRE(report.has(StepFlag::OutOfTime));
    for (const BodySolve& solve : report.solves) CHECK(solve.iterations >= 4);
    CHECK(std::abs(report.solves[0].iterations - report.solves[2].iterations) <= 2);
}

TEST_CASE("a free body whose solves are all cut short falls and rotates correctly")
{
    Stage cut({.period = 0.005, .threads = 1}), exact;
    for (Stage* stage : {&cut, &exact}) {
        const Solver solver =
            stage == &cut ? Solver{ConjugateGradient{.maxIterations = 2, .tolerance = 1e-9}} : Solver{Cholesky{}};
        stage->add(SoftBodyDef{.mesh = bunnyFile(1492), .solver = solver});
        stage->post(SetGravity{{0, -9.81, 0}});
        stage->step(0.0);
        for (std::size_t i = 0; i < stage->soft().x.size(); ++i)
            stage->soft().v[i] = cross({0, 2, 0}, stage->soft().x[i]) + Vec3{0.5, 0, 0};
        stage->run(200, 0.005);
    }
    const auto motion = [](Stage& stage) { // per mass: momentum and angular momentum
        Vec3 linear, centre, angular;
        double mass = 0.0;
        const auto& [x, v] = std::tie(stage.soft().x, stage.soft().v);
        for (std::size_t i = 0; i < x.size(); ++i) {
            mass += stage.model().masses[i];
            linear += stage.model().masses[i] * v[i];
            centre += stage.model().masses[i] * x[i];
        }
        for (std::size_t i = 0; i < x.size(); ++i)
            angular += stage.model().masses[i] * cross(x[i] - 1.0 / mass * centre, v[i]);
        return std::pair{1.0 / mass * linear, 1.0 / mass * angular};
    };
    const auto [linear, angular] = motion(exact);
    CHECK(length(motion(cut).first - linear) < 0.02 * length(linear));
    CHECK(length(motion(cut).second - angular) < 0.1 * length(angular));
}

} // namespace deadline_test
