#include "filasofia/prefab/suction_irrigator.h"

#include "filasofia/core/error.h"
#include "filasofia/core/units.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/runtime/stepped_run.h"

#include <catch2/catch.hpp>

namespace suction_irrigator_test {

using namespace filasofia;
using namespace filasofia::prefab;
using runtime::Simulation;
using runtime::SteppedRun;
using surface::BloodBalance;

namespace {

constexpr double kRate = 250;

/// A block that bleeds at its top, and a tube above it, which looks down.
struct Bed {
    Simulation sim;
    BodyId tissue;
    ArticulatedInstrument tube;
    SuctionIrrigator suction;

    explicit Bed(int threads = 1, const SuctionIrrigatorDef& def = {})
        : sim(runtime::SimulationDef{.physics = {.rate = kRate, .gravity = {0, -9.81, 0}, .threads = threads}}),
          tissue(addTissue()), tube(sim, {.kind = InstrumentKind::SuctionIrrigator, .pose = above(0.0), .groups = {}}),
          suction(sim, tube, def)
    {
        sim.bleed(tissue, {.flux = 5e-4, .clottingTime = 100.0});
        sim.treat(tissue, surface::Injure{{0, 5_mm, 0}, 6_mm});
    }
    /// The tube's mouth 1 mm over the block.
    static Pose above(double x) { return {{x, 36_mm, 0}, axisAngle({1, 0, 0}, -90_deg)}; }
    BodyId addTissue()
    {
        physics::SoftBodyDef def{.name = "tissue", .mesh = geometry::shapes::block({40_mm, 10_mm, 20_mm}, {20, 3, 10})};
        def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1, 1}}}};
        return sim.add(def);
    }
    BloodBalance after(SteppedRun& run, double seconds)
    {
        for (int i = 0; i < static_cast<int>(seconds * kRate); ++i) run.step();
        return run.report().blood.at(0).balance;
    }
};

double error(const BloodBalance& b) { return b.welled - b.onTissue - b.sucked - b.rinsed - b.dripped - b.carriedOff; }

} // namespace

TEST_CASE("a closed suction tube takes the blood below its mouth, wherever it is")
{
    Bed bed;
    SteppedRun run(bed.sim);
    CHECK(bed.after(run, 1.0).sucked == 0.0);
    CHECK_FALSE(bed.suction.sucks());
    CHECK(bed.tube.opening() == 1.0);
    bed.tube.close();
    const BloodBalance there = bed.after(run, 1.0);
    CHECK(bed.suction.sucks());
    CHECK(bed.tube.opening() == 0.0);
    CHECK(there.sucked > 0.3 * there.welled);
    bed.tube.move(Bed::above(60_mm)); // beside the block
    const double left = bed.after(run, 0.1).sucked;
    CHECK(bed.after(run, 1.0).sucked == left);
    bed.tube.move(Bed::above(0.0));
    CHECK(bed.after(run, 0.5).sucked > left);
    bed.tube.open();
    const double open = bed.after(run, 0.1).sucked;
    const BloodBalance last = bed.after(run, 1.0);
    CHECK(last.sucked == open);
    CHECK(std::abs(error(last)) < 1e-12 * last.welled);
}

TEST_CASE("rinsing takes at most as much blood as liquid flows, and is counted")
{
    Bed bed(1, {.reach = 30_mm, .irrigation = 2e-9});
    SteppedRun run(bed.sim);
    bed.after(run, 2.0);
    bed.suction.rinse(true);
    const BloodBalance washed = bed.after(run, 5.0);
    CHECK(bed.suction.rinses());
    CHECK(bed.suction.irrigated() == Approx(2e-9 * 5.0).epsilon(0.01));
    CHECK(washed.rinsed == Approx(bed.suction.irrigated()).epsilon(0.02)); // there is more blood than that
    CHECK(washed.onTissue > 0.0);
    bed.suction.rinse(false);
    const double rinsed = bed.after(run, 0.1).rinsed;
    CHECK(bed.after(run, 1.0).rinsed == rinsed);
}

TEST_CASE("suction goes on after a reset, comes back with a saved state, and has the same bits with three threads")
{
    Bed bed, three(3);
    SteppedRun run(bed.sim), other(three.sim);
    bed.tube.close();
    three.tube.close();
    const BloodBalance then = bed.after(run, 1.0);
    CHECK(three.after(other, 1.0) == then);
    CHECK(run.report().hash == other.report().hash);
    const auto saved = run.save();
    const BloodBalance first = bed.after(run, 1.0);
    bed.tube.open();
    bed.after(run, 0.5);
    run.restore(*saved);
    CHECK(bed.after(run, 1.0) == first);
    bed.sim.reset();
    bed.after(run, 0.1);
    bed.sim.treat(bed.tissue, surface::Injure{{0, 5_mm, 0}, 6_mm});
    CHECK(bed.after(run, 3.0).sucked > 0.0);
}

TEST_CASE("the smoke before its mouth goes, too")
{
    const auto smokeLeft = [](bool sucks) {
        Bed bed;
        bed.sim.burn(bed.tissue, {.depth = 0.5_mm});
        bed.sim.addSmoke({.room = geometry::Box{{-60_mm, 0, -60_mm}, {60_mm, 80_mm, 60_mm}}});
        bed.sim.treat(bed.tissue, surface::Heat{.place = {0, 5_mm, 0}, .radius = 3_mm, .power = 60.0});
        if (sucks) bed.tube.close();
        SteppedRun run(bed.sim);
        bed.after(run, 4.0);
        return run.report().smoke->smoke;
    };
    const surface::AerosolBalance free = smokeLeft(false), sucked = smokeLeft(true);
    CHECK(free.extracted == 0.0);
    CHECK(sucked.extracted > 0.1 * sucked.emitted);
    CHECK(sucked.inAir < free.inAir);
}

TEST_CASE("a wrong suction tube is refused by name")
{
    Simulation sim;
    ArticulatedInstrument tube(sim, {.name = "tube", .kind = InstrumentKind::SuctionIrrigator});
    using Catch::Contains;
    CHECK_THROWS_WITH(SuctionIrrigator(sim, tube, {.reach = 0.0}), Contains("suction of 'tube': reach must be > 0 m"));
    CHECK_THROWS_WITH(SuctionIrrigator(sim, tube, {.suction = -1.0}), Contains("suction must be >= 0 m^3/s, got -1"));
    CHECK_THROWS_WITH(ArticulatedInstrument(sim, {.name = "no jaw", .jaws = {{.opensBy = 0.0}}}),
                      Contains("at least one must have opensBy > 0"));
}

} // namespace suction_irrigator_test
