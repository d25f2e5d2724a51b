#include "engine/sheets.h"
#include "engine/stage.h"

#include <numbers>

namespace part_crossings_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

SoftBodyDef block(Vec3 at, Quat turn = {}, double young = 5e3)
{
    return {.mesh = shared(boxMesh({3, 3, 3}, {0.02, 0.02, 0.02})),
            .pose = {at, turn},
            .material = FemMaterial{.youngModulus = young, .poissonRatio = 0.4},
            .rayleigh = {0.5, 0.01},
            .gravity = false,
            .collision = {{}}};
}

SoftBodyDef sheet(const Pose& pose)
{
    return {.mesh = shared(sheetMesh({8, 8}, 0.04, 0.04)),
            .pose = pose,
            .material = ShellMaterial{.youngModulus = 1e5, .thickness = 0.4e-3},
            .rayleigh = {0.5, 0.01},
            .gravity = false,
            .collision = {{}}};
}

struct Course {
    int crossing = 0;     ///< steps in which surfaces passed through each other
    bool crosses = false; ///< in the last step
    double fastest = 0.0; ///< [m/s] the highest speed of a node
    double drift = 0.0;   ///< [m/s] the largest velocity of the common centre of mass
};
Course run(Stage& stage, int steps)
{
    Course course;
    for (int i = 0; i < steps; ++i) {
        const StepReport report = stage.step(1e-3);
        course.crosses = report.has(StepFlag::Intersecting);
        course.crossing += course.crosses ? 1 : 0;
        Vec3 momentum;
        double mass = 0.0;
        for (std::size_t body = 0; body < stage.world.scene().soft.size(); ++body)
            for (std::size_t n = 0; n < stage.soft(body).v.size(); ++n) {
                course.fastest = std::max(course.fastest, length(stage.soft(body).v[n]));
                momentum += stage.model(body).masses[n] * stage.soft(body).v[n];
                mass += stage.model(body).masses[n];
            }
        course.drift = std::max(course.drift, length(momentum) / mass);
    }
    return course;
}

const Quat kUpright{std::numbers::sqrt2 / 2.0, std::numbers::sqrt2 / 2.0, 0.0, 0.0}; // a sheet in the xz plane

} // namespace

TEST_CASE("two blocks of tissue whose corners start in each other part, slowly, and keep their momentum")
{
    for (const Vec3 overlap : {Vec3{3e-3, 4e-3, 5e-3}, Vec3{8e-3, 2e-3, 6e-3}}) {
        Stage stage;
        stage.add(block({}));
        stage.add(block(Vec3{0.02, 0.02, 0.02} - overlap, axisAngle({1, 2, 3}, 0.2)));
        stage.step(0.0);
        const Course course = run(stage, 600);
        INFO("overlap " << 1e3 * overlap.x << " mm");
        CHECK(course.crossing > 20);
        CHECK_FALSE(course.crosses);
        CHECK(course.fastest < 0.5);
        CHECK(course.drift < 1e-5);
    }
}

TEST_CASE("two bars of tissue that cross each other without a vertex inside part")
{
    Stage stage;
    SoftBodyDef def = block({});
    def.mesh = shared(boxMesh({6, 1, 1}, {0.06, 0.006, 0.006}));
    stage.add(def);
    def.pose = {{0.028, 0.0035, -0.025}, axisAngle({0, 1, 0}, -0.5 * std::numbers::pi)};
    stage.add(def);
    stage.step(0.0);
    const Course course = run(stage, 800);
    CHECK(course.crossing > 5);
    CHECK_FALSE(course.crosses);
    CHECK(course.fastest < 0.5);
}

TEST_CASE("a sheet that has passed through another is drawn out of it, to the side where more of it is")
{
    for (const double below : {5e-3, 35e-3}) {
        Stage stage;
        stage.add(sheet({{-0.02, -0.02, 0.0}, {}}));
        stage.add(sheet({{-0.0177, 0.0013, -below}, kUpright}));
        stage.step(0.0);
        const Course course = run(stage, 1500);
        INFO(below);
        CHECK(course.crossing > 20);
        CHECK_FALSE(course.crosses);
        double centre = 0.0;
        for (std::size_t n = 0; n < 81; ++n) centre += (stage.soft(1).x[n].z - stage.soft(0).x[n].z) / 81.0;
        CHECK((centre > 0.0) == (below < 0.02));
    }
}

TEST_CASE("surfaces that part do so with the same bits for any number of threads, and after a saved state")
{
    std::vector<std::vector<Vec3>> results;
    for (const int threads : {1, 2, 5}) {
        Stage stage({.threads = threads});
        stage.add(block({}));
        stage.add(block({0.013, 0.017, 0.014}, axisAngle({1, 2, 3}, 0.2)));
        stage.step(0.0);
        run(stage, 40);
        const auto before = stage.world.save();
        CHECK(run(stage, 20).crossing > 0);
        results.push_back(stage.soft(1).x);
        stage.world.restore(*before);
        run(stage, 20);
        results.push_back(stage.soft(1).x);
    }
    for (const std::vector<Vec3>& each : results) CHECK(each == results.front());
}

} // namespace part_crossings_test
