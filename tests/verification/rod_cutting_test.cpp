#include "filasofia/geometry/shapes.h"

#include "verification/rods.h"

namespace rod_cutting_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

constexpr Vec3 kGravity{0, -9.81, 0};

/// A strip of two triangles in the x-z plane, which cuts with its rim.
RigidBodyDef blade(Vec3 at, int group = 0)
{
    const geometry::TriangleMesh strip{.vertices = {{0, 0, -0.02}, {0, 0, 0.02}, {-0.03, 0, 0.02}, {-0.03, 0, -0.02}},
                                       .triangles = {{0, 1, 2}, {0, 2, 3}},
                                       .uv = {}};
    return {.name = "blade",
            .elements = {Pose{at}},
            .collision = {{.mesh = std::make_shared<const geometry::TriangleMesh>(strip),
                           .proximity = 0.0,
                           .group = group,
                           .cutting = true}}};
}

/// A thread that hangs down from the origin, pinned there.
RodBodyDef hanging(int edges = 40)
{
    return {.name = "thread",
            .points = {{0, 0, 0}, {0, -0.2, 0}},
            .spacing = 0.2 / edges,
            .radius = 0.5e-3,
            .youngModulus = 1e8,
            .rayleigh = {0.0, 0.0},
            .attachments = {{.nodes = {0}}},
            .collision = RodCollision{},
            .dynamicTopology = true};
}

/// Moves a blade along x through the thread, at a height; one step of 1 ms goes 5 mm.
StepReport cutAt(Stage& stage, BodyId tool, double height)
{
    StepReport all;
    stage.post(SetPose{tool, 0, Pose{{-0.05, height, 0}}}); // a jump: it has no path
    stage.step(1e-3);
    for (int i = 0; i <= 20; ++i) {
        stage.post(SetPose{tool, 0, Pose{{-0.05 + 0.005 * i, height, 0}}});
        const StepReport report = stage.step(1e-3);
        all.flags |= report.flags;
        for (const Rupture& each : report.topology.ruptures) all.topology.ruptures.push_back(each);
    }
    return all;
}

double massOf(const SoftModel& model, std::size_t from)
{
    double sum = 0.0;
    for (std::size_t i = from; i < model.masses.size(); ++i) sum += model.masses[i];
    return sum;
}

} // namespace

TEST_CASE("a loaded thread is cut: the lower part falls freely, the upper one keeps its weight, and momentum stays")
{
    Stage stage, uncut;
    for (Stage* each : {&stage, &uncut}) {
        each->world.scene().gravity = kGravity;
        RodBodyDef def = hanging();
        if (each == &uncut) def.dynamicTopology = false, def.collision->group = 1;
        each->add(def);
        each->add(blade({-0.05, -0.1025, 0}));
        each->run(200, 0.02);
        each->run(200, 1e-3);
    }
    frame::Frame frame;
    stage.world.capture(frame);
    CHECK(frame.softBodies[0].cutEdges.empty());
    StepReport found;
    for (int i = 0; found.topology.ruptures.empty() && i < 20; ++i) {
        for (Stage* each : {&stage, &uncut})
            each->post(SetPose{BodyId{2}, 0, Pose{{-0.05 + 0.005 * (i + 1), -0.1025, 0}}});
        found = stage.step(1e-3);
        uncut.step(1e-3);
    }
    REQUIRE(found.topology.ruptures.size() == 1);
    const Rupture& cut = found.topology.ruptures[0];
    CHECK(cut.kind == Rupture::Kind::Cut);
    CHECK(distance(cut.place, {0, -0.1025, 0}) < 1e-4);
    CHECK_THAT(cut.area, Catch::WithinRel(kPi * 0.5e-3 * 0.5e-3, 1e-12));
    REQUIRE(cut.detached.size() == 1);
    const SoftModel& model = stage.model();
    CHECK(cut.detached[0].piece == 1);
    CHECK(cut.detached[0].elements.size() == 19);
    CHECK_FALSE(cut.detached[0].held);
    CHECK_THAT(cut.detached[0].mass, Catch::WithinRel(massOf(model, 21), 1e-12));
    // The cut changes neither places nor velocities: they are those of the thread that is not cut.
    CHECK(stage.soft().x == uncut.soft().x);
    CHECK(stage.soft().v == uncut.soft().v);

    stage.world.capture(frame);
    CHECK(frame.softBodies[0].cutEdges == std::vector{20});
    const std::vector<Vec3> before = stage.soft().x;
    stage.run(200, 1e-4);
    const double g = 9.81, t = 0.02;
    double fallen = 0.0;
    for (std::size_t i = 21; i < before.size(); ++i)
        fallen += model.masses[i] * (before[i].y - stage.soft().x[i].y) / massOf(model, 21);
    verify("rod: cut while it hangs: relative error of the fall of the lower part, g t^2 / 2",
           std::abs(fallen / (0.5 * g * t * (t + 1e-4)) - 1.0), 1e-3); // what backward Euler makes of it
    stage.run(400, 5e-3);                                              // the upper part has sprung back and rests
    stage.world.capture(frame);
    verify("rod: cut while it hangs: relative error of the force at its pin, the weight of the upper part",
           std::abs(frame.attachments.at(0).force.y / ((massOf(model, 0) - massOf(model, 21)) * g) - 1.0), 1e-3);
}

TEST_CASE("a blade cuts what it crosses once, and pushes a thread that may not be cut or is of another group")
{
    for (const int variant : {0, 1, 2}) {
        Stage stage;
        RodBodyDef def = hanging();
        def.gravity = false;
        if (variant == 1) def.dynamicTopology = false;
        if (variant == 2) def.collision->group = 1;
        stage.add(def);
        const BodyId tool = stage.add(blade({-0.05, -0.1, 0}));
        stage.step(1e-3);
        // At a node: one of both edges there.
        CHECK(cutAt(stage, tool, -0.1).topology.ruptures.size() == (variant == 0 ? 1 : 0));
        CHECK(cutAt(stage, tool, -0.1).topology.ruptures.empty());
        CHECK(cutAt(stage, tool, -0.1525).topology.ruptures.size() == (variant == 0 ? 1 : 0));
        if (variant == 0) CHECK(stage.model().pieces.size() == 3);
        if (variant == 1) CHECK(std::abs(stage.soft().x[30].x) > 1e-3);
        if (variant == 2) CHECK(stage.soft().x == stage.model().rest);
    }
}

TEST_CASE("a ring that is cut once opens in one piece, a second cut parts it, and a reset closes it again")
{
    constexpr int nodes = 60;
    RodBodyDef def = hanging();
    def.gravity = false;
    def.closed = true;
    def.attachments.clear();
    def.spacing = {};
    def.points.clear();
    def.rayleigh.mass = 20.0;
    def.youngModulus = 1e7;
    for (int i = 0; i < nodes; ++i)
        def.points.push_back(
            {0.03 * std::cos(2 * kPi * (i + 0.5) / nodes), 0.03 * std::sin(2 * kPi * (i + 0.5) / nodes), 0});
    // The blade goes through the last edge, which closes the ring.
    Stage stage;
    stage.add(def);
    const BodyId tool = stage.add(blade({-0.05, 0.0, 0}));
    stage.step(1e-3);
    StepReport found;
    stage.post(SetPose{tool, 0, Pose{{0.01, 0.0, 0}}});
    stage.step(1e-3);
    for (int i = 0; i < 6; ++i) {
        stage.post(SetPose{tool, 0, Pose{{0.015 + 0.005 * i, 0.0, 0}}});
        const StepReport report = stage.step(1e-3);
        for (const Rupture& each : report.topology.ruptures) found.topology.ruptures.push_back(each);
    }
    REQUIRE(found.topology.ruptures.size() == 1);
    CHECK(found.topology.ruptures[0].detached.empty());
    frame::Frame frame;
    stage.world.capture(frame);
    CHECK(frame.softBodies[0].cutEdges == std::vector{nodes - 1});
    stage.post(SetPose{tool, 0, Pose{{0, 0, 1.0}}});
    stage.run(1000, 0.02); // it springs straight
    const double whole = 2 * kPi * 0.03 * (nodes - 1) / nodes;
    const double apart = distance(stage.soft().x.front(), stage.soft().x.back());
    verify("rod: ring, straight at rest, is cut: distance of its ends over its length, less than 1 by",
           std::abs(apart / whole - 1.0), 2e-3);
    stage.world.scene().soft[0].topology.cutEdges = {{20, 0.5}};
    const StepReport parted = stage.step(1e-3);
    REQUIRE(parted.topology.ruptures.size() == 1);
    REQUIRE(parted.topology.ruptures[0].detached.size() == 1);
    CHECK(parted.topology.ruptures[0].detached[0].elements.size() == nodes - 2 - 20);
    stage.post(Reset{});
    stage.step(0.0);
    CHECK(stage.model().rod.cut.empty());
    CHECK(stage.model().pieces.empty());
    CHECK(stage.model().collision[0].shape->edges.size() == nodes);
    stage.run(5, 1e-3);
    CHECK(distance(stage.soft().x.front(), stage.soft().x.back()) < 4e-3);
}

TEST_CASE("a thread tears where its tension is beyond its break force, at its top under its own weight")
{
    RodBodyDef def = hanging();
    def.attachments = {{.nodes = {0}}};
    const double weight = def.density * areaOf(def) * 0.2 * 9.81;
    def.breakForce = 3.0 * weight;
    Stage stage;
    const BodyId thread = stage.add(def);
    stage.run(200, 0.02);
    stage.world.scene().gravity = kGravity;
    double torn = 0.0;
    StepReport found;
    for (int i = 0; i < 3000 && found.topology.ruptures.empty(); ++i) {
        torn = 0.001 * weight * i;
        stage.post(SetForces{thread, {{.node = 40, .force = {0, -torn, 0}}}});
        found = stage.step(0.02);
    }
    REQUIRE(found.topology.ruptures.size() == 1);
    CHECK(found.topology.ruptures[0].kind == Rupture::Kind::Tear);
    CHECK(stage.model().rod.cut[0]);
    // The first edge bears all weight but half an edge's.
    verify("rod: tears under a growing load: relative error of the tension then",
           std::abs((torn + weight * (1.0 - 0.5 / 40)) / def.breakForce - 1.0), 2e-3);
}

TEST_CASE("attachments hold on to the side of a cut that they are on, without a jerk")
{
    Stage stage;
    RodBodyDef def = hanging();
    def.points = {{0, 0, 0}, {0.2, 0, 0}};
    def.attachments = {{.nodes = {0, 1}}, {.nodes = {39, 40}}};
    const BodyId rod = stage.add(def);
    // Two small bodies of tissue hang at the middle edge, one on each side of its middle.
    for (const double x : {0.1015, 0.1035})
        stage.add(SoftBodyDef{.mesh = geometry::shapes::block({1e-3, 1e-3, 1e-3}, {1, 1, 1}),
                              .pose = {{x, -1e-3, 0}, {}},
                              .attachments = {{.nodes = {0}, .to = rod}}});
    stage.run(50, 1e-3);
    const auto forces = [&] {
        frame::Frame frame;
        stage.world.capture(frame);
        std::vector<Vec3> out;
        for (const frame::Attachment& each : frame.attachments)
            if (each.to) out.push_back(each.force);
        return out;
    };
    REQUIRE(forces().size() == 2);
    const auto reach = [&](std::size_t a) {
        Vec3 sum;
        for (const NodeWeight& each : stage.world.scene().attachments[a].pairs[0][1].nodes)
            sum += each.weight * stage.soft().x[static_cast<std::size_t>(each.node)];
        return sum;
    };
    const std::array before{reach(0), reach(1)};
    stage.world.scene().soft[0].topology.cutEdges = {{20, 0.5}};
    CHECK(stage.step(1e-6).topology.ruptures.size() == 1);
    for (const std::size_t a : {0, 1}) CHECK(distance(reach(a), before[a]) < 2e-5);
    for (const NodeWeight& each : stage.world.scene().attachments[0].pairs[0][1].nodes) CHECK(each.node <= 20);
    for (const NodeWeight& each : stage.world.scene().attachments[1].pairs[0][1].nodes) CHECK(each.node >= 21);
    stage.run(50, 1e-3);
    for (Vec3 each : forces()) CHECK(length(each) < 1e-3);
    CHECK(forces().size() == 2);
}

TEST_CASE("cut at random a thousand times, above a floor, rods stay finite, with the same bits for 1 and 3 threads")
{
    const auto run = [](int threads) {
        Stage stage({.threads = threads});
        stage.world.scene().gravity = kGravity;
        stage.add(RigidBodyDef{.name = "floor",
                               .elements = {Pose{{0, -0.02, 0}}},
                               .mesh = geometry::shapes::box({0.4, 0.02, 0.4}),
                               .collision = {{}}});
        for (int k = 0; k < 6; ++k) {
            RodBodyDef def{.name = text("thread ", k), .radius = 0.3e-3, .youngModulus = 1e7};
            def.closed = k % 2 == 1;
            for (int i = 0; i < 60; ++i) {
                const double turn = 2 * kPi * i / (def.closed ? 60 : 70);
                def.points.push_back({0.06 * std::cos(turn), 1e-3 * k - 0.005, 0.06 * std::sin(turn)});
            }
            def.yieldStrain = k % 3 == 0 ? 1e-3 : kNever;
            def.collision = RodCollision{.self = k % 4 == 0};
            def.dynamicTopology = true;
            stage.add(def);
        }
        stage.step(0.0);
        std::mt19937 random(11);
        int cuts = 0;
        for (int step = 0; step < 340; ++step) {
            if (step % 50 == 49) stage.post(Reset{});
            for (int n = 0; n < 3; ++n) {
                SoftBody& body = stage.world.scene().soft[random() % 6];
                body.topology.cutEdges = {{static_cast<int>(random() % body.model.rod.edges.size()), 0.5}};
                cuts +=
                    static_cast<int>(!isCut(body.model.rod, static_cast<std::size_t>(body.topology.cutEdges[0].edge)));
                if (step % 20 == 19 && n == 0) stage.post(RemovePiece{body.model.id, 1});
            }
            stage.step(1e-3);
        }
        CHECK(cuts > 700); // others meet an edge that is cut already
        for (const SoftBody& body : stage.world.scene().soft) {
            for (Vec3 x : body.state.x) {
                REQUIRE(isFinite(x));
                CHECK(x.y > -0.011);
            }
            check(body.model, body.state);
        }
        return stage.world.hash();
    };
    CHECK(run(1) == run(3));
}

} // namespace rod_cutting_test
