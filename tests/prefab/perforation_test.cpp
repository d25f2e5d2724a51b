#include "filasofia/prefab/perforation.h"

#include "filasofia/core/error.h"
#include "filasofia/core/units.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/prefab/endoscope.h"
#include "filasofia/prefab/overlays.h"
#include "filasofia/runtime/stepped_run.h"

#include <catch2/catch.hpp>

namespace perforation_test {

using namespace filasofia;
using namespace filasofia::prefab;
using runtime::Simulation;
namespace shapes = geometry::shapes;

namespace {

/// A wall 10 mm thick on a rigid floor, and a kinematic rod above it whose end is at height(time).
struct Scene {
    explicit Scene(bool touching = true)
    {
        wall = sim.add(physics::SoftBodyDef{
            .name = "wall",
            .mesh = shapes::block({40_mm, 10_mm, 40_mm}, {6, 2, 6}),
            .material = physics::FemMaterial{.youngModulus = 20_kPa, .poissonRatio = 0.4},
            .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, -4.9_mm, 1}}}},
            .collision = touching ? std::vector<physics::CollisionDef>{{}} : std::vector<physics::CollisionDef>{}});
        rod = sim.add(physics::RigidBodyDef{
            .name = "rod", .elements = {{{0, 30_mm, 0}}}, .mesh = shapes::capsule(3_mm, 20_mm), .collision = {{}}});
    }
    PerforationWatch watch(PerforationDef def)
    {
        def.wall = wall;
        def.tools = {{.body = rod, .tip = {0, -12_mm, 0}}}; // 1 mm behind its end
        def.perforated = [this](Vec3 place, double force) { perforations.emplace_back(place, force); };
        return {sim, def};
    }
    void run(const std::function<double(double)>& height, int steps)
    {
        sim.everyStep([=, this](double time) { sim.physics().setPose(rod, {{0, height(time) + 13_mm, 0}}); });
        sim.run({.headless = true, .backend = visual::Backend::Null, .steps = steps});
    }

    Simulation sim;
    BodyId wall, rod;
    std::vector<std::pair<Vec3, double>> perforations;
};

} // namespace

TEST_CASE(
    "a tool that presses harder than the wall stands has perforated it: once, until it was away for half a second")
{
    Scene scene;
    const PerforationWatch watch = scene.watch({.force = 0.5});
    // From 8 mm (the wall's top is at 5 mm) down to 1 mm within 50 ms; away from 0.4 to 1.1 s; then again.
    scene.run(
        [](double time) {
            const double in = std::clamp(std::min(time - 0.1, 0.4 - time) / 0.05, 0.0, 1.0);
            const double again = std::clamp((time - 1.1) / 0.05, 0.0, 1.0);
            return 8_mm - (in + again) * 7_mm;
        },
        1400);
    REQUIRE(scene.perforations.size() == 2);
    CHECK(watch.count() == 2);
    CHECK(scene.perforations[0].second > 0.5);
    CHECK(scene.perforations[0].first.y == Approx(3_mm).margin(2.1_mm)); // at the rod's end
}

TEST_CASE("a touch is no perforation")
{
    Scene scene;
    const PerforationWatch watch = scene.watch({.force = 50.0});
    scene.run([](double time) { return 8_mm - std::min(time, 0.2) * 20_mm; }, 400); // 1 mm deep
    CHECK(scene.perforations.empty());
    CHECK(watch.count() == 0);
}

TEST_CASE("a tip inside the tissue has perforated it, whatever the force")
{
    Scene scene(false);
    const PerforationWatch watch = scene.watch({.force = 1e3});
    scene.run([](double time) { return 8_mm - std::min(time, 0.5) * 16_mm; }, 500); // its end comes to 0
    REQUIRE(scene.perforations.size() == 1);
    CHECK(scene.perforations[0].first.y == Approx(5_mm).margin(0.2_mm)); // detected as the watched point enters
    CHECK(scene.perforations[0].second == 0.0);
}

TEST_CASE("a tracker notes a perforation, with its force")
{
    Scene scene(false);
    MetricTrackerDef observed{.bodies = {{.body = scene.rod}}, .keep = true};
    observed.session.watched = {metric::EventKind::Perforation};
    MetricTracker tracker(scene.sim, observed);
    const PerforationWatch watch = scene.watch({.tracker = &tracker});
    scene.run([](double) { return 0.0; }, 20);
    tracker.close();
    REQUIRE(tracker.session().events.size() == 1);
    CHECK(tracker.session().events[0].kind == metric::EventKind::Perforation);
    CHECK(tracker.session().events[0].amount == 0.0);
}

TEST_CASE("perforations, force bars and scopes go back with a saved state")
{
    Scene scene;
    const PerforationWatch watch = scene.watch({.force = 0.5});
    const ForceBar bar(scene.sim, {.bodies = {scene.wall}, .warning = 0.1});
    Endoscope scope(scene.sim, {.groups = {}});
    const auto down = [](double time) { return 8_mm - 7_mm * std::clamp((time - 0.05) / 0.05, 0.0, 1.0); };
    scene.sim.everyStep([&](double time) { scene.sim.physics().setPose(scene.rod, {{0, down(time) + 13_mm, 0}}); });
    runtime::SteppedRun run(scene.sim);
    const auto seen = [&](int steps) {
        std::string out;
        for (int i = 0; i < steps; ++i) {
            scope.roll(scope.tip().orientation.z + 1e-3);
            run.step();
            out += text(watch.count(), ' ', bar.force(), ' ', bar.highest(), ' ', bar.warnings(), ' ',
                        scope.tip().orientation.z, '\n');
        }
        return out;
    };
    seen(50);
    const auto state = run.save();
    const std::string first = seen(150);
    CHECK(watch.count() == 1);
    CHECK(bar.warnings() == 1);
    run.restore(*state);
    CHECK(watch.count() == 0);
    CHECK(seen(150) == first);
}

TEST_CASE("a wrong perforation Def is refused with its field")
{
    Scene scene;
    const auto make = [&](const PerforationDef& def) { PerforationWatch(scene.sim, def); };
    CHECK_THROWS_WITH(make({.wall = scene.wall}), Catch::Contains("perforation: tools must have at least one entry"));
    CHECK_THROWS_WITH(make({.wall = scene.rod, .tools = {{.body = scene.rod}}}),
                      Catch::Contains("wall must be a soft"));
    CHECK_THROWS_WITH(make({.wall = scene.wall, .tools = {{.body = scene.wall}}}),
                      Catch::Contains("tools[0].body must be a rigid"));
    CHECK_THROWS_WITH(make({.wall = scene.wall, .tools = {{.body = scene.rod, .element = 1}}}),
                      Catch::Contains("tools[0].element must be in [0, 0], got 1"));
    CHECK_THROWS_WITH(make({.wall = scene.wall, .tools = {{.body = scene.rod}}, .force = 0.0}),
                      Catch::Contains("force must be > 0 N"));
}

} // namespace perforation_test
