#include "filasofia/prefab/instrument_tie.h"

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/runtime/stepped_run.h"
#include "prefab/tied_bars.h"

#include <catch2/catch.hpp>

#include <cstdio>
#include <numbers>
#include <utility>

namespace instrument_tie_test {

using namespace filasofia;
using Catch::Matchers::Contains;
using prefab::InstrumentTie;
using prefab::InstrumentTieDef;
using prefab::TiedBars;

namespace {

/// The long strand has 95 mm, the tail stands up and has 45 mm: each throw takes some of it.
constexpr std::array<Vec3, 2> kEnds{Vec3{-34.9_mm, 85.4_mm, 23.75_mm}, Vec3{37.7_mm, 30.2_mm, 0}};
constexpr std::array<Vec3, 2> kShortTail{kEnds[0], Vec3{27.4_mm, 19.6_mm, 0}}; ///< 30 mm long
constexpr std::array<Vec3, 2> kLongTail{kEnds[0], Vec3{48.2_mm, 41_mm, 0}};    ///< 60 mm long

InstrumentTieDef defOf(TiedBars& scene, std::vector<int> turns)
{
    const auto body = scene.sim.physics().def(scene.thread);
    const auto nodes = static_cast<int>(physics::centreLine(std::get<physics::RodBodyDef>(*body)).size());
    return {.thread = scene.thread,
            .nodes = {0, nodes - 8}, // the driver takes the tail 3 mm before its end
            .place = {0, 0.5_mm, 0},
            .turns = std::move(turns),
            .force = 1.0,
            .holding = 0.1,
            .speed = 0.2};
}

/// Ties the first throw, and returns where the thread's nodes then are [m].
std::vector<Vec3> tieFirstThrow(int turns, int threads)
{
    TiedBars scene(0.3, kEnds, false, {.physics = {.threads = threads}});
    InstrumentTie knot(scene.sim, defOf(scene, {turns}));
    runtime::SteppedRun run(scene.sim, {.backend = visual::Backend::Null});
    run.step();
    knot.begin();
    for (int i = 0; i < 12000 && knot.tied() == 0 && !knot.failed(); ++i) run.step();
    CHECK_FALSE(knot.failed());
    CHECK(knot.tied() == 1);
    std::printf("instrument tie: at most %.2f N on a strand\n", knot.largestForce());
    return scene.sim.physics().latest()->softBody(scene.thread)->positions;
}

struct Tied {
    double onShaft = 0.0; ///< [N] largest sum of normal forces of the thread on the driver
    bool failed = false;
};
Tied tieAndLoad(TiedBars& scene, std::vector<int> turns)
{
    InstrumentTie knot(scene.sim, defOf(scene, std::move(turns)));
    Tied tied;
    scene.tieAndLoad(knot, 2.0, 26000, [&](const frame::Frame& frame) {
        const BodyId driver = knot.driver().body();
        for (const frame::ContactPair& each : frame::contactPairs(frame.contacts))
            if (each.first == driver || each.second == driver) tied.onShaft = std::max(tied.onShaft, each.normalForce);
    });
    tied.failed = knot.failed();
    return tied;
}

} // namespace

TEST_CASE("the determinant tells a knot from strands that wind around each other")
{
    const auto line = [](auto point) {
        std::vector<Vec3> points;
        for (int i = 0; i < 200; ++i) points.push_back(point(2.0 * std::numbers::pi * i / 200.0));
        return points;
    };
    using std::cos, std::sin;
    const auto circle = line([](double t) { return Vec3{cos(t), sin(t), 0.1 * cos(3 * t)}; });
    const auto curl = line([](double t) { return Vec3{cos(t) + 2 * cos(2 * t), sin(t) + 2 * sin(2 * t), sin(t)}; });
    const auto trefoil = line([](double t) {
        return Vec3{sin(t) + 2 * sin(2 * t), cos(t) - 2 * cos(2 * t), -sin(3 * t)};
    });
    const auto figureEight = line([](double t) {
        return Vec3{(2 + cos(2 * t)) * cos(3 * t), (2 + cos(2 * t)) * sin(3 * t), sin(4 * t)};
    });
    CHECK(geometry::knotDeterminant(circle) == 1);
    CHECK(geometry::knotDeterminant(curl) == 1);
    CHECK(geometry::knotDeterminant(trefoil) == 3);
    CHECK(geometry::knotDeterminant(figureEight) == 5);
}

TEST_CASE("a throw of two turns around an instrument is a knot")
{
    CHECK(geometry::knotDeterminantOpen(tieFirstThrow(2, 1), {1, 0, 0}, {0, 1, 0}) == 5);
}

TEST_CASE("a throw around an instrument has the same bits again and with two threads", "[long]")
{
    const std::vector<Vec3> once = tieFirstThrow(1, 1);
    CHECK(geometry::knotDeterminantOpen(once, {1, 0, 0}, {0, 1, 0}) == 3);
    CHECK(once == tieFirstThrow(1, 1));
    CHECK(once == tieFirstThrow(1, 2));
}

TEST_CASE("two throws of one turn that an instrument ties are a square knot", "[long]")
{
    TiedBars scene(0.3, kEnds, false);
    const Tied tied = tieAndLoad(scene, {1, 1});
    std::printf("instrument tie, two throws of one turn: at most %.2f N on a strand\n", scene.hardest);
    CHECK_FALSE(tied.failed);
    CHECK(scene.passes == 0);
    CHECK(scene.determinants == std::vector<int>{3, 9});
}

TEST_CASE("a tail that is too short for the way through the loops is given up before it is drawn")
{
    TiedBars scene(0.3, kShortTail, false);
    InstrumentTie knot(scene.sim, defOf(scene, {2}));
    runtime::SteppedRun run(scene.sim, {.backend = visual::Backend::Null});
    std::string logged;
    setLogSink([&](LogLevel, std::string_view line) { logged = line; });
    run.step();
    knot.begin();
    for (int i = 0; i < 2000 && !knot.failed(); ++i) run.step();
    setLogSink({});
    CHECK(knot.failed());
    CHECK_THAT(logged, Contains("instrument tie 'instrument tie', throw 1: of the tail ") && Contains("must"));
    CHECK(knot.largestForce() < 0.2);
}

TEST_CASE("a tail that does not come through the loops is drawn with no more than the force, and given up", "[long]")
{
    const double speed = GENERATE(0.0, 0.07); // [m/s], the driver's when the tail gets stuck
    TiedBars scene(0.3, kEnds, false);
    InstrumentTie knot(scene.sim, defOf(scene, {1}));
    runtime::SteppedRun run(scene.sim, {.backend = visual::Backend::Null});
    run.step();
    knot.begin();
    bool stuck = false;
    for (int i = 0; i < 12000 && knot.tied() == 0 && !knot.failed(); ++i) {
        const Vec3 before = knot.driver().pose().position;
        run.step();
        const bool fast = distance(knot.driver().pose().position, before) >= 1e-3 * speed;
        if (!knot.driver().holding() || !fast || std::exchange(stuck, true)) continue;
        const int nodes = static_cast<int>(scene.sim.physics().latest()->softBody(scene.thread)->positions.size());
        scene.sim.physics().attach(scene.thread, {.nodes = {nodes - 20}}); // 5 mm from the jaws
    }
    std::printf("instrument tie, a tail that gets stuck at %.2f m/s: at most %.3f N on a strand\n", speed,
                knot.largestForce());
    CHECK(stuck);
    CHECK(knot.failed());
    CHECK(knot.largestForce() == Approx(1.0).margin(0.1));
}

TEST_CASE("throws of two, one and one turns that an instrument ties are a surgeon's knot, and none is drawn too hard",
          "[long]")
{
    const bool more = GENERATE(false, true);
    TiedBars scene(0.3, more ? kLongTail : kEnds, false);
    std::vector<std::string> lines;
    setLogSink([&](LogLevel, std::string_view line) { lines.emplace_back(line); });
    const Tied tied = tieAndLoad(scene, {2, 1, 1});
    setLogSink({});
    REQUIRE(scene.throws == 3);
    REQUIRE(scene.loaded.size() > 50);
    CHECK_FALSE(tied.failed);
    CHECK(scene.passes == 0);
    CHECK(scene.determinants == std::vector<int>{5, 15, 45});
    CHECK(scene.hardest < 1.1);
    for (const std::string& line : lines) CHECK_THAT(line, !Contains("it may not be tight"));
    const double slip = scene.loaded.back() - scene.loaded.front();
    std::printf(
        "instrument tie, three throws, tail of %d mm: tied at %.2f s; at most %.2f N on a strand, %.2f N on the "
        "driver; bars come apart by %.3f mm in 100 ms under 2 N\n",
        more ? 60 : 45, scene.sim.physics().latest()->time - 0.75, scene.hardest, tied.onShaft, 1e3 * slip);
    CHECK(scene.force > 1.8);
    CHECK(slip < 0.15_mm);
}

TEST_CASE("throws of two turns and one that an instrument ties around two bars hold 2 N with a friction of 0.3",
          "[long]")
{
    TiedBars scene(0.3, kEnds, false);
    const Tied tied = tieAndLoad(scene, {2, 1});
    CHECK_FALSE(tied.failed);
    REQUIRE(scene.throws == 2);
    REQUIRE(scene.loaded.size() > 50);
    CHECK(scene.passes == 0);
    // Each throw winds the strands around each other half a turn more often than the shaft, as far as they lie in one
    // line, and the second one the other way: a square knot, no granny.
    REQUIRE(scene.windings.size() == 2);
    CHECK(scene.determinants == std::vector<int>{5, 15}); // strands may wind around each other and form no knot
    const double first = scene.windings[0], second = scene.windings[1] - first;
    const double slip = scene.loaded.back() - scene.loaded.front();
    std::printf(
        "instrument tie: its throws wind strands by %.2f, %.2f turns; at most %.2f N on a strand, %.2f N on the "
        "driver; bars come apart by %.3f mm in 100 ms under 2 N\n",
        first, second, scene.hardest, tied.onShaft, 1e3 * slip);
    CHECK(std::abs(first) == Approx(2.25).margin(0.4));
    CHECK(std::copysign(second, first * second) == Approx(-1.25).margin(0.5));
    CHECK(scene.hardest < 1.1);
    CHECK(scene.force > 1.8);
    CHECK(slip < 0.15_mm);
}

TEST_CASE("the same throws come off with a friction of 0.02", "[long]")
{
    const auto turns = GENERATE(std::vector<int>{2, 1}, std::vector<int>{2, 1, 1});
    TiedBars scene(0.02, kEnds, false);
    const Tied tied = tieAndLoad(scene, turns);
    REQUIRE(scene.throws == std::ssize(turns));
    CHECK(scene.passes == 0);
    const double slip = scene.loaded.back() - scene.loaded.front();
    std::printf("instrument tie, friction 0.02, %d throws: at most %.2f N on the driver; bars come apart by %.3f mm\n",
                scene.throws, tied.onShaft, 1e3 * slip);
    CHECK(slip > 1_mm);
}

TEST_CASE("a wrong tie is one error that names what is wrong")
{
    TiedBars scene(0.3, kEnds, false);
    const auto refused = [&](auto change, const std::string& message) {
        InstrumentTieDef def = defOf(scene, {1});
        change(def);
        CHECK_THROWS_WITH(InstrumentTie(scene.sim, def), Contains(message));
    };
    refused([](InstrumentTieDef& def) { def.nodes = {4}; },
            "instrument tie 'instrument tie': nodes must be two or none, got 1");
    refused([](InstrumentTieDef& def) { def.turns = {}; }, "turns must have one to three entries, got 0");
    refused([](InstrumentTieDef& def) { def.turns = {2, 1, 1, 1}; }, "turns must have one to three entries, got 4");
    refused([](InstrumentTieDef& def) { def.turns = {0}; }, "turns");
    refused([](InstrumentTieDef& def) { def.turns = {3}; }, "turns");
    refused([](InstrumentTieDef& def) { def.turns = {2, 2}; }, "turns[1] must be 1, got 2");
    refused([](InstrumentTieDef& def) { def.turns = {2, 1, 2}; }, "turns[2] must be 1, got 2");
    refused([](InstrumentTieDef& def) { def.across = {0, 2, 0}; }, "up and across must not be parallel");
    refused([](InstrumentTieDef& def) { def.driver.grasps = false; }, "driver.grasps must be true, got false");
    refused([](InstrumentTieDef& def) { def.thread = BodyId{1}; }, "thread must be a rod, got");
}

} // namespace instrument_tie_test
