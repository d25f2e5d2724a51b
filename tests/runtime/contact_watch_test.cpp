#include "filasofia/runtime/contact_watch.h"

#include "filasofia/engine/native_engine.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/physics/physics_server.h"

namespace contact_watch_test {

using namespace filasofia;
using namespace filasofia::runtime;

namespace {

using Kind = ContactEvent::Kind;

constexpr BodyId kA{1}, kB{2}, kC{3};

frame::Contact contact(BodyId first, BodyId second, double normalForce, double gap = 0.0, Vec3 friction = {})
{
    return {.first = first,
            .second = second,
            .normal = {0, 1, 0},
            .gap = gap,
            .normalForce = normalForce,
            .friction = friction};
}

/// A watch, two named bodies, and all that was posted.
struct Stage {
    physics::PhysicsServer physics{engine::makeNativeEngine()};
    ContactWatch watch;
    std::vector<std::unique_ptr<ContactEvent>> posted;

    Stage()
    {
        physics.add(physics::RigidBodyDef{.name = "table"});
        physics.add(physics::RigidBodyDef{.name = "ball"});
    }
    std::vector<Kind> observe(const std::vector<frame::Contact>& contacts, bool solved = true)
    {
        posted.clear();
        CHECK(watch.observe(contacts, solved, [&](std::unique_ptr<ContactEvent> event) {
            posted.push_back(std::move(event));
            return true;
        }));
        std::vector<Kind> kinds;
        for (const auto& event : posted) kinds.push_back(event->kind);
        return kinds;
    }
};

} // namespace

TEST_CASE("a pair begins once, persists, ends once, and may begin again")
{
    Stage stage;
    CHECK(stage.observe({}).empty());
    CHECK(stage.observe({contact(kA, kB, 0.0)}).empty()); // near, but it does not push
    CHECK(stage.observe({contact(kA, kB, 1.0)}) == std::vector{Kind::Begin});
    CHECK(stage.observe({contact(kA, kB, 2.0)}) == std::vector{Kind::Persist});
    CHECK(stage.observe({contact(kA, kB, 0.0)}) == std::vector{Kind::End});
    CHECK(stage.observe({contact(kA, kB, 0.0)}).empty());
    CHECK(stage.observe({contact(kA, kB, 1.0)}) == std::vector{Kind::Begin});
    CHECK(stage.observe({}) == std::vector{Kind::End});
}

TEST_CASE("an event has the sums over its pair's contacts, and nothing of other pairs")
{
    Stage stage;
    stage.observe({contact(kA, kB, 1.0, 0.0, {0.3, 0, 0}), contact(kB, kC, 9.0), contact(kA, kB, 2.0, 0.0, {0, 0, 0.4}),
                   contact(kA, kB, 0.0)});
    REQUIRE(stage.posted.size() == 2);
    const frame::ContactPair& pair = stage.posted[0]->pair;
    CHECK(pair.first == kA);
    CHECK(pair.second == kB);
    CHECK(pair.contacts == 2);
    CHECK(pair.normalForce == 3.0);
    CHECK(pair.frictionForce == Approx(0.7));
    CHECK(distance(pair.force, {0.3, 3.0, 0.4}) < 1e-12);
    CHECK(stage.posted[1]->pair.normalForce == 9.0);
    stage.observe({contact(kB, kC, 9.0)});
    REQUIRE(stage.posted.size() == 2);
    CHECK(stage.posted[0]->kind == Kind::End);
    CHECK(stage.posted[0]->pair.first == kA);
    CHECK(stage.posted[0]->pair.contacts == 0);
    CHECK(stage.posted[0]->pair.normalForce == 0.0);
    CHECK(stage.posted[1]->kind == Kind::Persist);
}

TEST_CASE("only contacts that go on merge, and only with those of the same pair")
{
    ContactEvent event;
    event.pair = {.first = kA, .second = kB};
    CHECK_FALSE(event.mergeKey().has_value());
    event.kind = Kind::End;
    CHECK_FALSE(event.mergeKey().has_value());
    event.kind = Kind::Persist;
    const auto key = event.mergeKey();
    REQUIRE(key.has_value());
    CHECK(key->type == event::EventType::Contact);
    std::swap(event.pair.first, event.pair.second);
    CHECK(event.mergeKey() != key);
    event.pair = {.first = kA, .second = kC};
    CHECK(event.mergeKey() != key);
}

TEST_CASE("a lost event is reported, and the pair's state goes on")
{
    Stage stage;
    CHECK_FALSE(stage.watch.observe({contact(kA, kB, 1.0)}, true, [](std::unique_ptr<ContactEvent>) { return false; }));
    CHECK(stage.observe({contact(kA, kB, 1.0)}) == std::vector{Kind::Persist});
}

TEST_CASE("a step concerns the watch while something touches, in the step after that, and never while paused")
{
    Stage stage;
    physics::StepReport nothing{.dt = 1e-3}, touching{.dt = 1e-3, .contacts = {.found = 1, .active = 1}};
    CHECK_FALSE(stage.watch.concerns(nothing));
    CHECK(stage.watch.concerns(touching));
    stage.observe({contact(kA, kB, 1.0)});
    CHECK(stage.watch.concerns(nothing)); // to post the end
    CHECK_FALSE(stage.watch.concerns({.dt = 0.0}));
    stage.observe({});
    CHECK_FALSE(stage.watch.concerns(nothing));
}

TEST_CASE("the report has means over the steps in contact, the largest values, and the bodies' names")
{
    Stage stage;
    stage.observe({contact(kA, kB, 1.0, 1e-4, {0.1, 0, 0})});
    stage.observe({contact(kA, kB, 3.0, -2e-4, {0, 0, 0.3}), contact(kA, kB, 0.0, -3e-4)});
    stage.observe({contact(kA, kB, 0.0, -9e-4)}); // does not push, so it does not count as a step in contact
    stage.observe({contact(kA, kB, 2.0, -1e-4), contact(kB, kC, 0.5)});
    const auto report = stage.watch.report(stage.physics);
    REQUIRE(report.size() == 2);
    CHECK(report[0].first == "table");
    CHECK(report[0].second == "ball");
    CHECK(report[0].steps == 3);
    CHECK(report[0].meanNormalForce == Approx(2.0));
    CHECK(report[0].maxNormalForce == 3.0);
    CHECK(report[0].meanFrictionForce == Approx(0.4 / 3));
    CHECK(report[0].maxFrictionForce == Approx(0.3));
    CHECK(report[0].deepest == 3e-4);
    CHECK(report[1].second == "body 3 (removed)");
}

TEST_CASE("forces of steps whose solver stopped short of its tolerance are counted apart, and the summary says so")
{
    Stage stage;
    stage.observe({contact(kA, kB, 1.0, 0.0, {0.1, 0, 0})});
    stage.observe({contact(kA, kB, 40.0, 0.0, {9, 0, 0})}, false); // a sheet of 5 g pressed with 40 N
    stage.observe({contact(kA, kB, 3.0, 0.0, {0.3, 0, 0}), contact(kB, kC, 2.0)});
    auto pairs = stage.watch.report(stage.physics);
    REQUIRE(pairs.size() == 2);
    CHECK(pairs[0].steps == 3);
    CHECK(pairs[0].unsolved == 1);
    CHECK(pairs[0].maxUnsolvedForce == 40.0);
    CHECK(pairs[0].meanNormalForce == Approx(2.0));
    CHECK(pairs[0].maxNormalForce == 3.0);
    CHECK(pairs[0].maxFrictionForce == Approx(0.3));
    CHECK(pairs[1].unsolved == 0);
    RunReport report;
    report.contacts = pairs;
    CHECK_THAT(summary(report), Catch::Contains("not in these forces: up to 1 step per pair in which a solver stopped "
                                                "short of its tolerance; the largest force there was 40 N, "
                                                "between 'table' and 'ball'\n"));
    report.contacts.erase(report.contacts.begin());
    CHECK_THAT(summary(report), !Catch::Contains("not in these forces"));
    stage.watch.beginRun();
    stage.observe({contact(kA, kB, 5.0)}, false);
    pairs = stage.watch.report(stage.physics);
    CHECK(pairs[0].meanNormalForce == 0.0); // no step was solved
    CHECK(pairs[0].maxUnsolvedForce == 5.0);
}

TEST_CASE("a new run begins new statistics, but a touching pair does not begin again")
{
    Stage stage;
    stage.observe({contact(kA, kB, 1.0), contact(kB, kC, 1.0)});
    stage.observe({contact(kA, kB, 1.0)});
    stage.watch.beginRun();
    CHECK(stage.watch.report(stage.physics).empty());
    CHECK(stage.observe({contact(kA, kB, 5.0)}) == std::vector{Kind::Persist});
    const auto report = stage.watch.report(stage.physics);
    REQUIRE(report.size() == 1);
    CHECK(report[0].steps == 1);
    CHECK(report[0].meanNormalForce == 5.0);
}

TEST_CASE("the summary has a line per pair that touched, the largest force first, and none if nothing touched")
{
    RunReport report;
    CHECK_THAT(summary(report), !Catch::Contains("contacts between"));
    report.contacts.push_back({.first = "table", .second = "a\nball", .steps = 12, .maxNormalForce = 1.5});
    report.contacts.push_back({.first = "table", .second = "cube", .steps = 7, .maxNormalForce = 2.5, .deepest = 1e-4});
    const std::string said = summary(report);
    CHECK_THAT(said, Catch::Contains("table, cube             7    0.0000    2.5000    0.0000    0.0000     0.1000\n"));
    CHECK_THAT(said, Catch::Contains("table, a ball          12    0.0000    1.5000"));
    CHECK(said.find("table, cube") < said.find("table, a ball"));
    const std::string heading = said.substr(0, said.find("table, cube") - 1);
    CHECK(heading.size() - heading.rfind('\n') ==
          said.find('\n', said.find("table, cube")) - heading.size()); // all lines have the same width
    for (int i = 0; i < 11; ++i) report.contacts.push_back({.first = "x", .second = "y", .steps = 1});
    CHECK_THAT(summary(report), Catch::Contains("and 1 pair with smaller forces\n"));
}

} // namespace contact_watch_test
