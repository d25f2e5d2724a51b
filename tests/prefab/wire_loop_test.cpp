#include "filasofia/prefab/wire_loop.h"

#include "filasofia/core/error.h"
#include "filasofia/core/units.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/prefab/scope_hands.h"
#include "filasofia/runtime/stepped_run.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

namespace wire_loop_test {

using namespace filasofia;
using namespace filasofia::prefab;
using runtime::RunReport;
using runtime::Simulation;

namespace {

constexpr double kRate = 500, kSpeed = 0.02;                      // [Hz], [m/s]
constexpr int kWhole = 450;                                       ///< steps until it has left the tissue
constexpr double kLength = 12e-3, kTop = 3e-3, kDensity = 1000.0; // [m], [kg/m^3]

/// A block whose lower side is held, and a loop that is drawn along it, towards the scope.
struct Theatre {
    Simulation sim;
    BodyId tissue;
    WireLoop loop;
    double depth;         ///< [m], the loop's bottom below the tissue's top
    double until = 10_mm; ///< [m]
    double begin = 0.0;   ///< [s]
    double mass = 0.0;    ///< [kg], all that came off
    int chips = 0;

    explicit Theatre(double deep, int threads = 1)
        : sim(runtime::SimulationDef{.physics = {.rate = kRate, .gravity = {}, .threads = threads}}),
          tissue(addTissue()), loop(sim, {.pose = {{0, 20_mm, -10_mm}, {}}, .proximity = 0.1_mm}), depth(deep)
    {
        sim.burn(tissue, {.rate = 50});
        sim.everyStep([this](double time) {
            const double z = std::min(-8_mm + kSpeed * (time - begin), until);
            loop.move({{0, kTop - depth + loop.def().depth, z}, {}});
        });
        sim.on<runtime::CutEvent>([this](const runtime::CutEvent& cut) {
            for (const physics::LoosePiece& each : cut.rupture.detached) {
                mass += each.mass;
                ++chips;
            }
        });
    }
    BodyId addTissue()
    {
        physics::SoftBodyDef def{.name = "tissue",
                                 .mesh = geometry::shapes::block({14_mm, 2 * kTop, kLength}, {14, 6, 12}),
                                 .dynamicTopology = true};
        def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, -2.9_mm, 1}}}};
        def.mass = physics::Density{kDensity};
        def.collision = {{.proximity = 0.1_mm, .selfOnceCut = false}};
        return sim.add(def);
    }
    /// From its start once more, deeper.
    void again(double deep)
    {
        loop.cut(false);
        depth = -10_mm; // above the tissue
        run(1);
        begin = sim.physics().latest()->time;
        run(1);
        depth = deep;
        loop.cut(true);
    }
    RunReport run(int steps) { return sim.run({.headless = true, .backend = visual::Backend::Null, .steps = steps}); }
};

/// [m^2] The part of the loop's area that is up to `deep` [m] above its bottom.
double areaBelow(double deep, double width)
{
    const double r = 0.5 * width;
    if (deep >= r) return 0.5 * std::numbers::pi * r * r + width * (deep - r);
    return r * r * std::acos(1.0 - deep / r) - (r - deep) * std::sqrt(2.0 * r * deep - deep * deep);
}

} // namespace

TEST_CASE("a loop with current shaves off a chip of its own cross-section, as long as the tissue")
{
    for (const double depth : {1.5_mm, 2.4_mm, 3.5_mm}) {
        Theatre theatre(depth);
        theatre.loop.cut(true);
        const RunReport report = theatre.run(kWhole);
        const double expected = areaBelow(depth, theatre.loop.def().width) * kLength;
        INFO("depth " << depth << ", chips " << theatre.chips);
        CHECK(theatre.mass / kDensity == Approx(expected).epsilon(0.15)); // +1, -10 and +1 % were measured
        CHECK(report.heat.at(0).balance.burnt > 10e-6);
        const auto energy = theatre.sim.energy(theatre.loop.body(), WireLoop::kCuts);
        CHECK(energy.delivered == Approx(60.0 * (energy.active - energy.inAir)).epsilon(0.02));
        CHECK(energy.inAir < 0.75 * energy.active);
    }
}

TEST_CASE("a second stroke below the first takes a chip off, though its sides follow those of the first")
{
    Theatre theatre(2.4_mm);
    theatre.loop.cut(true);
    theatre.run(kWhole);
    const double first = theatre.mass;
    CHECK(theatre.chips == 1);
    theatre.again(3.9_mm);
    theatre.run(kWhole);
    const double width = theatre.loop.def().width;
    const double expected = (areaBelow(3.9_mm, width) - areaBelow(2.4_mm, width)) * kLength;
    CHECK((theatre.mass - first) / kDensity == Approx(expected).epsilon(0.2));
}

TEST_CASE("without current a loop cuts nothing and pushes, and with that which coagulates it only heats")
{
    struct Went {
        double cut = 0.0, delivered = 0.0, push = 0.0;
    };
    const auto go = [](bool cuts, bool dries) {
        Theatre theatre(2.4_mm);
        theatre.until = -4_mm; // 2 mm into it
        theatre.loop.cut(cuts);
        theatre.loop.dry(dries);
        const RunReport report = theatre.run(200);
        double push = 0.0;
        for (const auto& each : theatre.sim.physics().latest()->contacts) push += each.normalForce;
        return Went{report.cutArea(), report.heat.at(0).balance.delivered, push};
    };
    const Went cold = go(false, false), cut = go(true, false), dried = go(false, true);
    CHECK(cold.cut == 0.0);
    CHECK(cold.delivered == 0.0);
    CHECK(cold.push > 0.01);
    CHECK(cut.cut > 3e-6);
    CHECK(cut.delivered > 1.0);
    CHECK(cut.push == 0.0);
    CHECK(dried.cut == 0.0);
    CHECK(dried.delivered > 0.5);
    CHECK(dried.push > 0.01);
}

TEST_CASE("a loop leaves a chip hanging where its pedal is released, and has the same bits for any number of threads")
{
    const auto go = [](int threads) {
        Theatre theatre(2.4_mm, threads);
        theatre.loop.cut(true);
        theatre.sim.everyStep([&](double time) { theatre.loop.cut(time < 0.35); }); // 1 mm behind the middle
        const RunReport report = theatre.run(300);
        CHECK(theatre.chips == 0);
        CHECK(report.cutArea() > 30e-6);
        return report;
    };
    const RunReport one = go(1), two = go(2);
    CHECK(one.hash == two.hash);
    CHECK(one.energy.at(0).balance == two.energy.at(0).balance);
    CHECK(one.heat.at(0).balance == two.heat.at(0).balance);
}

TEST_CASE("a loop is as wide and as deep as it says, and its electrodes follow its wire")
{
    Simulation sim;
    const WireLoop loop(sim, {.width = 5_mm, .depth = 4_mm});
    double low = 0.0, half = 0.0;
    for (const Vec3& each : loop.line()) {
        low = std::min(low, each.y);
        half = std::max(half, std::abs(each.x));
    }
    CHECK(low == Approx(-4_mm));
    CHECK(half == Approx(2.5_mm));
    CHECK(distance(loop.line().front(), {-2.5_mm, 0, 0}) < 1e-12);
    CHECK(distance(loop.line().back(), {2.5_mm, 0, 0}) < 1e-12);
    CHECK(sim.electrodes(loop.body()) == 2);
    const WireLoop half2(sim, {.name = "half a circle", .width = 6_mm, .depth = 3_mm});
    CHECK(half2.line().size() == 13);
    const WireLoop none(sim, {.name = "none", .groups = {}});
    CHECK(sim.electrodes(none.body()) == 0);
}

TEST_CASE("hands slide a loop out of the scope, and its pedals are pressed as long as their keys")
{
    Simulation sim;
    Endoscope scope(sim, {.groups = {}});
    WireLoop loop(sim);
    ScopeHands hands(sim, scope, loop, {.start = {.aim = {0, 0, -1}}});
    const auto run = [&](int steps) { sim.run({.headless = true, .backend = visual::Backend::Null, .steps = steps}); };
    const auto key = [&](event::KeyCode code, bool pressed) {
        event::KeyEvent event;
        event.key = code;
        event.pressed = pressed;
        sim.post(event);
    };
    for (int i = 0; i < 10; ++i) key(event::KeyCode::W, true); // 7 mm out
    run(1000);
    CHECK(distance(loop.pose().position, scope.channel().position) == Approx(7_mm).epsilon(1e-3));
    for (const auto& [code, electrode] :
         {std::pair(event::KeyCode::G, WireLoop::kCuts), {event::KeyCode::B, WireLoop::kDries}}) {
        key(code, true);
        run(100);
        key(code, false);
        run(100);
        CHECK(sim.energy(loop.body(), electrode).active == Approx(0.1).margin(2e-3));
    }
    hands.play({{.seconds = 0.1, .to = {.aim = {0, 0, -1}, .reach = 12_mm}}});
    run(200);
    CHECK(distance(loop.pose().position, scope.channel().position) == Approx(12_mm).epsilon(1e-5));
}

TEST_CASE("a saved state has where a loop is")
{
    Simulation sim;
    WireLoop loop(sim);
    runtime::SteppedRun run(sim);
    loop.move({{1_mm, 2_mm, 3_mm}, {}});
    for (int i = 0; i < 5; ++i) run.step();
    const auto saved = run.save();
    loop.move({{5_mm, 0, 0}, {}});
    for (int i = 0; i < 5; ++i) run.step();
    run.restore(*saved);
    CHECK(loop.pose().position == Vec3{1_mm, 2_mm, 3_mm});
}

TEST_CASE("wrong loops are one clear error")
{
    Simulation sim;
    const auto add = [&](const WireLoopDef& def) { WireLoop loop(sim, def); };
    CHECK_THROWS_WITH(add({.width = 0.0}), "wire loop 'loop': width must be > 0 m, got 0");
    CHECK_THROWS_WITH(add({.name = "hook", .width = 10_mm}),
                      "wire loop 'hook': depth must be >= width / 2 (0.005 m), got 0.004 m");
    CHECK_THROWS_WITH(add({.cutting = -1.0}), Catch::Contains("cutting must be in (0, 1000000] W, got -1"));
    CHECK_THROWS_WITH(add({.drying = std::nan("")}), Catch::Contains("drying must be"));
    CHECK_THROWS_WITH(add({.reach = 2.0}), Catch::Contains("reach must be in (0, 1] m, got 2"));
    WireLoop loop(sim);
    CHECK_THROWS_WITH(loop.move({{std::nan(""), 0, 0}, {}}), Catch::Contains("wire loop 'loop'"));
}

} // namespace wire_loop_test
