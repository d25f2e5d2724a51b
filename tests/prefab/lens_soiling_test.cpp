#include "filasofia/prefab/laparoscope.h"

#include "filasofia/core/error.h"
#include "filasofia/core/units.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/runtime/stepped_run.h"

#include <catch2/catch.hpp>

#include <cmath>

namespace lens_soiling_test {

using namespace filasofia;
using namespace filasofia::prefab;
using runtime::Simulation;
using runtime::SteppedRun;

namespace {

constexpr double kRate = 200;

void step(SteppedRun& run, double seconds)
{
    for (int i = 0; i < static_cast<int>(std::lround(seconds * kRate)); ++i) run.step();
}

} // namespace

TEST_CASE("a cold lens is fogged, and clears with its time constant")
{
    Simulation sim(runtime::SimulationDef{.physics = {.rate = kRate}});
    const Endoscope scope(sim, {.groups = {}, .soiling = LensDef{.cold = 0.8, .clearing = 10.0}});
    SteppedRun run(sim);
    CHECK(scope.lens().mist == 0.8);
    step(run, 5.0);
    CHECK(scope.lens().mist == Approx(0.8 * std::exp(-0.5)).epsilon(0.01));
    CHECK(scope.lens().smear == 0.0);
}

TEST_CASE("tissue that touches the scope near its lens smears it, until it is wiped")
{
    Simulation sim(runtime::SimulationDef{.physics = {.rate = kRate, .gravity = {}}});
    physics::SoftBodyDef tissue{.name = "tissue", .mesh = geometry::shapes::block({20_mm, 20_mm, 10_mm}, {5, 5, 3})};
    tissue.pose.position = {0, 0, -10_mm}; // 5 mm before the tip
    tissue.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1, -14.9_mm}}}};
    tissue.collision = {{}};
    sim.add(tissue);
    Endoscope scope(sim, {.soiling = LensDef{.smearing = 0.5}});
    SteppedRun run(sim);
    step(run, 0.2);
    CHECK(scope.lens() == LensState{});
    scope.move({{0, 0, -7_mm}, {}}); // 2 mm into it
    step(run, 0.1);
    const double then = scope.lens().smear;
    CHECK(then > 0.0);
    step(run, 1.0);
    CHECK(1.0 - scope.lens().smear == Approx((1.0 - then) * std::exp(-2.0)).epsilon(0.02));
    const auto saved = run.save();
    const double smeared = scope.lens().smear;
    scope.move({});
    step(run, 0.2);
    scope.wipe();
    step(run, 0.2);
    CHECK(scope.lens() == LensState{});
    run.restore(*saved);
    CHECK(scope.lens().smear == smeared);
    scope.soil({.mist = 0.5, .smear = 0.25});
    step(run, 1.0 / kRate);
    CHECK(scope.lens().mist == Approx(0.5).epsilon(0.01));
}

TEST_CASE("smoke before a lens fogs it")
{
    const auto mistIn = [](bool smokes) {
        Simulation sim(runtime::SimulationDef{.physics = {.rate = kRate, .gravity = {0, -9.81, 0}}});
        physics::SoftBodyDef tissue{.name = "tissue",
                                    .mesh = geometry::shapes::block({20_mm, 4_mm, 20_mm}, {10, 2, 10})};
        tissue.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1, 1}}}};
        const BodyId id = sim.add(tissue);
        sim.burn(id, {.depth = 0.5_mm});
        if (smokes) sim.addSmoke({.room = geometry::Box{{-30_mm, -5_mm, -30_mm}, {30_mm, 50_mm, 30_mm}}});
        sim.treat(id, surface::Heat{.place = {0, 2_mm, 0}, .radius = 3_mm, .power = 60.0});
        const Endoscope scope(
            sim, {.pose = {{0, 25_mm, 0}, axisAngle({1, 0, 0}, -90_deg)}, .groups = {}, .soiling = LensDef{}});
        SteppedRun run(sim);
        step(run, 5.0);
        return scope.lens().mist;
    };
    CHECK(mistIn(false) == 0.0);
    CHECK(mistIn(true) > 0.1);
}

TEST_CASE("a laparoscope's lens is wiped when it is drawn back into its trocar")
{
    Simulation sim(runtime::SimulationDef{.physics = {.rate = kRate}});
    Laparoscope scope(sim, {.start = {.insertion = 50_mm}, .soiling = LensDef{}});
    SteppedRun run(sim);
    scope.soil({.smear = 0.5});
    step(run, 0.2);
    CHECK(scope.lens().smear == 0.5);
    scope.move({.insertion = scope.def().trocar.leastInsertion});
    step(run, 2.0);
    CHECK(scope.lens() == LensState{});
}

TEST_CASE("a wrong lens is refused by name")
{
    using Catch::Contains;
    Simulation sim;
    Endoscope scope(sim, {.name = "scope", .groups = {}});
    CHECK_THROWS_WITH(scope.soil({.mist = 1.5}), Contains("endoscope 'scope': mist must be in [0, 1], got 1.5"));
    CHECK_THROWS_WITH(scope.soil({.smear = -0.1}), Contains("smear must be in [0, 1], got -0.1"));
    CHECK_THROWS_WITH(Endoscope(sim, {.groups = {}, .soiling = LensDef{.smearing = 0.0}}),
                      Contains("soiling.smearing must be > 0 s, got 0"));
}

} // namespace lens_soiling_test
