#include "filasofia/filasofia.h"

#include "filasofia/runtime/replay.h"
#include "filasofia/runtime/stepped_run.h"
#include "filasofia/visual/image.h"
#include "runtime/cut_block.h"
#include "skip.h"

#include <cmath>
#include <filesystem>

#include <unistd.h>

namespace smoke_test {

using namespace filasofia;
using namespace filasofia::runtime;

namespace {

SmokeDef room() { return {.room = Box{{-60_mm, -20_mm, -60_mm}, {60_mm, 80_mm, 60_mm}}, .inflow = 5e-5}; }

/// A source heats the block's upper side, in a room that fills with smoke.
struct Ward : CutBlock {
    explicit Ward(int threads = 1, bool smokes = true) : CutBlock(threads, {16, 4, 12})
    {
        sim.burn(tissue, {.depth = 0.5_mm});
        if (smokes) sim.addSmoke(room());
        sim.treat(tissue, Heat{.place = {8_mm, 6_mm, 0}, .radius = 3_mm, .power = 60.0});
    }
};

double error(const surface::AerosolBalance& b) { return b.emitted - b.inAir - b.extracted - b.vented - b.settled; }

} // namespace

TEST_CASE("heat smokes, with the same bits for any number of threads, and physics is as without smoke")
{
    Ward one, two(2), eight(8), none(1, false);
    one.sim.extract({.place = {0, 40_mm, 0}, .flow = 1e-4});
    two.sim.extract({.place = {0, 40_mm, 0}, .flow = 1e-4});
    eight.sim.extract({.place = {0, 40_mm, 0}, .flow = 1e-4});
    const RunReport report = one.sim.run({.headless = true, .steps = 600});
    const RunReport clear = none.sim.run({.headless = true, .steps = 600});
    REQUIRE(report.smoke);
    const SmokeBalance& b = *report.smoke;
    CHECK(b.smoke.emitted > 1e-8);
    CHECK(b.smoke.extracted > 0.0);
    CHECK(b.smoke.vented > 0.0);
    CHECK(std::abs(error(b.smoke)) < 1e-9 * b.smoke.emitted);
    CHECK(std::abs(error(b.steam)) < 1e-9 * b.steam.emitted);
    // All that the heat gave off up to its last step that has ended, and no more.
    CHECK(b.smoke.emitted <= SmokeDef{}.yield * report.heat.at(0).balance.fuming);
    CHECK(b.smoke.emitted == Approx(SmokeDef{}.yield * one.sim.heat(one.tissue).fuming).epsilon(1e-9));
    CHECK(b == *two.sim.run({.headless = true, .steps = 600}).smoke);
    CHECK(b == *eight.sim.run({.headless = true, .steps = 600}).smoke);
    CHECK(report.hash == clear.hash);
    CHECK_FALSE(clear.smoke);
    CHECK_THAT(summary(report), Catch::Contains("smoke: ") && Catch::Contains(" mg sucked away"));
    CHECK(one.sim.smokeBetween({8_mm, 7_mm, 0}, {8_mm, 70_mm, 0}) >
          one.sim.smokeBetween({-50_mm, 7_mm, 0}, {-50_mm, 70_mm, 0}));
}

TEST_CASE("an opening on a moving body takes more smoke beside the source than away from it")
{
    const auto extracted = [](double height) {
        Ward ward;
        const BodyId tube = ward.sim.add(RigidBodyDef{.name = "tube", .elements = {{{8_mm, 200_mm, 0}, {}}}});
        ward.sim.extract({.place = {0, -10_mm, 0}, .flow = 1e-4, .body = tube});
        ward.sim.everyStep([&ward, tube, height](double) {
            ward.sim.physics().setPose(tube, {{8_mm, height, 0}, {}});
        });
        const RunReport report = ward.sim.run({.headless = true, .steps = 400});
        return report.smoke->smoke.extracted / report.smoke->smoke.emitted;
    };
    const double near = extracted(20_mm), far = extracted(89_mm);
    CHECK(near > 0.5);
    CHECK(far < 0.5 * near);
}

TEST_CASE("a state has the smoke, and a reset clears the air")
{
    Ward ward;
    SteppedRun run(ward.sim);
    for (int i = 0; i < 150; ++i) run.step();
    const auto saved = run.save();
    const auto go = [&] {
        ward.sim.extract({.place = {0, 40_mm, 0}, .flow = 1e-4});
        for (int i = 0; i < 100; ++i) run.step();
        return ward.sim.smoke();
    };
    const SmokeBalance first = go();
    CHECK(first.smoke.extracted > 0.0);
    run.restore(*saved);
    CHECK(ward.sim.smoke().smoke.extracted == 0.0);
    CHECK(go() == first);
    ward.sim.reset();
    for (int i = 0; i < 40; ++i) run.step();
    CHECK(ward.sim.smoke() == SmokeBalance{});
}

TEST_CASE("a replay shows the smoke of the run, to the byte")
{
    if (skipIf(!visual::hasBackend(Backend::Headless), "this build draws nothing")) return;
    const auto folder = std::filesystem::temp_directory_path() / text("filasofia_smoke_test_", getpid());
    std::filesystem::create_directory(folder);
    const auto picture = [&](const char* name, bool smokes) {
        Ward ward(1, smokes);
        ward.sim.show(ward.tissue);
        if (smokes) ward.sim.extract({.place = {20_mm, 20_mm, 0}, .flow = 2e-5, .body = ward.knife});
        ward.sim.run({.headless = true, .steps = 400, .picture = folder / name, .record = folder / "run.rec"});
        return visual::loadImage(folder / name).rgba;
    };
    const auto clear = picture("clear.png", false), smoky = picture("smoky.png", true);
    CHECK(smoky != clear);
    replay({.file = folder / "run.rec", .picture = folder / "again.png"});
    CHECK(visual::loadImage(folder / "again.png").rgba == smoky);
    std::filesystem::remove_all(folder);
}

TEST_CASE("an opening that a body carries takes nothing while it is outside the room")
{
    Ward ward;
    const BodyId tube = ward.sim.add(RigidBodyDef{.name = "tube", .elements = {{{8_mm, 200_mm, 0}, {}}}});
    ward.sim.extract({.flow = 1e-4, .body = tube});
    CHECK(ward.sim.run({.headless = true, .steps = 300}).smoke->smoke.extracted == 0.0);
    ward.sim.physics().setPose(tube, {{8_mm, 20_mm, 0}, {}});
    CHECK(ward.sim.run({.headless = true, .steps = 100}).smoke->smoke.extracted > 0.0);
}

TEST_CASE("every legal smoke can be drawn, however thick or wide")
{
    if (skipIf(!visual::hasBackend(Backend::Headless), "this build draws nothing")) return;
    const auto draw = [](const SmokeDef& def) {
        CutBlock block(1, {16, 4, 12});
        block.sim.burn(block.tissue, {.depth = 0.5_mm});
        block.sim.addSmoke(def);
        block.sim.treat(block.tissue, Heat{.place = {8_mm, 6_mm, 0}, .radius = 3_mm, .power = 60.0});
        block.sim.show(block.tissue);
        const auto file = std::filesystem::temp_directory_path() / text("filasofia_thick_", getpid(), ".png");
        block.sim.run({.headless = true, .steps = 400, .picture = file.string()});
        CHECK(std::filesystem::remove(file));
    };
    SmokeDef thick = room();
    thick.yield = 1e-3;
    thick.extinction = 1e6;
    draw(thick);
    thick.mixing = 1e-3; // all of it is haze
    draw(thick);
    SmokeDef wide = room();
    wide.room = Box{{-1e5, -1e5, -1e5}, {1e5, 1e5, 1e5}};
    wide.diffusivity = 1.0;
    wide.radius = 1.0;
    wide.warmth = 1.0;
    draw(wide);
}

TEST_CASE("wrong use of smoke is one clear error")
{
    using Catch::Contains;
    Ward ward(1, false);
    CHECK_THROWS_WITH(ward.sim.smoke(), Contains("there is no room for it; addSmoke() makes one"));
    CHECK_THROWS_WITH(ward.sim.smokeBetween({}, {0, 1, 0}), Contains("there is no room for it"));
    CHECK_THROWS_WITH(ward.sim.extract({.flow = 1e-4}), Contains("there is no room for it"));
    CHECK_THROWS_WITH(ward.sim.addSmoke({}), Contains("smoke: room must be given"));
    ward.sim.addSmoke(room());
    CHECK_THROWS_WITH(ward.sim.addSmoke(room()), Contains("has a room for it already"));
    CHECK_THROWS_WITH(ward.sim.extract({.flow = -1.0}), Contains("extract: flow must be in [0, 1] m^3/s, got -1"));
    CHECK_THROWS_WITH(ward.sim.extract({.place = {0, 90_mm, 0}, .flow = 1e-4}),
                      Contains("extract: place must be in the room of the smoke, from (-0.06 -0.02 -0.06) m to "
                               "(0.06 0.08 0.06) m, got (0 0.09 0) m"));
    ward.sim.extract({.place = {0, 90_mm, 0}}); // closes one, wherever
    CHECK_THROWS_WITH(ward.sim.smokeBetween({0, std::nan(""), 0}, {}),
                      Contains("smokeBetween: both points must be finite, got (0 nan 0) m and (0 0 0) m"));
    CHECK_THROWS_WITH(ward.sim.extract({.flow = 1e-4, .body = ward.tissue}), Contains("body must be a rigid one"));
    CHECK_THROWS_WITH(ward.sim.extract({.flow = 1e-4, .body = ward.knife, .element = 1}),
                      Contains("element must be in [0, 1), got 1"));
}

} // namespace smoke_test
