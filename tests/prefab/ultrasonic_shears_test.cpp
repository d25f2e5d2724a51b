#include "filasofia/prefab/ultrasonic_shears.h"

#include "filasofia/core/disjoint_sets.h"
#include "filasofia/core/error.h"
#include "filasofia/core/units.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/runtime/stepped_run.h"

#include <catch2/catch.hpp>

#include <set>

namespace ultrasonic_shears_test {

using namespace filasofia;
using namespace filasofia::prefab;
using runtime::Simulation;
using runtime::SteppedRun;

namespace {

constexpr double kRate = 500;

/// A band across the open jaws, held at both ends. Its lower side lies on the blade.
struct Theatre {
    Simulation sim;
    BodyId band;
    ArticulatedInstrument tool;
    UltrasonicShears shears;

    explicit Theatre(int threads = 1, const UltrasonicShearsDef& def = {})
        : sim(runtime::SimulationDef{.physics = {.rate = kRate, .gravity = {}, .threads = threads}}), band(addBand()),
          tool(sim, {.name = "shears", .kind = InstrumentKind::UltrasonicShears, .opening = 1.0}),
          shears(sim, tool, def)
    {
        sim.burn(band, {.depth = 0.7_mm});
        sim.bleed(band, {.flux = 1e-4});
    }
    BodyId addBand()
    {
        physics::SoftBodyDef def{.name = "band",
                                 .mesh = geometry::shapes::block({30_mm, 1.4_mm, 5_mm}, {30, 2, 5}),
                                 .dynamicTopology = true};
        def.pose.position = {0, 0.8_mm, -8_mm};
        def.material = physics::FemMaterial{.youngModulus = 30_kPa, .poissonRatio = 0.45};
        def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {-14.9_mm, 1, 1}}},
                           {.box = geometry::Box{{14.9_mm, -1, -1}, {1, 1, 1}}}};
        def.collision = {{.proximity = 0.1_mm, .selfOnceCut = false}};
        return sim.add(def);
    }
    void step(SteppedRun& run, double seconds)
    {
        for (int i = 0; i < static_cast<int>(seconds * kRate); ++i) run.step();
    }
    /// [-], connected pieces of the band's surface.
    [[nodiscard]] int pieces()
    {
        const auto frame = sim.physics().latest();
        const frame::SoftBodyFrame* body = frame->softBody(band);
        if (!body->boundary || body->boundary->triangles.empty()) return 1;
        DisjointSets sets(body->positions.size());
        std::set<int> of;
        for (const auto& [a, b, c] : body->boundary->triangles) {
            sets.join(a, b);
            sets.join(a, c);
        }
        for (const auto& each : body->boundary->triangles) of.insert(sets.find(each[0]));
        return static_cast<int>(of.size());
    }
};

} // namespace

TEST_CASE("ultrasonic shears seal a band and part it, once for each time that they close")
{
    Theatre theatre;
    SteppedRun run(theatre.sim);
    theatre.tool.close();
    theatre.step(run, 1.0);
    CHECK(theatre.shears.sealed() == 0.0);
    CHECK(theatre.shears.parted() == 0); // no pedal, no parting
    CHECK(theatre.pieces() == 1);
    theatre.shears.press(true);
    double sealing = 0.0, parting = 0.0;
    for (; sealing < 10.0 && !theatre.shears.parts(); sealing += 0.1) theatre.step(run, 0.1);
    theatre.shears.press(false); // not yet
    theatre.step(run, 0.5);
    CHECK_FALSE(theatre.shears.parts());
    CHECK(theatre.shears.parted() == 0);
    theatre.shears.press(true);
    for (; parting < 10.0 && theatre.shears.parted() == 0; parting += 0.1) theatre.step(run, 0.1);
    INFO("sealed after " << sealing << " s, parted " << parting << " s later");
    CHECK(theatre.shears.parted() == 1);
    CHECK(sealing > 0.15); // heat takes its time
    CHECK(parting == Approx(UltrasonicShearsDef{}.parting).margin(0.15));
    CHECK(theatre.shears.sealed() >= UltrasonicShearsDef{}.sealed);
    theatre.step(run, 2.0);
    CHECK_FALSE(theatre.shears.parts());
    theatre.shears.press(false);
    theatre.tool.open();
    theatre.step(run, 1.0);
    CHECK(theatre.pieces() == 2);
    CHECK(theatre.shears.parted() == 1);
    const auto heat = theatre.sim.heat(theatre.band);
    CHECK(heat.hottest < UltrasonicShearsDef{}.limit + 1.0);
    CHECK(heat.charred == 0.0);
    // Sealed: next to nothing of what 14 mm^2 of unsealed cut would lose in the same time.
    CHECK(theatre.sim.blood(theatre.band).welled < 0.1 * 1e-4 * 14e-6 * 2.0);
}

TEST_CASE("ultrasonic shears: the same bits with three threads, and after a restored state")
{
    Theatre one, three(3);
    SteppedRun run(one.sim), other(three.sim);
    for (auto [theatre, its] : {std::pair(&one, &run), std::pair(&three, &other)}) {
        theatre->tool.close();
        theatre->shears.press(true);
        theatre->step(*its, 1.0);
    }
    CHECK(run.report().hash == other.report().hash);
    const auto saved = run.save();
    one.step(run, 4.0);
    const auto hash = run.report().hash;
    const int parted = one.shears.parted();
    CHECK(parted == 1);
    run.restore(*saved);
    one.step(run, 4.0);
    CHECK(run.report().hash == hash);
    CHECK(one.shears.parted() == parted);
}

TEST_CASE("wrong ultrasonic shears are refused by name")
{
    using Catch::Contains;
    Simulation sim;
    ArticulatedInstrument tool(sim, {.name = "tool", .kind = InstrumentKind::UltrasonicShears});
    ArticulatedInstrument grasper(sim, {.name = "grasper", .kind = InstrumentKind::LaparoscopicGrasper});
    CHECK_THROWS_WITH(UltrasonicShears(sim, tool, {.to = 1_mm}), Contains("'tool': to must be > from (0.0015 m)"));
    CHECK_THROWS_WITH(UltrasonicShears(sim, tool, {.sealed = 2.0}), Contains("sealed must be in (0, 1], got 2"));
    CHECK_THROWS_WITH(UltrasonicShears(sim, grasper, {}), Contains("must have one jaw that moves, got 2"));
    const UltrasonicShears shears(sim, tool);
    CHECK_THROWS_WITH(UltrasonicShears(sim, tool), Contains("must have no electrode, got 1"));
}

} // namespace ultrasonic_shears_test
