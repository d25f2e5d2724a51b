#include "filasofia/prefab/knot_hands.h"

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/core/units.h"
#include "filasofia/prefab/knot_plan.h"
#include "filasofia/runtime/stepped_run.h"
#include "prefab/tied_bars.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

namespace knot_hands_test {

using namespace filasofia;
using prefab::KnotDef;
using prefab::KnotHands;
using prefab::TiedBars;

namespace {
/// The strands stand up beside the bars.
constexpr std::array<Vec3, 2> kApart{Vec3{-21.4_mm, 50_mm, 0}, Vec3{15.4_mm, 30_mm, 0}};
constexpr std::array<Vec3, 2> kCrossed{Vec3{15_mm, 50_mm, 4_mm}, Vec3{-10_mm, 30_mm, -4_mm}};

KnotDef defOf(const TiedBars& scene)
{
    return {.thread = scene.thread, .place = {0, 0.5_mm, 0}, .force = 0.6, .holding = 0.15, .speed = 0.2};
}
void tieAndLoad(TiedBars& scene)
{
    KnotHands knot(scene.sim, defOf(scene));
    scene.tieAndLoad(knot, 2.0, 12000, [](const frame::Frame&) {});
}

} // namespace

TEST_CASE("a surgeon's knot that hands tie around two bars holds 2 N with a friction of 0.3", "[long]")
{
    TiedBars scene(0.3, kApart);
    tieAndLoad(scene);
    REQUIRE(scene.throws == 3);
    REQUIRE(scene.loaded.size() > 50);
    CHECK(scene.passes == 0);
    CHECK(scene.hardest < 1.0);
    // A throw winds its strands around each other about as often as it has loops, and each the other way than that
    // before: a square knot, no granny.
    REQUIRE(scene.windings.size() == 3);
    CHECK(scene.determinants == std::vector<int>{5, 15, 45});
    const double first = scene.windings[0], second = scene.windings[1] - first,
                 third = scene.windings[2] - scene.windings[1], sense = std::copysign(1.0, first);
    std::printf("knot of hands: its throws wind strands by %.2f, %.2f, %.2f turns\n", first, second, third);
    CHECK(sense * first == Approx(2.2).margin(0.4));
    CHECK(sense * second == Approx(-1.25).margin(0.5));
    CHECK(sense * third == Approx(1.25).margin(0.5));
    CHECK(scene.force > 1.8);
    std::printf("knot of hands: bars come apart by %.3f mm in 100 ms under 2 N\n",
                1e3 * (scene.loaded.back() - scene.loaded.front()));
    CHECK(scene.loaded.back() - scene.loaded.front() < 0.15_mm);
}

TEST_CASE("the same knot comes off with a friction of 0.02", "[long]")
{
    TiedBars scene(0.02, kApart);
    tieAndLoad(scene);
    REQUIRE(scene.throws == 3);
    CHECK(scene.passes == 0);
    CHECK(scene.loaded.back() - scene.loaded.front() > 2_mm);
}

TEST_CASE("hands that come between two steps of a stepped run tie")
{
    TiedBars scene(0.3, kApart);
    runtime::SteppedRun run(scene.sim, {.backend = visual::Backend::Null});
    run.step();
    KnotHands knot(scene.sim, defOf(scene));
    run.step();
    knot.begin();
    for (int i = 0; i < 12000 && knot.tied() == 0; ++i) run.step();
    CHECK(knot.tied() == 1);
}

TEST_CASE("strands whose ends have crossed come up on the sides where they leave the tissue")
{
    TiedBars scene(0.3, kCrossed);
    KnotHands knot(scene.sim, defOf(scene));
    runtime::SteppedRun run(scene.sim, {.backend = visual::Backend::Null});
    run.step();
    const auto x = [&](int hand) {
        return scene.sim.physics().latest()->rigidBody(knot.hand(hand))->poses[0].position.x;
    };
    knot.begin();
    run.step();
    run.step();
    CHECK(x(1) < -9_mm); // the end of the strand from the right bar
    for (int i = 0; i < 400; ++i) run.step();
    CHECK(x(1) > 5_mm);
}

TEST_CASE("throws that make no knot are not tied, and that is told")
{
    // Hands that held a straight thread at two neighbours went through all motions, and counted three throws.
    runtime::Simulation sim;
    physics::RodBodyDef thread{.name = "thread", .points = {{-50_mm, 5_mm, 0}, {50_mm, 5_mm, 0}}, .gravity = false};
    thread.spacing = 1_mm;
    thread.radius = 0.15_mm;
    thread.collision = physics::RodCollision{};
    KnotHands knot(sim, {.thread = sim.add(thread), .nodes = {50, 51}, .speed = 0.5, .patience = 0.1});
    std::vector<std::string> told;
    setLogSink([&](LogLevel, std::string_view line) { told.emplace_back(line); });
    knot.begin();
    sim.everyStep([&](double) {
        if (knot.done()) sim.finish("done");
    });
    sim.run({.headless = true, .backend = visual::Backend::Null, .steps = 9000});
    setLogSink({});
    CHECK(knot.done());
    CHECK(knot.tied() == 0);
    CHECK(std::ranges::count_if(told, [](const std::string& line) {
              return line.find("is not tied: with it the thread forms no knot (determinant 1 in place of ") !=
                     line.npos;
          }) == 3);
}

TEST_CASE("a wrong knot is one error that names what is wrong")
{
    TiedBars scene(0.3, kApart);
    const auto refused = [&](auto change, const std::string& message) {
        KnotDef def = defOf(scene);
        change(def);
        CHECK_THROWS_WITH(KnotHands(scene.sim, def), Catch::Matchers::Contains(message));
    };
    refused([](KnotDef& def) { def.nodes = {0, 100000}; }, "knot 'knot': nodes must be in [0, ");
    refused([](KnotDef& def) { def.nodes = {4}; }, "knot 'knot': nodes must be two or none, got 1");
    refused([](KnotDef& def) { def.nodes = {4, 4}; }, "knot 'knot': nodes must differ, got twice 4");
    refused([](KnotDef& def) { def.turns = {}; }, "knot 'knot': turns must have at least one entry, got none");
    refused([](KnotDef& def) { def.turns = {0}; }, "knot 'knot': turns");
    refused([](KnotDef& def) { def.across = {0, 2, 0}; }, "knot 'knot': up and across must not be parallel");
    refused([](KnotDef& def) { def.height = 1_mm; }, "knot 'knot': height must be > loop = 0.0015 m, got 0.001");
    refused([](KnotDef& def) { def.loop = 0.05_mm; }, "knot 'knot': loop must be >= the thread's thickness = ");
    refused([](KnotDef& def) { def.force = -1.0; }, "knot 'knot': force must be");
    refused([](KnotDef& def) { def.thread = BodyId{1}; }, "knot 'knot': thread must be a rod, got");
    physics::RodBodyDef ring{.name = "ring", .points = {{0, 0, 0}, {50_mm, 0, 0}, {50_mm, 50_mm, 0}, {0, 50_mm, 0}}};
    ring.closed = true;
    ring.spacing = 2_mm;
    const BodyId closed = scene.sim.add(ring);
    refused([&](KnotDef& def) { def.thread = closed; }, "knot 'knot': thread must have ends, got rod 'ring', a ring");
}

TEST_CASE("the second strand goes through loops that wind about its way, and against them")
{
    using namespace prefab;
    const KnotFrame frame{
        .across = {1, 0, 0}, .up = {0, 1, 0}, .front = {0, 0, 1}, .loop = 1.5_mm, .pitch = 1_mm, .height = 8_mm};
    for (const double side : {-1.0, 1.0}) {
        const Throw made{.turns = 2, .side = side};
        const std::vector<Vec3> loops = loopsOf(frame, made, 1.0), straight = loopsOf(frame, made, 0.0);
        REQUIRE(loops.size() == 17);
        double angle = 0.0;
        for (std::size_t i = 1; i < loops.size(); ++i) {
            CHECK(distance(loops[i], loops[i - 1]) == Approx(fingerStep(frame)));
            CHECK(distance(straight[i], straight[i - 1]) == Approx(fingerStep(frame)));
            const auto at = [&](std::size_t k) { return std::atan2(loops[k].y - 8_mm, loops[k].z); };
            angle += std::remainder(at(i) - at(i - 1), 2.0 * std::numbers::pi);
        }
        CHECK(angle == Approx(-4.0 * std::numbers::pi));
        const std::vector<Vec3> way = wayThrough(frame, made);
        CHECK((way.back().x - way.front().x) * (loops.back().x - loops.front().x) < 0.0);
    }
}

} // namespace knot_hands_test
