#include "filasofia/core/log.h"
#include "filasofia/engine/collision/proximity.h"
#include "filasofia/geometry/shapes.h"

#include "engine/stage.h"

#include <functional>

namespace contact_state_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

/// A square of 4 cm around the origin in the plane y = 0, normal upwards.
std::shared_ptr<const geometry::TriangleMesh> sheet()
{
    geometry::TriangleMesh mesh;
    mesh.vertices = {{-0.02, 0, -0.02}, {-0.02, 0, 0.02}, {0.02, 0, 0.02}, {0.02, 0, -0.02}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return std::make_shared<const geometry::TriangleMesh>(mesh);
}

physics::RigidBodyDef kinematic(const std::string& name, std::shared_ptr<const geometry::TriangleMesh> mesh,
                                Vec3 at = {})
{
    return {.name = name, .elements = {Pose{at, {}}}, .mesh = std::move(mesh), .collision = {{}}};
}

physics::RigidBodyDef smallBox(Vec3 at, bool dynamic)
{
    physics::RigidBodyDef def = kinematic("box", geometry::shapes::box({0.004, 0.004, 0.004}), at);
    def.dynamic = dynamic;
    return def;
}

/// A sheet, a tool above it, and a bystander far away.
struct OverSheet {
    Stage stage;
    BodyId bystander = stage.add(kinematic("bystander", geometry::shapes::box({0.01, 0.01, 0.01}), {1, 0, 0}));
    BodyId floor = stage.add(kinematic("sheet", sheet()));
    BodyId tool = stage.add(smallBox({0, 0.0024, 0}, false));

    void lower(double height)
    {
        stage.post(physics::SetPose{tool, 0, {{0, height, 0}, {}}});
        stage.step(1e-3);
    }
    double gap()
    {
        double least = 1.0;
        for (const frame::Contact& each : stage.world.scene().contactReports) least = std::min(least, each.gap);
        return least;
    }
};

/// Soft and rigid bodies that lie on a sheet, are attached to each other, and wait to be grasped.
Stage eventful()
{
    Stage stage;
    stage.post(physics::SetGravity{{0, -9.81, 0}});
    stage.add(kinematic("sheet", sheet()));
    physics::SoftBodyDef block{.name = "block", .mesh = shared(boxMesh({2, 2, 2}, {0.02, 0.02, 0.02}))};
    block.pose.position = {-0.012, 0.0004, -0.01};
    block.collision = {{}};
    stage.add(block);
    physics::RigidBodyDef box = smallBox({0.0105, 0.003, 0.0}, true);
    box.attachments = {{.stiffness = 30.0, .to = {2}}};
    stage.add(box);
    return stage;
}

} // namespace

TEST_CASE("the side of a sheet that a body is on is still known after another body was removed")
{
    OverSheet scene;
    for (int i = 1; i <= 6; ++i) scene.lower(0.0024 - 1e-4 * i);
    REQUIRE(scene.gap() == Approx(-1e-4).margin(1e-6)); // its gap at the start of the step
    const std::vector<SheetSide> sides = scene.stage.world.scene().sides;
    REQUIRE(!sides.empty());
    scene.stage.post(physics::RemoveBody{scene.bystander});
    scene.stage.step(1e-3);
    CHECK(scene.gap() == Approx(-2e-4).margin(1e-6));
    CHECK(scene.stage.world.scene().sides == sides);
    scene.stage.post(physics::RemoveBody{scene.tool});
    scene.stage.step(0.0);
    CHECK(scene.stage.world.scene().sides.empty());
}

TEST_CASE("contacts keep their numbers after another body was removed")
{
    Stage stage = eventful();
    const BodyId bystander = stage.add(smallBox({1, 0, 0}, false));
    stage.run(100, 1e-3);
    Stage other = eventful();
    other.add(smallBox({1, 0, 0}, false));
    other.run(100, 1e-3);
    REQUIRE(stage.world.scene().contacts.size() > 3);
    other.post(physics::RemoveBody{bystander});
    for (int i = 0; i < 20; ++i) {
        stage.step(1e-3);
        other.step(1e-3);
        REQUIRE(stage.soft().x == other.soft().x);
        REQUIRE(stage.world.scene().contacts.size() == other.world.scene().contacts.size());
        for (std::size_t c = 0; c < stage.world.scene().contacts.size(); ++c)
            CHECK(stage.world.scene().contacts[c].feature == other.world.scene().contacts[c].feature);
    }
}

TEST_CASE("a state continues in another world as in its own, with the same hash")
{
    Stage here = eventful(), there = eventful();
    here.run(100, 1e-3);
    here.post(physics::Grasp{{7}, {1}, {2}, {}});
    here.step(0.0); // the grasp waits
    there.step(0.0);
    Snapshot(here.world.scene()).restore(there.world.scene());
    REQUIRE(here.world.scene().grasps.size() == 1);
    REQUIRE(!here.world.scene().sides.empty());
    for (int i = 0; i < 50; ++i) {
        REQUIRE(there.world.hash() == here.world.hash());
        here.step(1e-3);
        there.step(1e-3);
    }
    CHECK(there.world.scene().attachments.size() == 2);
}

TEST_CASE("the hash covers contacts, sides, attachments and grasps")
{
    Stage stage = eventful();
    stage.run(100, 1e-3);
    stage.post(physics::Grasp{{7}, {1}, {2}, {}});
    stage.step(0.0);
    const Snapshot before(stage.world.scene());
    const std::uint64_t hash = stage.world.hash();
    const std::function<void(Scene&)> changes[] = {
        [](Scene& s) { s.contacts[0].first.value += 9; },
        [](Scene& s) { s.contacts[0].second.value += 9; },
        [](Scene& s) { s.contacts[0].feature += 1; },
        [](Scene& s) { s.contacts[0].point.y += 1e-3; },
        [](Scene& s) { s.contacts[0].force.y += 1e-3; },
        [](Scene& s) { s.contacts.pop_back(); },
        [](Scene& s) { s.sides[0].source.model += 1; },
        [](Scene& s) { s.sides[0].target.body.value += 1; },
        [](Scene& s) { s.sides[0].point += 1; },
        [](Scene& s) { s.sides[0].feature[1] += 1; },
        [](Scene& s) { s.sides[0].side *= -1; },
        [](Scene& s) { s.sides.clear(); },
        [](Scene& s) { s.attachments[0].id.value += 1; },
        [](Scene& s) { s.attachments[0].to.value += 1; },
        [](Scene& s) { s.attachments[0].stiffness += 1; },
        [](Scene& s) { s.attachments[0].breakForce = 1; },
        [](Scene& s) { s.attachments[0].pairs[0][0].place.x += 1; },
        [](Scene& s) { s.attachments[0].pairs[0][1].nodes[0].weight += 1; },
        [](Scene& s) { s.attachmentForces[0][0].x += 1; },
        [](Scene& s) { s.grasps[0].target.value += 1; },
        [](Scene& s) { s.grasps[0].breakForce = 1; },
        [](Scene& s) { s.grasps.clear(); },
    };
    for (std::size_t c = 0; c < std::size(changes); ++c) {
        INFO("change " << c);
        changes[c](stage.world.scene());
        CHECK(stage.world.hash() != hash);
        before.restore(stage.world.scene());
    }
    CHECK(stage.world.hash() == hash);
}

TEST_CASE("a contact counts from the sum of the proximities on, for closed and open surfaces")
{
    for (const bool open : {false, true})
        for (const double gap : {0.95e-3, 1.05e-3}) {
            Stage stage;
            stage.add(kinematic("floor", open ? sheet() : geometry::shapes::box({0.04, 0.04, 0.04}),
                                {0, open ? 0.0 : -0.02, 0}));
            stage.add(smallBox({0, 0.002 + gap, 0}, false)); // both have 0.5 mm
            stage.step(1e-3);
            CHECK(stage.world.scene().contactReports.empty() == (gap > 1e-3));
            for (const frame::Contact& each : stage.world.scene().contactReports)
                CHECK(each.gap == Approx(gap).margin(1e-6));
        }
}

TEST_CASE("a collision group with a single body logs one warning, whatever is added later")
{
    std::vector<std::string> warnings;
    setLogSink([&](LogLevel, std::string_view line) { warnings.emplace_back(line); });
    Stage stage;
    const auto add = [&](int group) {
        physics::RigidBodyDef def = smallBox({static_cast<double>(stage.lastId), 0, 0}, true);
        def.collision[0].group = group;
        stage.add(def);
        stage.step(1e-3);
    };
    add(0);
    CHECK(warnings.empty()); // it is the only body
    add(0);
    CHECK(warnings.empty());
    add(3);
    for (int k = 0; k < 5; ++k) add(0);
    add(4);
    setLogSink({});
    REQUIRE(warnings.size() == 2);
    CHECK_THAT(warnings[0], Catch::Contains("group 3"));
    CHECK_THAT(warnings[1], Catch::Contains("group 4"));
}

TEST_CASE("a body of more than 2048 collision models is refused, and more bodies than that are accepted")
{
    physics::RigidBodyDef def = smallBox({}, false);
    def.collision.resize(2049);
    CHECK_THROWS_WITH(World({.threads = 1}).build(def),
                      "rigid body 'box': collision must have <= 2048 entries, got 2049");
    Stage stage;
    for (int i = 0; i < 2100; ++i) stage.add(smallBox({0.1 * i, 0, 0}, false));
    stage.add(smallBox({0.1 * 2099, 0.0045, 0}, false));
    stage.step(1e-3);
    REQUIRE(!stage.world.scene().contactReports.empty());
    CHECK(stage.world.scene().contactReports[0].first == BodyId{2100});
    CHECK(stage.world.scene().contactReports[0].second == BodyId{2101});
}

TEST_CASE("a deadline also stops rigid bodies in contact with each other, and the step can be replayed")
{
    const auto tower = [] {
        Stage stage;
        stage.post(physics::SetGravity{{0, -9.81, 0}});
        stage.add(kinematic("floor", geometry::shapes::box({0.1, 0.02, 0.1}), {0, -0.01, 0}));
        for (int k = 0; k < 16; ++k) stage.add(smallBox({7e-4 * k, 0.00201 + 0.00401 * k, 0}, true)); // it falls over
        return stage;
    };
    Stage free = tower(), hurried = tower(), again = tower();
    int most = 0, cut = 0;
    std::int64_t clock = 0;
    for (int i = 0; i < 200; ++i) {
        const physics::StepReport whole = free.step(1e-3);
        for (const physics::BodySolve& solve : whole.solves) most = std::max(most, solve.iterations);

        physics::StepBudget budget{.now = [&] { return ++clock; }, .deadline = clock + 4};
        const physics::StepReport report =
            hurried.world.step({.dt = 1e-3, .commands = hurried.commands, .budget = &budget});
        hurried.commands.clear();
        for (const physics::BodySolve& solve : report.solves) {
            CHECK(solve.body.value >= 2);
            CHECK(solve.iterations <= 40 + 4);
        }
        cut += report.has(physics::StepFlag::OutOfTime) ? 1 : 0;

        physics::StepBudget replay;
        if (report.has(physics::StepFlag::OutOfTime))
            for (const physics::BodySolve& solve : report.solves) replay.iterations.push_back(solve.iterations);
        again.world.step({.dt = 1e-3, .commands = again.commands, .budget = &replay});
        again.commands.clear();
        REQUIRE(again.world.hash() == hurried.world.hash());
    }
    CHECK(most > 50);
    CHECK(cut > 10);
}

} // namespace contact_state_test
