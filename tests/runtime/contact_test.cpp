#include "filasofia/filasofia.h"

#include <thread>

namespace contact_test {

using namespace filasofia;

namespace {

using Kind = ContactEvent::Kind;

/// A box of 8 g, a millimetre above a table.
struct Drop {
    Simulation sim;
    BodyId table, box;

    explicit Drop(double rate = 1000.0) : sim({.physics = {.rate = rate}})
    {
        table = sim.add(RigidBodyDef{.name = "table",
                                     .elements = {{{0, -5_mm, 0}, {}}},
                                     .mesh = shapes::box({100_mm, 10_mm, 100_mm}),
                                     .collision = {{}}});
        box = sim.add(RigidBodyDef{.name = "box",
                                   .elements = {{{0, 12_mm, 0}, {}}},
                                   .mesh = shapes::box({20_mm, 20_mm, 20_mm}),
                                   .dynamic = true,
                                   .collision = {{}}});
    }
};

constexpr double kWeight = 0.008 * 9.81; ///< [N]

} // namespace

TEST_CASE("a box that falls onto a table begins to touch, rests with its weight, and ends when it is lifted")
{
    Drop scene;
    struct Heard {
        Kind kind;
        std::uint64_t step;
        double time, force;
    };
    std::vector<Heard> heard;
    bool updateFirst = false;
    std::uint64_t updated = 0;
    scene.sim.on<ContactEvent>([&](const ContactEvent& touch) {
        CHECK(touch.pair.first == scene.table);
        CHECK(touch.pair.second == scene.box);
        updateFirst = updateFirst || updated >= touch.step;
        heard.push_back({touch.kind, touch.step, touch.time, touch.pair.force.y});
    });
    scene.sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent& update) {
        updated = update.step;
        if (update.step == 500) scene.sim.physics().setPose(scene.box, {{0, 0.5, 0}, {}});
    });
    const RunReport report = scene.sim.run({.headless = true, .steps = 510});

    CHECK_FALSE(updateFirst); // contact events come before the update event of their step
    REQUIRE(heard.size() > 400);
    CHECK(heard.front().kind == Kind::Begin);
    CHECK(heard.back().kind == Kind::End);
    CHECK(heard.back().step == 501);
    CHECK(heard.back().force == 0.0);
    CHECK(heard.back().time == Approx(0.501));
    const Heard& resting = heard[heard.size() - 2];
    CHECK(resting.kind == Kind::Persist);
    CHECK(resting.step == 500);
    CHECK(resting.force == Approx(-kWeight).epsilon(0.01)); // on the first body, the table
    int touching = 0, begins = 0, ends = 0;
    for (const Heard& each : heard) {
        begins += each.kind == Kind::Begin;
        ends += each.kind == Kind::End;
        touching += each.kind != Kind::End;
    }
    CHECK(begins == ends);
    REQUIRE(report.contacts.size() == 1);
    CHECK(report.contacts[0].first == "table");
    CHECK(report.contacts[0].second == "box");
    CHECK(report.contacts[0].steps == static_cast<std::uint64_t>(touching));
    CHECK(report.contacts[0].maxNormalForce >= report.contacts[0].meanNormalForce);
    CHECK(report.contacts[0].meanNormalForce == Approx(kWeight).epsilon(0.1));
}

TEST_CASE("the report of a run in which nothing touches has no contacts")
{
    Drop scene;
    scene.sim.physics().setGravity({});
    int heard = 0;
    scene.sim.on<ContactEvent>([&](const ContactEvent&) { ++heard; });
    const RunReport report = scene.sim.run({.headless = true, .steps = 20});
    CHECK(heard == 0);
    CHECK(report.contacts.empty());
    CHECK_THAT(summary(report), !Catch::Contains("contacts between"));
}

TEST_CASE("pausing ends no contact, removing a body does")
{
    Drop scene;
    std::vector<std::pair<Kind, std::uint64_t>> changes;
    scene.sim.on<ContactEvent>([&](const ContactEvent& touch) {
        if (touch.kind != Kind::Persist) changes.emplace_back(touch.kind, touch.step);
    });
    scene.sim.run({.headless = true, .steps = 300});
    scene.sim.physics().pause(true);
    scene.sim.run({.headless = true, .steps = 10});
    scene.sim.physics().pause(false);
    const std::size_t before = changes.size();
    scene.sim.run({.headless = true, .steps = 10});
    CHECK(changes.size() == before);
    CHECK(changes.back().first == Kind::Begin);
    scene.sim.physics().remove(scene.box);
    const RunReport report = scene.sim.run({.headless = true, .steps = 10});
    REQUIRE(changes.size() == before + 1);
    CHECK(changes.back().first == Kind::End);
    CHECK(report.contacts.empty()); // the report covers this run only
}

TEST_CASE("in a live run begins and ends alternate and none is missing, however slow the observer")
{
    Simulation sim({.physics = {.rate = 500}});
    sim.add(SoftBodyDef{.mesh = shapes::block({20_mm, 20_mm, 20_mm}, {2, 2, 2}),
                        .attachments = {{.box = Box{{-1, -1, -1}, {1, -9.9_mm, 1}}}},
                        .collision = {{}}});
    const BodyId ball =
        sim.add(RigidBodyDef{.elements = {{{0, 20_mm, 0}, {}}}, .mesh = shapes::sphere(5_mm), .collision = {{}}});
    sim.everyStep([&](double time) { // into the block and out of it, ten times a second
        sim.physics().setPose(ball, {{0, 17_mm + 4_mm * std::cos(20 * 3.14159265 * time), 0}, {}});
    });
    std::vector<Kind> changes;
    std::vector<std::uint64_t> steps;
    sim.on<ContactEvent>([&](const ContactEvent& touch) {
        if (touch.kind != Kind::Persist) changes.push_back(touch.kind);
        steps.push_back(touch.step);
        std::this_thread::sleep_for(std::chrono::milliseconds(10)); // as long as five steps
    });
    const RunReport report = sim.run({.backend = Backend::Null, .steps = 250});
    CHECK(changes.size() >= 6);
    for (std::size_t i = 0; i < changes.size(); ++i) CHECK(changes[i] == (i % 2 == 0 ? Kind::Begin : Kind::End));
    CHECK(std::ranges::is_sorted(steps));
    REQUIRE(report.contacts.size() == 1);
    CHECK(steps.size() < report.contacts[0].steps); // some Persist events were merged
}

} // namespace contact_test
