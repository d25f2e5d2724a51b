#include "filasofia/filasofia.h"

#include "filasofia/core/log.h"
#include "filasofia/runtime/film_marks.h"
#include "filasofia/runtime/replay.h"
#include "filasofia/runtime/stepped_run.h"
#include "filasofia/surface/body_surface.h"
#include "filasofia/visual/image.h"
#include "geometry/sample_meshes.h"
#include "runtime/cut_block.h"
#include "shown_stage.h"
#include "skip.h"

#include <filesystem>

#include <unistd.h>

namespace bleeding_test {

using namespace filasofia;
using namespace filasofia::runtime;

namespace {

/// The block bleeds.
struct Wound : CutBlock {
    explicit Wound(int threads = 1, bool bleeds = true) : CutBlock(threads, {10, 3, 8})
    {
        if (bleeds) sim.bleed(tissue, {.flux = 1e-3, .clottingTime = 20.0});
    }
};

} // namespace

TEST_CASE("a cut bleeds, with the same bits for any number of threads, and physics is as without blood")
{
    Wound one, three(3), none(1, false);
    const RunReport report = one.sim.run({.headless = true, .steps = 400});
    const RunReport other = three.sim.run({.headless = true, .steps = 400});
    const RunReport dry = none.sim.run({.headless = true, .steps = 400});
    REQUIRE(report.blood.size() == 1);
    CHECK(report.blood[0].body == "tissue");
    CHECK(report.blood[0].balance.welled > 1e-8);
    CHECK(report.blood[0].balance == other.blood.at(0).balance);
    CHECK(report.hash == other.hash);
    CHECK(report.hash == dry.hash);
    CHECK(dry.blood.empty());
    CHECK_THAT(summary(report), Catch::Contains("blood of 'tissue': ") && Catch::Contains(" ml lost"));
    CHECK_THAT(summary(dry), !Catch::Contains("blood of"));
    const BloodBalance& b = report.blood[0].balance;
    CHECK(b.welled == Approx(b.onTissue + b.sucked + b.rinsed + b.dripped + b.carriedOff).epsilon(1e-12));
    CHECK(one.sim.blood(one.tissue).welled <= b.welled); // up to the last step of the film that has ended
}

TEST_CASE("events tell what a body has lost, at first and then each second")
{
    Wound wound;
    std::vector<BleedingEvent> told;
    wound.sim.on<BleedingEvent>([&](const BleedingEvent& each) { told.push_back(each); });
    const RunReport report = wound.sim.run({.headless = true, .steps = 1600});
    REQUIRE(told.size() == 4);
    CHECK(told[0].balance.welled == 0.0); // it can bleed
    for (std::size_t i = 1; i < told.size(); ++i) {
        CHECK(told[i].body == wound.tissue);
        CHECK(told[i].time == Approx(static_cast<double>(i)).margin(0.02));
        CHECK(told[i].balance.welled > told[i - 1].balance.welled);
    }
    CHECK(told.back().balance.welled < report.blood.at(0).balance.welled);
}

TEST_CASE("events tell what was lost before a reset, and then count from 0")
{
    Wound wound;
    std::vector<double> told;
    wound.sim.on<BleedingEvent>([&](const BleedingEvent& each) { told.push_back(each.balance.welled); });
    SteppedRun run(wound.sim);
    wound.sim.treat(wound.tissue, Injure{{10_mm, 6_mm, 0}, 5_mm});
    for (int i = 0; i < 60; ++i) run.step(); // the knife is not there yet
    const double lost = wound.sim.blood(wound.tissue).welled;
    wound.sim.reset();
    for (int i = 0; i < 30; ++i) run.step();
    REQUIRE(told.size() == 3);
    CHECK(told[0] == 0.0);
    CHECK(told[1] >= lost);
    CHECK(told[2] == 0.0);
}

TEST_CASE("a state has the blood: steps after restore() have that of the steps after save()")
{
    Wound wound;
    SteppedRun run(wound.sim);
    for (int i = 0; i < 203; ++i) run.step();
    const auto saved = run.save();
    const BloodBalance then = wound.sim.blood(wound.tissue);
    const auto go = [&] {
        wound.sim.treat(wound.tissue, Suck{{0, 6_mm, 0}, 20_mm, 1e-8});
        for (int i = 0; i < 100; ++i) run.step();
        return run.report().blood.at(0).balance;
    };
    const BloodBalance first = go();
    CHECK(first.sucked > 0.0);
    run.restore(*saved);
    CHECK(wound.sim.blood(wound.tissue) == then);
    CHECK(go() == first);
    run.restore(*saved);
    CHECK(go() == first);
}

TEST_CASE("a replay shows the blood of the run, to the byte")
{
    if (skipIf(!visual::hasBackend(Backend::Headless), "this build draws nothing")) return;
    const auto folder = std::filesystem::temp_directory_path() / text("filasofia_bleeding_test_", getpid());
    std::filesystem::create_directory(folder);
    const auto picture = [&](const char* name, bool bleeds) {
        Wound wound(1, bleeds);
        wound.sim.show(wound.tissue);
        wound.sim.everyStep([&wound, bleeds](double time) {
            if (bleeds && std::abs(time - 0.3) < 1e-9) wound.sim.treat(wound.tissue, Injure{{10_mm, 6_mm, 5_mm}, 5_mm});
        });
        wound.sim.run({.headless = true, .steps = 350, .picture = folder / name, .record = folder / "run.rec"});
        return visual::loadImage(folder / name).rgba;
    };
    const auto dry = picture("dry.png", false), wet = picture("wet.png", true);
    CHECK(wet != dry);
    replay({.file = folder / "run.rec", .picture = folder / "again.png"});
    CHECK(visual::loadImage(folder / "again.png").rgba == wet);
    std::filesystem::remove_all(folder);
}

TEST_CASE("a reset cleans and heals, also a wound without a cut")
{
    Wound wound;
    SteppedRun run(wound.sim);
    wound.sim.treat(wound.tissue, Injure{{10_mm, 6_mm, 0}, 5_mm});
    for (int i = 0; i < 60; ++i) run.step(); // the knife is not there yet
    CHECK(wound.sim.blood(wound.tissue).welled > 0.0);
    wound.sim.reset();
    for (int i = 0; i < 30; ++i) run.step();
    CHECK(wound.sim.blood(wound.tissue) == BloodBalance{});
}

TEST_CASE("an injury that reaches no surface is told once per body")
{
    const geometry::LogTrap log;
    Wound wound;
    SteppedRun run(wound.sim);
    wound.sim.treat(wound.tissue, Injure{{10_mm, 6_mm, 0}, 5_mm});
    for (int i = 0; i < 50; ++i) run.step();
    CHECK(log.lines.empty());
    for (int miss = 0; miss < 3; ++miss) {
        wound.sim.treat(wound.tissue, Injure{{1, 1, 1}, 1_mm});
        for (int i = 0; i < 50; ++i) run.step();
    }
    CHECK(log.lines ==
          "blood of 'tissue': Injure reaches nothing: no node of its surface is within 0.001 m of (1, 1, 1) m; "
          "later ones are not told\n");
}

TEST_CASE("wrong use of blood is one clear error")
{
    Wound wound(1, false);
    CHECK_THROWS_WITH(wound.sim.bleed(wound.knife), "bleeding of rigid body 'knife': needs a soft body with a surface");
    CHECK_THROWS_WITH(
        wound.sim.bleed(wound.tissue, {.viscosity = 0.0}),
        Catch::Contains("bleeding of soft body 'tissue': viscosity must be in [1e-04, 1000] Pa s, got 0"));
    CHECK_THROWS_WITH(wound.sim.treat(wound.tissue, Perfuse{0.0}), Catch::Contains("does not bleed"));
    wound.sim.bleed(wound.tissue);
    CHECK_THROWS_WITH(wound.sim.bleed(wound.tissue), Catch::Contains("it bleeds already"));
    CHECK_THROWS_WITH(wound.sim.treat(wound.tissue, Suck{.rate = -1.0}),
                      Catch::Contains("blood of 'tissue': rate must be >= 0 m^3/s, got -1"));
}

TEST_CASE("a film becomes marks: at nodes, and between those of its element that lie on the surface")
{
    const std::vector<float> film{2.5e-4F, 0.0F, surface::kNoSurface, 5e-4F};
    std::vector<visual::SurfaceState> states(5);
    states[1].blood = 0.9; // painted
    addBlood(mapping::IdentityMap{{0, 1, 2, 3, 9}}, film, states);
    CHECK(states[0].blood == Approx(1.0 - std::exp(-1.0)));
    CHECK(states[0].wetness == 1.0);
    CHECK(states[1].blood == 0.9);
    CHECK(states[2] == visual::SurfaceState{});
    CHECK(states[3].blood == Approx(1.0 - std::exp(-2.0)));
    CHECK(states[4] == visual::SurfaceState{}); // a node that the film does not know yet

    std::vector<visual::SurfaceState> inside(1);
    const geometry::Embedding embedding{{{0, 1, 2, 3}}, {{0.25, 0.25, 0.5, 0.0}}};
    addBlood(mapping::BarycentricMap{embedding}, film, inside);
    CHECK(inside[0].blood == Approx(1.0 - std::exp(-0.5)));
    const std::vector<float> heat{1.4F, -0.2F, surface::kNoSurface, 1.0F};
    CHECK(heatOf(mapping::BarycentricMap{embedding}, heat, 1)[0] == Approx(0.6));
    CHECK(heatOf(mapping::IdentityMap{{1, 2, 9}}, heat, 3) == std::vector<float>{-0.2F, -1.0F, -1.0F});
}

TEST_CASE("what is drawn of a body shows its film")
{
    ShownStage stage;
    const BodyId block = stage.addBlock();
    stage.bindings.show(block, {}, stage.physics);
    stage.step();
    const auto bloody = [&] {
        const auto& states = stage.drawn()[0]->states;
        return std::ranges::any_of(states, [](const visual::PackedState& each) { return each[0] > 0; });
    };
    CHECK(!bloody());
    stage.bindings.setFilms({{block, std::make_shared<const std::vector<float>>(60, 3e-4F)}}, {});
    stage.step();
    CHECK(bloody());
    stage.bindings.setFilms({{block, std::make_shared<const std::vector<float>>(60, 0.0F)}}, {});
    stage.step();
    CHECK(!bloody());
}

} // namespace bleeding_test
