#include "filasofia/geometry/shapes.h"

#include "engine/rods.h"

#include <numbers>

namespace rod_body_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::engine::rods;
using namespace filasofia::physics;

namespace {

/// A closed loop's worth of thread that falls on a table: it touches the table and itself.
void dropCoil(Stage& stage)
{
    stage.world.scene().gravity = kGravity;
    RodBodyDef coil{.name = "coil", .spacing = 2e-3, .radius = 0.5e-3, .youngModulus = 1e6};
    for (int i = 0; i <= 100; ++i) {
        const double turn = 0.2 * i;
        coil.points.push_back({0.015 * std::cos(turn), 5e-3 + 0.3e-3 * i, 0.015 * std::sin(turn)});
    }
    coil.collision = RodCollision{};
    stage.add(table());
    stage.add(coil);
}

double fastest(const SoftState& state)
{
    double most = 0.0;
    for (Vec3 v : state.v) most = std::max(most, length(v));
    return most;
}

} // namespace

TEST_CASE("a pin holds a rod with the rod's weight")
{
    Stage stage;
    stage.world.scene().gravity = kGravity;
    stage.add(thread());
    stage.run(5000, 0.01);
    double mass = 0.0;
    for (double each : stage.model().masses) mass += each;
    frame::Frame frame;
    stage.world.capture(frame);
    REQUIRE(frame.attachments.size() == 1);
    CHECK(distance(frame.attachments[0].force, -mass * kGravity) < 1e-4 * mass * 9.81);
    CHECK(frame.softBodies[0].positions[0] == Vec3{0, 0.05, 0});
}

TEST_CASE("a stiff thread needs no iterations and does not lengthen")
{
    RodBodyDef def = thread();
    def.youngModulus = 1e9;
    def.radius = 0.15e-3;
    def.points.back().y -= 0.02;
    Stage stage;
    stage.world.scene().gravity = kGravity;
    stage.add(def);
    for (int i = 0; i < 300; ++i) {
        const StepReport report = stage.step(1e-3);
        CHECK(report.solves.at(0).iterations == 0);
        CHECK(report.flags == 0);
        for (const Spring& edge : stage.model().rod.edges) {
            const Vec3 a = stage.soft().x[static_cast<std::size_t>(edge.nodes[0])],
                       b = stage.soft().x[static_cast<std::size_t>(edge.nodes[1])];
            REQUIRE_THAT(distance(a, b), Catch::WithinRel(edge.restLength, 1e-3));
        }
    }
}

TEST_CASE("a rod that is curved at rest stays as it is, and turns freely as a whole")
{
    RodBodyDef def = thread(false);
    def.gravity = false;
    def.straight = false;
    def.rayleigh = {0.0, 0.01};
    def.spacing = {};
    def.points.clear();
    for (int i = 0; i <= 60; ++i) // a helix
        def.points.push_back({0.01 * std::cos(0.2 * i), 0.01 * std::sin(0.2 * i), 5e-4 * i});
    Stage stage;
    stage.add(def);
    stage.run(200, 1e-3);
    for (std::size_t i = 0; i < 61; ++i) CHECK(distance(stage.soft().x[i], stage.model().rest[i]) < 1e-12);

    const Vec3 spin{3.0, -2.0, 5.0};
    Vec3 centre;
    double mass = 0.0;
    for (std::size_t i = 0; i < 61; ++i) {
        centre += stage.model().masses[i] * stage.soft().x[i];
        mass += stage.model().masses[i];
    }
    centre = centre / mass;
    SoftState& state = stage.soft();
    for (std::size_t i = 0; i < 61; ++i) state.v[i] = cross(spin, state.x[i] - centre);
    for (std::size_t e = 0; e < 60; ++e) state.rod.spins[e] = dot(spin, normalized(state.x[e + 1] - state.x[e]));
    const auto momentum = [&] {
        Vec3 sum;
        for (std::size_t i = 0; i < 61; ++i)
            sum += stage.model().masses[i] * cross(stage.soft().x[i] - centre, stage.soft().v[i]);
        return sum;
    };
    const Vec3 before = momentum();
    stage.run(100, 1e-3); // it turns by 0.6 radians
    CHECK(distance(momentum(), before) < 0.02 * length(before));
    double first = distance(stage.soft().x.front(), stage.soft().x.back());
    CHECK_THAT(first, Catch::WithinRel(distance(stage.model().rest.front(), stage.model().rest.back()), 0.01));
}

TEST_CASE("a coil of thread falls on a table and on itself, rests there, and stays above it")
{
    Stage stage;
    dropCoil(stage);
    int touching = 0, unconverged = 0;
    for (int i = 0; i < 1500; ++i) {
        const StepReport report = stage.step(1e-3);
        unconverged += report.has(StepFlag::NotConverged) ? 1 : 0;
        touching = std::max(touching, report.contacts.active);
        for (Vec3 x : stage.soft().x) REQUIRE(x.y > 0.8 * 0.5e-3); // the centre line stays a radius above
    }
    CHECK(unconverged <= 15); // a percent of the steps, while it settles
    CHECK(touching > 50);
    CHECK(fastest(stage.soft()) < 0.01);
}

TEST_CASE("a twisted ring is held by its seam, falls on a table, and rests there as a whole")
{
    Stage stage;
    stage.world.scene().gravity = kGravity;
    RodBodyDef ring{.name = "ring", .closed = true, .radius = 0.5e-3, .youngModulus = 1e7, .straight = false};
    for (int i = 0; i < 61; ++i) {
        const double turn = 2.0 * std::numbers::pi * i / 61;
        ring.points.push_back({0.02 * std::cos(turn), 4e-3 + 1e-3 * std::sin(2.0 * turn), 0.02 * std::sin(turn)});
    }
    ring.rayleigh.mass = 5.0;
    ring.twist = 1.0;
    ring.collision = RodCollision{};
    stage.add(table());
    stage.add(ring);
    int touching = 0;
    for (int i = 0; i < 1000; ++i) {
        const StepReport report = stage.step(1e-3);
        touching = std::max(touching, report.contacts.active);
        for (Vec3 x : stage.soft().x) REQUIRE(x.y > 0.8 * 0.5e-3);
    }
    CHECK(touching > 10);
    CHECK(fastest(stage.soft()) < 0.01);
    const auto& x = stage.soft().x;
    for (const Spring& edge : stage.model().rod.edges)
        CHECK_THAT(distance(x[static_cast<std::size_t>(edge.nodes[0])], x[static_cast<std::size_t>(edge.nodes[1])]),
                   Catch::WithinRel(edge.restLength, 1e-2));
    double whole = 0.0;
    for (double each : stage.soft().rod.twists) whole += each;
    CHECK(std::abs(whole) > 0.5); // it cannot unwind
}

TEST_CASE("1, 2 and 8 threads make the same hash of rods and tissue that touch")
{
    const auto hashWith = [](int threads) {
        Stage stage({.threads = threads});
        dropCoil(stage);
        stage.add(SoftBodyDef{.name = "organ",
                              .mesh = geometry::shapes::block({0.04, 0.02, 0.04}, {4, 2, 4}),
                              .pose = {{0.02, 0.0105, 0}, {}},
                              .material = FemMaterial{.youngModulus = 5e3},
                              .collision = {{}}});
        bool met = false;
        for (int i = 0; i < 150; ++i) {
            stage.step(1e-3);
            for (const frame::Contact& each : stage.world.scene().contactReports)
                met = met || (each.first == BodyId{2} && each.second == BodyId{3} && each.normalForce > 0.0);
        }
        CHECK(met);
        return stage.world.hash();
    };
    const std::uint64_t one = hashWith(1);
    for (int threads : {2, 8}) CHECK(hashWith(threads) == one);
}

TEST_CASE("a saved state of a rod is restored bit for bit, and a reset begins anew")
{
    Stage stage;
    RodBodyDef def = thread();
    def.twist = 2.0;
    stage.world.scene().gravity = kGravity;
    stage.add(def);
    stage.step(0.0);
    const std::vector<Vec3> directors = stage.soft().rod.directors;
    stage.run(50, 1e-3);
    const auto saved = stage.world.save();
    stage.run(50, 1e-3);
    const std::uint64_t hash = stage.world.hash();
    stage.world.restore(*saved);
    stage.run(50, 1e-3);
    CHECK(stage.world.hash() == hash);
    stage.post(Reset{});
    stage.step(0.0);
    CHECK(stage.soft().rod.directors == directors);
    CHECK(stage.soft().x == stage.model().rest);
}

TEST_CASE("what a rod has yielded is part of its state: hash, saved state and reset have it")
{
    const auto bend = [](Stage& stage, double yieldStrain) {
        stage.world.scene().gravity = kGravity;
        RodBodyDef def = thread();
        def.yieldStrain = yieldStrain;
        stage.add(def);
        stage.step(0.0);
        stage.run(100, 1e-3);
    };
    Stage stage, stiff;
    bend(stage, 1e-3);
    bend(stiff, std::numeric_limits<double>::infinity());
    CHECK(stiff.soft().rod.plastic.empty());
    const std::vector<RodCurvature> plastic = stage.soft().rod.plastic;
    CHECK(std::ranges::count(plastic, RodCurvature{}) < std::ssize(plastic));
    const std::uint64_t now = stage.world.hash();
    stage.soft().rod.plastic[3][1][0] += 1e-9;
    CHECK(stage.world.hash() != now);
    stage.soft().rod.plastic = plastic;

    const auto saved = stage.world.save();
    stage.run(50, 1e-3);
    const std::uint64_t hash = stage.world.hash();
    stage.post(Reset{});
    stage.step(0.0);
    for (const RodCurvature& each : stage.soft().rod.plastic) CHECK(each == RodCurvature{});
    stage.world.restore(*saved);
    CHECK(stage.soft().rod.plastic == plastic);
    stage.run(50, 1e-3);
    CHECK(stage.world.hash() == hash);
}

TEST_CASE("what a rod is commanded is part of its state: a restored state goes on bending, a reset begins anew")
{
    Stage stage;
    const BodyId rod = stage.add(thread());
    stage.step(0.0);
    const std::uint64_t before = stage.world.hash();
    stage.post(SetCurvature{rod, {{.begin = 0.05, .curvature = {20.0, 0.0}}}, 100.0});
    stage.step(0.0);
    CHECK(stage.world.hash() != before);
    stage.run(100, 1e-3);
    CHECK_THAT(stage.soft().rod.steering.back().now[0], Catch::WithinRel(10.0, 1e-9));
    const auto saved = stage.world.save();
    stage.run(300, 1e-3);
    CHECK_THAT(stage.soft().rod.steering.back().now[0], Catch::WithinRel(20.0, 1e-12));
    const std::uint64_t hash = stage.world.hash();
    stage.world.restore(*saved);
    stage.run(300, 1e-3);
    CHECK(stage.world.hash() == hash);
    stage.post(Reset{});
    stage.step(0.0);
    CHECK(stage.soft().x == stage.model().rest);
    CHECK(stage.soft().rod.steering.back().now[0] == 0.0);
    stage.run(400, 1e-3); // the command lasts
    CHECK_THAT(stage.soft().rod.steering.back().now[0], Catch::WithinRel(20.0, 1e-12));
    CHECK(stage.soft().x.back().y > 0.06);
}

TEST_CASE("a rod is carried by what its nodes are attached to, and tissue hangs from a rod")
{
    Stage stage;
    stage.world.scene().gravity = kGravity;
    RodBodyDef def = thread(false);
    const BodyId hand = stage.add(RigidBodyDef{.name = "hand", .elements = {Pose{{0, 0.05, 0}, {}}}});
    def.attachments = {{.nodes = {0, 1}, .to = hand}};
    def.radius = 1e-3;
    const BodyId rod = stage.add(def);
    const BodyId organ = stage.add(SoftBodyDef{.name = "organ",
                                               .mesh = geometry::shapes::block({5e-3, 5e-3, 5e-3}, {1, 1, 1}),
                                               .pose = {{0.1, 0.0465, 0}, {}},
                                               .attachments = {{.within = 3e-3, .to = rod}}});
    for (int i = 0; i < 500; ++i) {
        stage.post(SetPose{hand, 0, Pose{{0, 0.05 + 1e-5 * i, 0}, {}}});
        stage.step(1e-3);
    }
    frame::Frame frame;
    stage.world.capture(frame);
    CHECK(distance(frame.softBody(rod)->positions[0], {0, 0.055, 0}) < 1e-3);
    REQUIRE(frame.attachments.size() == 2);
    CHECK(frame.attachments[1].points > 0);
    CHECK(frame.softBody(organ)->positions[0].y > -0.1);
    CHECK(distance(frame.softBody(organ)->positions[0], frame.softBody(rod)->positions.back()) < 0.02);
}

TEST_CASE("an edge that a body holds turns with it, in a restored state too, and unwinds when it is released")
{
    Stage stage;
    const BodyId hand = stage.add(RigidBodyDef{.name = "hand", .elements = {Pose{{0, 0.05, 0}, {}}}});
    RodBodyDef def = thread(false);
    def.gravity = false;
    def.attachments = {{.nodes = {49, 50}}, {.nodes = {0, 1}, .to = hand}};
    stage.add(def);
    const auto turn = [&](int from, int to) {
        for (int i = from; i < to; ++i) {
            stage.post(SetPose{hand, 0, Pose{{0, 0.05, 0}, axisAngle({1, 0, 0}, 0.05 * (i + 1))}});
            stage.step(1e-3);
        }
    };
    stage.step(0.0);
    const Vec3 first = stage.soft().rod.directors.front();
    turn(0, 60);
    const auto saved = stage.world.save();
    turn(60, 100);
    const std::uint64_t hash = stage.world.hash();
    CHECK(distance(stage.soft().rod.directors.front(), rotate(axisAngle({1, 0, 0}, 5.0), first)) < 1e-3);
    double whole = 0.0;
    for (double each : stage.soft().rod.twists) whole += each;
    CHECK_THAT(whole, Catch::WithinAbs(-5.0, 1e-2)); // the last edge lags behind the first
    stage.world.restore(*saved);
    turn(60, 100);
    CHECK(stage.world.hash() == hash);
    stage.post(Release{AttachmentId{2}});
    stage.run(1000, 1e-3);
    whole = 0.0;
    for (double each : stage.soft().rod.twists) whole += each;
    CHECK(std::abs(whole) < 0.01);
    CHECK(stage.model().rod.held.empty());
}

TEST_CASE("a joint that turns a rod bears its moment")
{
    Stage stage;
    RigidBodyDef handle{.name = "handle", .elements = {Pose{{0, 0.05, 0}, {}}}};
    handle.articulation.joints = {{.axis = {1, 0, 0}, .speed = 100.0}};
    const BodyId turned = stage.add(handle);
    RodBodyDef def = thread(false);
    def.gravity = false;
    def.attachments = {{.nodes = {49, 50}}, {.nodes = {0, 1}, .to = turned, .element = 1}};
    stage.add(def);
    for (int i = 0; i <= 100; ++i) {
        stage.post(SetJoint{turned, 0, JointPosition{0.02 * i}});
        stage.step(1e-3);
    }
    stage.run(500, 1e-3);
    frame::Frame frame;
    stage.world.capture(frame);
    const Vec3 torque = frame.attachments.at(1).torque;
    // T theta / L, without the halves of the edges that are clamped
    const double exact = stage.model().rod.twist * 2.0 / (0.1 - 2 * 2e-3);
    CHECK(distance(torque, {exact, 0, 0}) < 1e-3 * exact);
    CHECK_THAT(frame.rigidBodies.at(0).joints.at(0).load, Catch::WithinRel(-exact, 1e-3));
}

TEST_CASE("a step that numbers beyond all bounds spoil is undone, and the rod stays finite")
{
    Stage stage;
    stage.add(thread());
    stage.step(1e-3);
    stage.post(SetForces{BodyId{1}, {{.node = 30, .force = {1e300, 1e300, 0}}}});
    const StepReport report = stage.step(1e-3);
    CHECK(report.has(StepFlag::Undone));
    for (Vec3 x : stage.soft().x) CHECK(isFinite(x));
    for (Vec3 each : stage.soft().rod.directors) CHECK(isFinite(each));
}

} // namespace rod_body_test
