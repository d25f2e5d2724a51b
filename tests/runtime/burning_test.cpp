#include "filasofia/filasofia.h"

#include "filasofia/runtime/replay.h"
#include "filasofia/runtime/stepped_run.h"
#include "filasofia/visual/image.h"
#include "runtime/cut_block.h"
#include "shown_stage.h"
#include "skip.h"

#include <filesystem>

#include <unistd.h>

namespace burning_test {

using namespace filasofia;
using namespace filasofia::runtime;

namespace {

/// A source heats the block's upper side from the first step on.
struct Ward : CutBlock {
    explicit Ward(int threads = 1, bool burns = true, BurningDef def = {}) : CutBlock(threads, {16, 4, 12})
    {
        if (!burns) return;
        sim.burn(tissue, def);
        sim.treat(tissue, Heat{.place = {0, 6_mm, 0}, .radius = 3_mm, .power = 60.0});
    }
};

double error(const HeatBalance& b) { return b.delivered - b.stored - b.perfused - b.lost - b.boiled - b.carriedOff; }

} // namespace

TEST_CASE("heat burns, with the same bits for any number of threads, and physics is as without heat")
{
    Ward one, three(3), none(1, false);
    const RunReport report = one.sim.run({.headless = true, .steps = 600});
    const RunReport other = three.sim.run({.headless = true, .steps = 600});
    const RunReport cold = none.sim.run({.headless = true, .steps = 600});
    REQUIRE(report.heat.size() == 1);
    const HeatBalance& b = report.heat[0].balance;
    CHECK(report.cutArea() > 0.0);
    CHECK(b.delivered == Approx(60.0 * 1.2).epsilon(0.05));
    CHECK(b.burnt > 5e-6);
    CHECK(std::abs(error(b)) < 1e-6 * b.delivered);
    CHECK(b == other.heat.at(0).balance);
    CHECK(report.hash == other.hash);
    CHECK(report.hash == cold.hash);
    CHECK(cold.heat.empty());
    CHECK_THAT(summary(report), Catch::Contains("heat of 'tissue': ") && Catch::Contains(" mm^2, charred "));
    CHECK(one.sim.heat(one.tissue).delivered <= b.delivered); // up to the last step of the heat that has ended
}

TEST_CASE("what is burnt does not bleed, also when it is cut later")
{
    const auto lost = [](bool burns) {
        Ward ward(1, burns);
        ward.sim.bleed(ward.tissue, {.flux = 1e-3, .vesselDensity = std::numeric_limits<double>::infinity()});
        if (burns) ward.sim.treat(ward.tissue, Heat{.radius = 1.0, .power = 1e4, .limit = 370.0}); // everywhere
        return ward.sim.run({.headless = true, .steps = 600}).blood.at(0).balance.welled;
    };
    const double unburnt = lost(false);
    CHECK(unburnt > 1e-8);
    CHECK(lost(true) < 0.1 * unburnt);
}

TEST_CASE("events tell the burnt area, and that it is an injury if the body is no target")
{
    Ward ward(1, true, {.target = false});
    std::vector<BurnEvent> told;
    ward.sim.on<BurnEvent>([&](const BurnEvent& each) { told.push_back(each); });
    const RunReport report = ward.sim.run({.headless = true, .steps = 1100});
    REQUIRE(told.size() >= 2);
    CHECK(told[0].balance.burnt == 0.0); // it can burn
    CHECK_FALSE(told[0].injury);
    CHECK(told[1].balance.burnt > 0.0);
    CHECK(told[1].injury);
    CHECK(told[1].body == ward.tissue);
    CHECK_THAT(summary(report), Catch::Contains("(an injury: it is no target)"));
}

TEST_CASE("a state has the heat: steps after restore() have that of the steps after save()")
{
    Ward ward;
    SteppedRun run(ward.sim);
    for (int i = 0; i < 150; ++i) run.step();
    const auto saved = run.save();
    const auto go = [&] {
        ward.sim.treat(ward.tissue, Heat{.place = {5_mm, 6_mm, 0}, .power = 20.0});
        for (int i = 0; i < 100; ++i) run.step();
        return ward.sim.heat(ward.tissue);
    };
    const HeatBalance first = go();
    CHECK(first.delivered > 0.0);
    run.restore(*saved);
    CHECK(go() == first);
}

TEST_CASE("a reset cools and heals, and ends the sources")
{
    Ward ward;
    SteppedRun run(ward.sim);
    for (int i = 0; i < 90; ++i) run.step();
    CHECK(ward.sim.heat(ward.tissue).delivered > 0.0);
    ward.sim.reset();
    for (int i = 0; i < 40; ++i) run.step();
    const HeatBalance now = ward.sim.heat(ward.tissue);
    CHECK(now.delivered == 0.0);
    CHECK(now.burnt == 0.0);
    CHECK(now.hottest == Approx(310.15));
}

TEST_CASE("a replay shows the burn of the run, to the byte")
{
    if (skipIf(!visual::hasBackend(Backend::Headless), "this build draws nothing")) return;
    const auto folder = std::filesystem::temp_directory_path() / text("filasofia_burning_test_", getpid());
    std::filesystem::create_directory(folder);
    const auto picture = [&](const char* name, bool burns) {
        Ward ward(1, burns);
        ward.sim.show(ward.tissue);
        ward.sim.run({.headless = true, .steps = 400, .picture = folder / name, .record = folder / "run.rec"});
        return visual::loadImage(folder / name).rgba;
    };
    const auto cold = picture("cold.png", false), burnt = picture("burnt.png", true);
    CHECK(burnt != cold);
    replay({.file = folder / "run.rec", .picture = folder / "again.png"});
    CHECK(visual::loadImage(folder / "again.png").rgba == burnt);
    std::filesystem::remove_all(folder);
}

TEST_CASE("wrong use of heat is one clear error")
{
    Ward ward(1, false);
    CHECK_THROWS_WITH(ward.sim.burn(ward.knife), "burning of rigid body 'knife': needs a soft body with a surface");
    CHECK_THROWS_WITH(ward.sim.burn(ward.tissue, {.water = 1.5}),
                      Catch::Contains("burning of soft body 'tissue': water must be in [0, 1], got 1.5"));
    CHECK_THROWS_WITH(ward.sim.treat(ward.tissue, Heat{}), Catch::Contains("does not burn; burn() makes it"));
    CHECK_THROWS_WITH(ward.sim.heat(ward.tissue), Catch::Contains("does not burn; burn() makes it"));
    ward.sim.burn(ward.tissue);
    CHECK_THROWS_WITH(ward.sim.burn(ward.tissue), Catch::Contains("it burns already"));
    CHECK_THROWS_WITH(ward.sim.treat(ward.tissue, Heat{.power = -1.0}),
                      Catch::Contains("heat of 'tissue': power must be in [0, 1000000] W, got -1"));
}

} // namespace burning_test
