#include "engine/stage.h"
#include "filasofia/geometry/shapes.h"

#include <cmath>

namespace tie_bodies_test {

using namespace filasofia;
using namespace filasofia::engine;
using geometry::Box;
using physics::AttachmentDef;

namespace {

constexpr double kDt = 2e-3; // [s]

/// Liver, layer and organ, one upon the other, or one block of their size. A hand pulls at the top.
struct Pile {
    Stage stage;
    BodyId hand, liver, organ;
    double time = 0.0;

    /// `stiffness` [N/m] of what ties the blocks to each other; 0: one block
    explicit Pile(double stiffness, int threads = 1) : stage({.period = kDt, .threads = threads})
    {
        stage.world.scene().gravity = {0.0, -9.81, 0.0};
        hand = stage.add(physics::RigidBodyDef{.name = "hand", .elements = {{{0, 0.03, 0}, {}}}});
        const AttachmentDef ground{.box = Box{{-1, -1, -1}, {1, -0.0199, 1}}};
        const AttachmentDef pulled{.box = Box{{-1, 0.0124, -1}, {-0.02, 1, 1}}, .to = hand};
        if (stiffness == 0.0) {
            block("one", -0.00375, 0.0325, 8, 8e3, {ground, pulled});
            return;
        }
        liver = block("liver", -0.01, 0.02, 4, 8e3, {ground});
        organ = block("organ", 0.0075, 0.01, 3, 25e3, {pulled});
        block("layer", 0.00125, 0.0025, 1, 4e3,
              {{.within = 3e-4, .stiffness = stiffness, .to = liver},
               {.within = 3e-4, .stiffness = stiffness, .to = organ}});
    }

    BodyId block(const char* name, double y, double height, int cells, double young,
                 std::vector<AttachmentDef> attachments)
    {
        return stage.add(
            physics::SoftBodyDef{.name = name,
                                 .mesh = geometry::shapes::block({0.06, height, 0.04}, {12, cells, 8}),
                                 .pose = {{0, y, 0}, {}},
                                 .material = physics::FemMaterial{.youngModulus = young, .poissonRatio = 0.45},
                                 .attachments = std::move(attachments)});
    }
    physics::StepReport step()
    {
        time += kDt;
        stage.post(physics::SetPose{hand, 0, {{0, 0.03 + 0.01 * std::sin(2.0 * time), 0}, {}}});
        const physics::StepReport report = stage.step(kDt);
        REQUIRE(report.flags == 0);
        return report;
    }
    /// Mean of the solve's iterations.
    double iterations(int steps)
    {
        double sum = 0.0;
        for (int i = 0; i < steps; ++i) sum += step().solves.front().iterations;
        return sum / steps;
    }
    std::uint64_t hashAfter(int steps)
    {
        for (int i = 0; i < steps; ++i) step();
        return stage.world.hash();
    }
    const Ties& ties() { return stage.world.scene().ties; }
};

} // namespace

TEST_CASE("three blocks that are tied to each other take about as many iterations as one block")
{
    const double one = Pile(0.0).iterations(300);
    for (const double stiffness : {60.0, 1e4, physics::kHard}) {
        Pile tied(stiffness);
        CAPTURE(stiffness);
        CHECK(tied.iterations(300) <= one + 3.0); // 13 to 18 before coarse levels were tied
        REQUIRE(tied.ties().groups.size() == 1);
        CHECK(tied.ties().groups[0].bodies.size() == 3);
    }
}

TEST_CASE("tied bodies move with the same bits for any number of threads, after a reset and after a restore")
{
    Pile first(physics::kHard), threads(physics::kHard, 3);
    const std::uint64_t hash = first.hashAfter(60);
    CHECK(threads.hashAfter(60) == hash);

    const auto saved = first.stage.world.save();
    const double time = first.time;
    const std::uint64_t later = first.hashAfter(40);
    threads.stage.world.restore(*saved);
    threads.time = time;
    CHECK(threads.hashAfter(40) == later);

    first.stage.post(physics::Reset{});
    first.time = 0.0;
    Pile fresh(physics::kHard);
    first.hashAfter(60);
    fresh.hashAfter(60);
    for (std::size_t body = 0; body < 3; ++body) CHECK(first.stage.soft(body).x == fresh.stage.soft(body).x);
}

TEST_CASE("ties are made anew if an attachment comes or goes, and bodies without one are not tied")
{
    Pile pile(60.0);
    pile.step();
    REQUIRE(pile.ties().made.size() == 2);
    const AttachmentId extra{100}, first = pile.ties().made[0].attachment;
    pile.stage.post(physics::Attach{extra, pile.organ, {.nodes = {0}, .stiffness = 10.0, .to = pile.liver}});
    pile.step();
    REQUIRE(pile.ties().made.size() == 3);
    CHECK(pile.ties().made[2].attachment == extra);
    pile.stage.post(physics::Release{extra});
    pile.stage.post(physics::Release{first});
    pile.step();
    REQUIRE(pile.ties().made.size() == 1);
    CHECK(pile.ties().groups[0].bodies == std::vector<BodyId>{pile.organ, BodyId{pile.organ.value + 1}});
}

TEST_CASE("two flaps that are sewn along an edge are tied anew as they fold")
{
    Stage stage({.period = kDt, .threads = 1});
    stage.world.scene().gravity = {0.0, -9.81, 0.0};
    const auto flap = [&](const char* name, double x, std::vector<AttachmentDef> attachments) {
        return stage.add(
            physics::SoftBodyDef{.name = name,
                                 .mesh = geometry::shapes::block({0.03, 0.004, 0.03}, {8, 1, 8}),
                                 .pose = {{x, 0, 0}, {}},
                                 .material = physics::FemMaterial{.youngModulus = 2e5, .poissonRatio = 0.4},
                                 .attachments = std::move(attachments)});
    };
    const BodyId one = flap("one", -0.015, {{.box = Box{{-1, -1, -1}, {-0.0299, 1, 1}}}});
    flap("two", 0.015, {{.box = Box{{-1, 0.0019, -1}, {1e-6, 1, 1}}, .to = one}}); // hangs by its upper edge
    stage.run(2, kDt);
    REQUIRE(stage.world.scene().ties.groups.size() == 1);
    const Mat3 before = stage.world.scene().ties.made[0].turn;
    const physics::StepReport report = stage.run(300, kDt);
    CHECK(report.flags == 0);
    const Mat3 after = stage.world.scene().ties.made[0].turn;
    CHECK(0.5 * (trace(transpose(before) * after) - 1.0) < std::cos(0.5)); // it has folded
    CHECK(report.solves.front().iterations <= 20);
}

} // namespace tie_bodies_test
