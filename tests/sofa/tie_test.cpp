#include "sofa/sofa_stage.h"

#include "filasofia/geometry/shapes.h"

// Hands, attachments between bodies and grasps, with either engine.
namespace tie_test {

using namespace filasofia;
using namespace filasofia::physics;
using namespace filasofia::sofa_test;

namespace {

constexpr double kG = 9.81, kDt = 1e-3;
const double kCube = 0.02 * 0.02 * 0.02 * 1000 * kG; // [N] what a cube of 2 cm weighs

SoftBodyDef cube(const std::string& name, Vec3 corner, const Solver& solver = ConjugateGradient{})
{
    return {.name = name,
            .mesh = bar(2, 2, 2, {0.02, 0.02, 0.02}),
            .pose = {corner, {}},
            .material = FemMaterial{.youngModulus = 5e4, .law = Corotational{}},
            .rayleigh = {.mass = 5.0, .stiffness = 0.01},
            .solver = solver};
}

RigidBodyDef box(const std::string& name, Vec3 place, bool dynamic = true)
{
    RigidBodyDef def{.name = name, .elements = {{place, {}}}, .mesh = geometry::shapes::box({0.02, 0.02, 0.02})};
    def.dynamic = dynamic;
    return def;
}

const frame::Attachment* attachment(PhysicsServer& server, AttachmentId id)
{
    static std::vector<frame::Attachment> all; // the frame does not stay
    all = server.latest()->attachments;
    const auto found = std::ranges::find(all, id, &frame::Attachment::id);
    return found == all.end() ? nullptr : &*found;
}

} // namespace

TEST_CASE("a hand moves a rigid body as in the native engine, within its limits")
{
    for (const double limit : {1e9, 0.8}) {
        Pose end[2];
        Vec3 turn[2];
        int e = 0;
        for (const std::string engine : {"native", "sofa"}) {
            const auto server = serverWith(engine, kDt);
            RigidBodyDef def = box("tool", {});
            def.mass = GivenInertia{.mass = 0.05, .centre = {0.01, 0, 0}, .moments = {1e-5, 1e-5, 1e-5}};
            const BodyId tool = server->add(def);
            HapticTarget hand{.coupling = {.forceLimit = limit}};
            for (int i = 1; i <= 200; ++i) {
                hand.pose = {{0.02 * std::sin(0.02 * i), 0.01, 0}, axisAngle({0, 0, 1}, 0.002 * i)};
                hand.velocity = {0.4 * std::cos(0.02 * i), 0, 0};
                hand.angularVelocity = {0, 0, 2};
                server->setHaptic(tool, hand);
                server->step(kDt);
            }
            end[e] = server->latest()->rigidBody(tool)->poses[0];
            turn[e] = rotationVector(end[e].orientation);
            hand.coupling = {.linearStiffness = 0, .linearDamping = 0, .angularStiffness = 0, .angularDamping = 0};
            server->setHaptic(tool, hand);
            const double before = server->latest()->rigidBody(tool)->velocities[0].y;
            steps(*server, 10, kDt);
            CHECK(server->latest()->rigidBody(tool)->velocities[0].y - before == Approx(-kG * 0.01).epsilon(1e-6));
            ++e;
        }
        CAPTURE(limit, end[0].position.x, end[1].position.x, end[0].position.y, end[1].position.y, turn[0].z,
                turn[1].z);
        CHECK(length(end[0].position - end[1].position) < 2e-5);
        CHECK(length(turn[0] - turn[1]) < 2e-3);
    }
}

TEST_CASE("a cube hangs from another body by its nodes, with its weight, and breaks off beyond its limit")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    const int other = GENERATE(0, 1, 2); // a told box, a dynamic one that is held, tissue that is held
    const bool springs = GENERATE(false, true);
    const double stiffness = springs ? 20.0 : kHard; // [N/m] a node's
    CAPTURE(engine, other, springs);
    const auto server = serverWith(engine, kDt);
    SoftBodyDef held = cube("above", {-0.01, 0.02, -0.01});
    held.attachments = {{.box = geometry::Box{{-1, 0.04 - 1e-6, -1}, {1, 1, 1}}}};
    const BodyId above = other == 2 ? server->add(held) : server->add(box("above", {0, 0.03, 0}, other == 1));
    if (other == 1) server->setHaptic(above, {.pose = {{0, 0.03, 0}, {}}, .coupling = {.linearStiffness = 5e3}});
    const BodyId below = server->add(cube("below", {-0.01, 0, -0.01}));
    server->step(kDt);
    const AttachmentId id = server->attach(below, AttachmentDef{.box = geometry::Box{{-1, 0.015, -1}, {1, 0.03, 1}},
                                                                .stiffness = stiffness,
                                                                .to = above,
                                                                .breakForce = 2 * kCube});
    steps(*server, 1500, kDt);
    REQUIRE(attachment(*server, id) != nullptr);
    const frame::Attachment now = *attachment(*server, id);
    CHECK((now.body == below && now.to == above && now.points == 9 && !now.broken));
    CHECK(length(now.force - Vec3{0, kCube, 0}) < 0.02 * kCube);
    server->setGravity({0, -2.5 * kG, 0});
    std::vector<AttachmentBreak> breaks;
    for (int i = 0; i < 500; ++i)
        for (const AttachmentBreak& each : server->step(kDt).breaks) breaks.push_back(each);
    REQUIRE(breaks.size() == 1);
    CHECK((breaks[0].id == id && breaks[0].body == below && breaks[0].to == above && !breaks[0].grasp));
    CHECK((breaks[0].broken && breaks[0].points == 9 && breaks[0].force > 2 * kCube));
    CHECK(attachment(*server, id) == nullptr);
    CHECK(server->latest()->softBody(below)->positions[0].y < -0.05);
}

TEST_CASE("an attachment selects the nodes that are near another body, or inside it")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    const bool soft = GENERATE(false, true);
    CAPTURE(engine, soft);
    const auto server = serverWith(engine, kDt, {});
    SoftBodyDef large = cube("large", {0, 0, 0});
    large.mesh = bar(4, 4, 4, {0.04, 0.04, 0.04});
    const BodyId tissue = server->add(large);
    const Vec3 place{0.0201, 0.045, 0.0203}; // it reaches 5 mm into the cube
    const BodyId other =
        soft ? server->add(cube("small", place - Vec3{0.01, 0.01, 0.01})) : server->add(box("tool", place));
    server->step(kDt);
    const auto attached = [&](AttachmentDef def) {
        def.to = other;
        const AttachmentId id = server->attach(tissue, def);
        server->step(kDt);
        const auto* found = attachment(*server, id);
        const int points = found ? found->points : 0;
        server->release(id);
        server->step(kDt);
        return points;
    };
    CHECK(attached({.within = 0.0}) == 4); // upper nodes, which are 10 mm apart
    CHECK(attached({}) == 9);              // within 1 % of its size
    CHECK(attached({.within = 0.0053}) == 18);
    CHECK(attached({.nodes = {0}, .within = 0.0053}) == 19);
}

TEST_CASE("points of a rigid element are tied to space and to tissue, and released")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    CAPTURE(engine);
    const auto server = serverWith(engine, kDt);
    RigidBodyDef lamp = box("lamp", {0, 0, 0});
    lamp.attachments = {{.points = {{0, 0.01, 0}, {0.01, 0.01, 0}, {0, 0.01, 0.01}}, .stiffness = 200.0}};
    const BodyId body = server->add(lamp);
    SoftBodyDef held = cube("tissue", {0.1, 0, 0});
    held.attachments = {{.box = geometry::Box{{-1, 0.02 - 1e-6, -1}, {1, 1, 1}}}};
    server->add(held);
    const BodyId hook = server->add(box("hook", {0.11, -0.01, 0.01}));
    const AttachmentId tied = server->attach(hook, RigidAttachmentDef{.points = {{0, 0.01, 0}}, .to = BodyId{2}});
    steps(*server, 1500, kDt);
    REQUIRE(attachment(*server, tied) != nullptr);
    CHECK(length(attachment(*server, tied)->force - Vec3{0, kCube, 0}) < 0.02 * kCube);
    CHECK(server->latest()->rigidBody(body)->poses[0].position.y > -0.01);
    server->release(tied);
    steps(*server, 200, kDt);
    CHECK(server->latest()->rigidBody(hook)->poses[0].position.y < -0.1);
}

TEST_CASE("jaws grasp what they touch and lift it without friction")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    const bool soft = GENERATE(false, true);
    CAPTURE(engine, soft);
    const auto server = serverWith(engine, kDt);
    RigidBodyDef jaw = box("jaw", {0, 0.035, 0}, false);
    jaw.friction = 0.0;
    jaw.collision = {{}};
    const BodyId tool = server->add(jaw);
    SoftBodyDef tissue = cube("tissue", {-0.01, 0, -0.01}, Cholesky{});
    tissue.collision = {{}};
    RigidBodyDef stone = box("stone", {0, 0.01, 0});
    stone.collision = {{}};
    const BodyId target = soft ? server->add(tissue) : server->add(stone);
    RigidBodyDef plate = box("floor", {0, -0.0103, 0}, false);
    plate.mesh = geometry::shapes::box({0.2, 0.02, 0.2});
    plate.collision = {{}};
    server->add(plate);
    const AttachmentId nothing = server->grasp(tool, target);
    CHECK(server->step(kDt).has(StepFlag::NothingAttached));
    CHECK(attachment(*server, nothing) == nullptr);
    const double press = soft ? 0.0058 : 0.005;
    for (int i = 1; i <= 200; ++i) {
        server->setPose(tool, {{0, 0.035 - press * i / 200, 0}, {}});
        server->step(kDt);
    }
    const AttachmentId held = server->grasp(tool, target);
    server->step(kDt);
    for (int i = 1; i <= 800; ++i) {
        server->setPose(tool, {{0, 0.035 - press + 0.02 * std::min(i, 400) / 400, 0}, {}});
        server->step(kDt);
    }
    REQUIRE(attachment(*server, held) != nullptr);
    CHECK(attachment(*server, held)->body == target);
    const auto frame = server->latest();
    const double height =
        soft ? frame->softBody(target)->positions[0].y : frame->rigidBody(target)->poses[0].position.y;
    CHECK(height > (soft ? 0.01 : 0.02));
    const Vec3 all = attachment(*server, held)->force + frame::forceOn(target, frame->contacts);
    CHECK(length(all - Vec3{0, kCube, 0}) < 0.05 * kCube);
}

TEST_CASE("bodies whose surfaces touch exactly do not fly apart, welded there or not")
{
    const bool welded = GENERATE(true, false);
    const auto server = serverWith("sofa");
    SoftBodyDef wall{.name = "wall",
                     .mesh = bar(4, 2, 4, {0.012, 0.006, 0.012}),
                     .material = FemMaterial{.youngModulus = 30e3, .law = Corotational{}},
                     .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1e-6, 1}}}},
                     .collision = {{}}};
    SoftBodyDef polyp{.name = "polyp",
                      .mesh = bar(2, 2, 2, {0.004, 0.004, 0.004}),
                      .pose = {{0.004, 0.006, 0.004}, {}},
                      .material = FemMaterial{.youngModulus = 20e3, .law = Corotational{}},
                      .collision = {{}},
                      .friction = 0.8};
    const BodyId below = server->add(wall);
    if (welded) polyp.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 0.0061, 1}}, .to = below}};
    const BodyId above = server->add(polyp);
    for (int i = 0; i < 60; ++i) {
        const StepReport report = server->step(1e-3);
        REQUIRE_FALSE(report.has(StepFlag::Undone));
        REQUIRE_FALSE(report.has(StepFlag::Intersecting));
        if (welded) REQUIRE_FALSE(report.has(StepFlag::NotConverged));
    }
    for (const Vec3 each : server->latest()->softBody(above)->positions) {
        CHECK(each.y > 0.0055);
        CHECK(each.y < 0.0106);
    }
    if (!welded) return;
    for (const frame::Attachment& each : server->latest()->attachments)
        if (each.to == below) CHECK(each.force.y == Approx(6.4e-8 * 1000 * 9.81).epsilon(0.1)); // its weight
}

TEST_CASE("what holds nothing is in the step's report")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    CAPTURE(engine);
    const auto server = serverWith(engine, kDt, {});
    const BodyId tool = server->add(box("tool", {0, 0.5, 0}, false)), other = server->add(box("other", {0, 0.6, 0}));
    SoftBodyDef def = cube("cube", {});
    def.attachments = {{.box = geometry::Box{{1, 1, 1}, {2, 2, 2}}, .to = tool}};
    const BodyId body = server->add(def);
    const StepReport added = server->step(kDt);
    REQUIRE(added.nothingHeld.size() == 1);
    CHECK(added.has(StepFlag::NothingAttached));
    CHECK((added.nothingHeld[0].body == body && added.nothingHeld[0].to == tool && !added.nothingHeld[0].grasp));

    const AttachmentId pins = server->attach(body, {.box = geometry::Box{{1, 1, 1}, {2, 2, 2}}});
    const AttachmentId tie = server->attach(body, {.box = geometry::Box{{1, 1, 1}, {2, 2, 2}}, .to = other});
    const AttachmentId first = server->grasp(tool, body), second = server->grasp(tool, other);
    const StepReport report = server->step(kDt);
    REQUIRE(report.nothingHeld.size() == 4);
    const auto is = [&](std::size_t i, AttachmentId id, BodyId of, BodyId to, bool grasp) {
        const NothingHeld& each = report.nothingHeld[i];
        return each.id == id && each.body == of && each.to == to && each.grasp == grasp;
    };
    CHECK(is(0, pins, body, {}, false));
    CHECK(is(1, tie, body, other, false));
    CHECK(is(2, first, tool, body, true));
    CHECK(is(3, second, tool, other, true));
    CHECK(server->step(kDt).nothingHeld.empty());
}

} // namespace tie_test
