#include "filasofia/filasofia.h"

#include "filasofia/runtime/replay.h"
#include "filasofia/runtime/stepped_run.h"
#include "filasofia/visual/image.h"
#include "runtime/cut_block.h"
#include "skip.h"

#include <cmath>
#include <filesystem>

#include <unistd.h>

namespace distension_test {

using namespace filasofia;
using namespace filasofia::runtime;

namespace {

const DistensionDef kCavity{.room = Box{{-30_mm, -10_mm, -30_mm}, {30_mm, 40_mm, 30_mm}},
                            .pressure = 10e3,
                            .outflow = 0.5,
                            .deficitLimit = 1.5e-6};

/// A block that is cut, and bleeds into a fluid; the knife is an electrode.
struct Ward : CutBlock {
    explicit Ward(int threads = 1, bool fluid = true) : CutBlock(threads, {16, 4, 12})
    {
        sim.bleed(tissue, {.flux = 1e-3});
        sim.addElectrode(knife, {.mode = EnergyMode::Coagulate, .power = 60.0, .tip = {.to = {0, 0, 5_mm}}});
        if (fluid) sim.addDistension(kCavity);
        sim.activate(knife, true);
    }
};

double error(const DistensionBalance& b) { return b.atStart + b.in + b.bled - b.out - b.lost - b.volume; }

} // namespace

TEST_CASE(
    "what bleeds clouds the fluid and an electrode makes bubbles, the same for any number of threads, and physics "
    "is as without it")
{
    Ward one, two(2), eight(8), none(1, false);
    const RunReport report = one.sim.run({.headless = true, .steps = 400});
    const RunReport dry = none.sim.run({.headless = true, .steps = 400});
    REQUIRE(report.distension);
    const DistensionBalance& b = *report.distension;
    CHECK(b.in > 1e-6);
    CHECK(b.out > 0.0);
    CHECK(std::abs(error(b)) < 1e-9 * b.volume);
    CHECK(b.bled > 0.0);
    CHECK(b.bled <= report.blood.at(0).balance.welled);
    CHECK(b.bled == Approx(one.sim.blood(one.tissue).welled).epsilon(1e-9)); // all that is known to have welled
    CHECK(b.gasFormed == Approx(kCavity.gas * 60.0 * one.sim.energy(one.knife).active).epsilon(0.05));
    CHECK(b == *two.sim.run({.headless = true, .steps = 400}).distension);
    CHECK(b == *eight.sim.run({.headless = true, .steps = 400}).distension);
    CHECK(report.hash == dry.hash);
    CHECK_FALSE(dry.distension);
    CHECK_THAT(summary(report), Catch::Contains("distension: ") && Catch::Contains("(too high)"));
}

TEST_CASE("an event tells of the fluid once per second, and at once when the deficit is too high")
{
    Ward ward;
    std::vector<DistensionEvent> told;
    ward.sim.on<DistensionEvent>([&](const DistensionEvent& each) { told.push_back(each); });
    ward.sim.run({.headless = true, .steps = 1100});
    REQUIRE(told.size() == 4); // after its first step, at the limit, and twice on the second
    CHECK_FALSE(told[0].balance.beyondLimit);
    CHECK(told[1].balance.beyondLimit);
    CHECK(told[1].time < 0.99);
    CHECK(deficit(told[1].balance) == Approx(1.5e-6).epsilon(0.1));
    CHECK(told[3].time == Approx(2.0).margin(0.02));
}

TEST_CASE("taps are turned from the next step of the fluid on, a state has it, and a reset turns them back")
{
    Ward ward;
    SteppedRun run(ward.sim);
    for (int i = 0; i < 150; ++i) run.step();
    const auto saved = run.save();
    const auto go = [&] {
        ward.sim.distend({.pressure = 0.0, .outflow = 1.0});
        for (int i = 0; i < 100; ++i) run.step();
        return ward.sim.distension();
    };
    const DistensionBalance first = go();
    CHECK(first.inflow == 0.0);
    CHECK(first.bled > 0.0);
    run.restore(*saved);
    CHECK(ward.sim.distension().inflow > 0.0);
    CHECK(go() == first);
    ward.sim.reset();
    for (int i = 0; i < 40; ++i) run.step();
    const DistensionBalance again = ward.sim.distension();
    CHECK(again.inflow > 0.0);
    CHECK(again.bled == Approx(ward.sim.blood(ward.tissue).welled).epsilon(1e-9)); // the knife has cut again
    CHECK(again.bled < 0.5 * first.bled);
    CHECK(again.in < first.in);
    CHECK(std::abs(error(again)) < 1e-9 * again.volume);
}

TEST_CASE("a replay shows the fluid of the run, to the byte")
{
    if (skipIf(!visual::hasBackend(Backend::Headless), "this build draws nothing")) return;
    const auto folder = std::filesystem::temp_directory_path() / text("filasofia_distension_test_", getpid());
    std::filesystem::create_directory(folder);
    const auto picture = [&](const char* name, bool fluid) {
        Ward ward(1, fluid);
        ward.sim.show(ward.tissue);
        if (fluid) ward.sim.distend({.outflow = 0.0});
        ward.sim.run({.headless = true, .steps = 400, .picture = folder / name, .record = folder / "run.rec"});
        return visual::loadImage(folder / name).rgba;
    };
    const auto clear = picture("clear.png", false), cloudy = picture("cloudy.png", true);
    CHECK(cloudy != clear);
    replay({.file = folder / "run.rec", .picture = folder / "again.png"});
    CHECK(visual::loadImage(folder / "again.png").rgba == cloudy);
    std::filesystem::remove_all(folder);
}

TEST_CASE("blood in the fluid dims and reddens what is seen through it")
{
    if (skipIf(!visual::hasBackend(Backend::Headless), "this build draws nothing")) return;
    const auto seen = [](double extinction) {
        DistensionDef def = kCavity;
        def.extinction = extinction;
        def.gas = 0.0;
        Ward other(1, false);
        other.sim.addDistension(def);
        other.sim.show(other.tissue, {.material = visual::BoneMaterial{}});
        const auto file = std::filesystem::temp_directory_path() / text("filasofia_blood_", getpid(), ".png");
        other.sim.run({.headless = true, .steps = 400, .picture = file.string()});
        const visual::Image image = visual::loadImage(file);
        std::filesystem::remove(file);
        return image.rgba;
    };
    const auto clear = seen(0.0), red = seen(1e5);
    std::array<double, 3> before{}, after{}; // what was bright
    for (std::size_t i = 0; i < clear.size(); i += 4)
        for (std::size_t k = 0; k < 3 && clear[i + 1] > 120; ++k) {
            before[k] += clear[i + k];
            after[k] += red[i + k];
        }
    REQUIRE(before[1] > 0.0);
    CHECK(after[1] < 0.9 * before[1]);
    CHECK(after[1] / after[0] < 0.9 * before[1] / before[0]);
}

TEST_CASE("wrong use of a distension is one clear error")
{
    using Catch::Contains;
    Ward ward(1, false);
    CHECK_THROWS_WITH(ward.sim.distension(), Contains("distension: there is none; addDistension() makes one"));
    CHECK_THROWS_WITH(ward.sim.distend({.outflow = 1.0}), Contains("there is none"));
    CHECK_THROWS_WITH(ward.sim.addDistension({}), Contains("distension: room must be given"));
    ward.sim.addDistension(kCavity);
    CHECK_THROWS_WITH(ward.sim.addDistension(kCavity), Contains("has one already"));
    CHECK_THROWS_WITH(ward.sim.addSmoke({.room = kCavity.room}), Contains("a fluid distends a cavity"));
    CHECK_THROWS_WITH(ward.sim.distend({.outflow = 1.5}), Contains("distend: outflow must be in [0, 1], got 1.5"));
    Ward smoky(1, false);
    smoky.sim.addSmoke({.room = kCavity.room});
    CHECK_THROWS_WITH(smoky.sim.addDistension(kCavity), Contains("the simulation has a room for smoke"));
}

} // namespace distension_test
