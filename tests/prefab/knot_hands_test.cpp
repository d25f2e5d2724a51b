#include "filasofia/prefab/knot_hands.h"

#include "filasofia/core/error.h"
#include "filasofia/core/units.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/prefab/knot_plan.h"
#include "filasofia/runtime/stepped_run.h"
#include "filasofia/testing/linking.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

namespace knot_hands_test {

using namespace filasofia;
using prefab::KnotDef;
using prefab::KnotHands;
using runtime::Simulation;

namespace {

/// Two bars, and a thread below both whose ends stand up. Hands tie it above them; then the bars are drawn apart.
class TiedBars {
public:
    explicit TiedBars(double friction, bool crossed = false)
    {
        for (const int i : {0, 1}) {
            physics::RigidBodyDef bar{.name = i == 0 ? "left bar" : "right bar", .elements = {poseOf(i)}};
            bar.mesh = geometry::shapes::cylinder(2_mm, 40_mm, 64);
            bar.collision = {{.proximity = 0.1_mm}};
            bar.friction = 0.05;
            bars_[static_cast<std::size_t>(i)] = sim.add(bar);
        }
        physics::RodBodyDef def{.name = "thread", .spacing = 0.4_mm, .radius = 0.15_mm, .youngModulus = 50_MPa};
        def.points = {{-21.4_mm, 50_mm, 0}, {-6.4_mm, -2_mm, 0},  {-5.8_mm, -3.8_mm, 0}, {-4_mm, -4.5_mm, 0},
                      {4_mm, -4.5_mm, 0},   {5.8_mm, -3.8_mm, 0}, {6.4_mm, -2_mm, 0},    {15.4_mm, 30_mm, 0}};
        if (crossed) {
            def.points.front() = {15_mm, 50_mm, 4_mm};
            def.points.back() = {-10_mm, 30_mm, -4_mm};
        }
        def.attachments = {{.ball = physics::Ball{{0, -4.5_mm, 0}, 0.3_mm}}};
        def.gravity = false;
        def.yieldStrain = 0.1;
        def.rayleigh.mass = 20.0; // the air
        def.friction = friction;
        def.collision = physics::RodCollision{};
        thread = sim.add(def);
    }
    KnotDef def() const
    {
        return {.thread = thread, .place = {0, 0.5_mm, 0}, .force = 0.6, .holding = 0.15, .speed = 0.2};
    }

    /// Ties, lets go, and draws the bars apart, as fast as 20 mm/s and with so much force [N] each, for 0.5 s.
    void tieAndLoad(double load)
    {
        KnotHands knot(sim, def());
        double tied = 1e9;
        sim.everyStep([&](double time) {
            const auto frame = sim.physics().latest();
            if (!frame) return;
            if (time > 0.01) knot.begin();
            count(*frame);
            if (knot.tied() > std::ssize(windings)) windings.push_back(winding());
            if (knot.done()) tied = std::min(tied, time);
            if (time > tied + 0.1) knot.release();
            if (time > tied + 0.15) pull(*frame, load);
            if (time > tied + 0.65) loaded.push_back(distance(place_[0], place_[1]));
            if (time > tied + 0.75) sim.finish("loaded");
        });
        sim.run({.headless = true, .backend = visual::Backend::Null, .steps = 12000});
        throws = knot.tied();
        hardest = knot.largestForce();
    }

    Simulation sim;
    BodyId thread = {};
    int throws = 0, passes = 0;
    double hardest = 0.0;
    std::vector<double> windings; ///< [-] how often the strands wind around each other, after each throw
    std::vector<double> loaded;   ///< [m] between the bars under load, from step to step
    double force = 0.0;           ///< [N] on the left bar, in the last step

private:
    Pose poseOf(int bar) const { return {place_[static_cast<std::size_t>(bar)], axisAngle({1, 0, 0}, 90_deg)}; }
    void count(const frame::Frame& frame)
    {
        const std::vector<Vec3>& now = frame.softBody(thread)->positions;
        if (!before_.empty()) passes += std::abs(passes_.count({before_, now}, {before_, now}));
        before_ = now;
    }
    [[nodiscard]] double winding() const
    {
        double sum = 0.0;
        const std::size_t middle = before_.size() / 2;
        for (std::size_t i = 1; i < middle; ++i)
            for (std::size_t k = middle + 1; k < before_.size(); ++k)
                sum += testing::gaussIntegral(before_[i - 1], before_[i], before_[k - 1], before_[k]);
        return sum / (4.0 * std::numbers::pi);
    }
    void pull(const frame::Frame& frame, double load)
    {
        for (const int i : {0, 1}) {
            const BodyId bar = bars_[static_cast<std::size_t>(i)];
            double across = 0.0;
            for (const frame::Contact& each : frame.contacts)
                if (each.first == bar || each.second == bar) across += std::abs(each.normal.x) * each.normalForce;
            if (i == 0) force = across;
            place_[static_cast<std::size_t>(i)].x +=
                (i == 0 ? -1.0 : 1.0) * std::clamp((load - across) / 3000.0, -2e-5, 2e-5);
            sim.physics().setPose(bar, poseOf(i));
        }
    }

    std::array<BodyId, 2> bars_ = {};
    std::array<Vec3, 2> place_ = {Vec3{-4_mm, -2_mm, 0}, Vec3{4_mm, -2_mm, 0}};
    std::vector<Vec3> before_;
    testing::PassCounter passes_;
};

} // namespace

TEST_CASE("a surgeon's knot that hands tie around two bars holds 2 N with a friction of 0.3", "[long]")
{
    TiedBars scene(0.3);
    scene.tieAndLoad(2.0);
    REQUIRE(scene.throws == 3);
    REQUIRE(scene.loaded.size() > 50);
    CHECK(scene.passes == 0);
    CHECK(scene.hardest < 1.0);
    // A throw winds its strands around each other about as often as it has loops, and each the other way than that
    // before: a square knot, no granny.
    REQUIRE(scene.windings.size() == 3);
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
    TiedBars scene(0.02);
    scene.tieAndLoad(2.0);
    REQUIRE(scene.throws == 3);
    CHECK(scene.passes == 0);
    CHECK(scene.loaded.back() - scene.loaded.front() > 2_mm);
}

TEST_CASE("hands that come between two steps of a stepped run tie")
{
    TiedBars scene(0.3);
    runtime::SteppedRun run(scene.sim, {.backend = visual::Backend::Null});
    run.step();
    KnotHands knot(scene.sim, scene.def());
    run.step();
    knot.begin();
    for (int i = 0; i < 12000 && knot.tied() == 0; ++i) run.step();
    CHECK(knot.tied() == 1);
}

TEST_CASE("strands whose ends have crossed come up on the sides where they leave the tissue")
{
    TiedBars scene(0.3, true);
    KnotHands knot(scene.sim, scene.def());
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

TEST_CASE("a wrong knot is one error that names what is wrong")
{
    TiedBars scene(0.3);
    const auto refused = [&](auto change, const std::string& message) {
        KnotDef def = scene.def();
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
    refused([](KnotDef& def) { def.force = -1.0; }, "knot 'knot': force must be");
    refused([](KnotDef& def) { def.thread = BodyId{1}; }, "knot 'knot': thread must be a rod, got");
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
