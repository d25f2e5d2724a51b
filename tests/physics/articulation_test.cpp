#include "filasofia/geometry/shapes.h"

#include "physics/fake_engine.h"

#include <limits>

namespace articulation_test {

using namespace filasofia;
using namespace filasofia::physics;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// A shaft with two jaws; the second one slides.
RigidBodyDef tool()
{
    RigidBodyDef def{.name = "forceps", .elements = {Pose{{0, 1, 0}, {}}}};
    def.articulation.joints = {{.parentOffset = {{1, 0, 0}, {}}, .lower = -1.0, .upper = 1.0, .start = 0.5},
                               {.kind = JointKind::Prismatic, .parent = 1, .child = 2, .inertia = 0.1}};
    return def;
}

template <class Change> void checkRefused(Change change, const std::vector<std::string>& parts)
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    RigidBodyDef def = tool();
    change(def, server);
    checkError([&] { server.add(def); }, parts);
}

} // namespace

TEST_CASE("links of an articulated body are where their joints put them, in the Def that everyone sees")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    const BodyId id = server.add(tool());
    const auto& def = std::get<RigidBodyDef>(*server.def(id));
    REQUIRE(def.elements.size() == 3);
    CHECK(length(def.elements[1].position - Vec3{1, 1, 0}) < 1e-15);
    CHECK(length(rotationVector(def.elements[1].orientation) - Vec3{0, 0, 0.5}) < 1e-14);
    CHECK(length(rotationVector(def.elements[2].orientation) - Vec3{0, 0, 0.5}) < 1e-14);
    CHECK_NOTHROW(server.add(def)); // as a recording stores it
    CHECK(elementCount(tool()) == 3);
}

TEST_CASE("joints that make no tree, or that cannot be built, are refused with their names and values")
{
    const auto joint = [](std::size_t j, auto change) {
        return [=](RigidBodyDef& def, PhysicsServer&) { change(def.articulation.joints[j]); };
    };
    const std::string first = "rigid body 'forceps': articulation.joints[0]",
                      second = "rigid body 'forceps': articulation.joints[1]";
    checkRefused(joint(0, [](JointDef& j) { j.axis = {}; }), {first + ".axis", "length > 1e-06", "got 0"});
    checkRefused(joint(0, [](JointDef& j) { j.axis.y = kNan; }), {"joints[0].axis.y", "must be finite", "got nan"});
    checkRefused(joint(1, [](JointDef& j) { j.child = 3; }), {second + ".child", "[0, 3)", "got 3"});
    checkRefused(joint(1, [](JointDef& j) { j.parent = 3; }), {second + ".parent", "[0, 3)", "got 3"});
    checkRefused(joint(1, [](JointDef& j) { j.parent = -1; }), {"joints[1].parent", ">= 0", "got -1"});
    checkRefused(joint(1, [](JointDef& j) { j.child = 0; }), {second + ".child", "must not be 0, the base"});
    checkRefused(joint(1, [](JointDef& j) { j.child = 1; }), {second + ".child", "already the child of joints[0]"});
    checkRefused(joint(0, [](JointDef& j) { j.parent = 2; }), {first, "part of a loop", "element 1"});
    checkRefused(joint(1, [](JointDef& j) { j.parent = 2; }), {second, "part of a loop", "element 2"});
    checkRefused(joint(0, [](JointDef& j) { j.lower = 2.0; }), {first + ".upper", ">= lower", "2", "got 1"});
    checkRefused(joint(0, [](JointDef& j) { j.lower = kNan; }), {"joints[0].lower", "got nan"});
    checkRefused(joint(0, [](JointDef& j) { j.start = -1.5; }), {first + ".start", "[-1, 1] rad", "got -1.5"});
    checkRefused(joint(0, [](JointDef& j) { j.command = JointPosition{1.5}; }),
                 {first + ".command", "[-1, 1] rad", "got 1.5"});
    checkRefused(joint(0, [](JointDef& j) { j.command = JointForce{1.0}; }),
                 {first + ".command", "without an inertia"});
    checkRefused(joint(0, [](JointDef& j) { j.command = JointForce{kNan}; }), {"joints[0].command", "got nan"});
    checkRefused(joint(0, [](JointDef& j) { j.speed = 0.0; }), {"joints[0].speed", "> 0", "got 0"});
    checkRefused(joint(0, [](JointDef& j) { j.friction = -1.0; }), {"joints[0].friction", ">= 0", "got -1"});
    checkRefused(joint(0,
                       [](JointDef& j) {
                           j.parentOffset.orientation = {0, 0, 0, 0};
                       }),
                 {first + ".parentOffset", "orientation"});
    checkRefused(joint(0, [](JointDef& j) { j.mass = GivenInertia{.mass = -1.0}; }),
                 {"joints[0].mass.mass", "> 0", "got -1"});
    checkRefused(joint(0,
                       [](JointDef& j) {
                           j.mass = GivenInertia{.moments = {1, 1, 3}};
                       }),
                 {first + ".mass.moments", "sum of the other two"});
    const auto mimic = [&](JointMimic mimics, auto change) {
        return joint(1, [=](JointDef& j) { j.mimic = mimics, change(j); });
    };
    const auto no = [](JointDef&) {};
    checkRefused(mimic({.joint = 2}, no), {second + ".mimic.joint", "[0, 2)", "got 2"});
    checkRefused(mimic({.joint = 1}, no), {second + ".mimic.joint", "another joint", "got 1"});
    checkRefused(mimic({.multiplier = kNan}, no), {"joints[1].mimic.multiplier", "got nan"});
    checkRefused(mimic({.multiplier = 2.0}, [](JointDef& j) { j.start = 0.5; }),
                 {second + ".start", "must be 0 m with a mimic", "at 1 m", "got 0.5"});
    checkRefused(mimic({}, [](JointDef& j) { j.command = JointForce{}; }), {second + ".command", "with a mimic"});
    checkRefused(mimic({}, [](JointDef& j) { j.velocity = 1.0; }),
                 {second + ".velocity", "must be 0 m/s with a mimic"});
    checkRefused(mimic({.multiplier = -2.0}, [](JointDef& j) { j.lower = -0.6; }),
                 {first + ".start", "those of the joints that mimic it, [-1, 0.3] rad", "got 0.5"});
    checkRefused(mimic({}, [](JointDef& j) { j.lower = 2.0, j.upper = 3.0; }), {first + ".start", "[2, 1] rad"});
    checkRefused(
        [](RigidBodyDef& def, PhysicsServer&) {
            def.articulation.joints[0].start = 0.0;
            def.articulation.joints[0].mimic = JointMimic{.joint = 1};
            def.articulation.joints[1].mimic = JointMimic{.joint = 0};
        },
        {first + ".mimic.joint", "without a mimic", "got 1"});
}

TEST_CASE("a joint with a mimic starts where the other one lets it, and takes no command")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    RigidBodyDef def = tool();
    def.articulation.joints[1].mimic = JointMimic{.joint = 0, .multiplier = 2.0, .offset = -0.4};
    def.articulation.joints[1].axis = {1, 0, 0};
    const BodyId id = server.add(def);
    const auto& added = std::get<RigidBodyDef>(*server.def(id));
    CHECK(distance(added.elements[2].position, added.elements[1].position) == Approx(0.6));
    CHECK(server.add(added)); // as a recording stores it
    checkError([&] { server.setJoint(id, 1, JointPosition{0.1}); },
               {"rigid body 'forceps': joint 1", "takes no command", "mimics joint 0"});
    CHECK_NOTHROW(server.setJoint(id, 0, JointPosition{0.1}));
    def.articulation.joints[1].upper = 1.2;
    checkError([&] { server.setJoint(server.add(def), 0, JointPosition{0.9}); },
               {"joint 0: position", "[-1, 0.8] rad", "got 0.9"});
}

TEST_CASE("an articulated body's elements, base and carrier are refused if they are invalid")
{
    checkRefused([](RigidBodyDef& def, PhysicsServer&) { def.dynamic = true; },
                 {"rigid body 'forceps': mass of a dynamic body"});
    checkRefused(
        [](RigidBodyDef& def, PhysicsServer& physics) {
            def.dynamic = true;
            def.mass = GivenInertia{};
            def.articulation.to = physics.add(RigidBodyDef{});
        },
        {"rigid body 'forceps': articulation.to", "must not name a body", "got body 1"});
    checkRefused([](RigidBodyDef& def, PhysicsServer&) { def.elements.resize(2); },
                 {"rigid body 'forceps': elements", "1 entry", "or 3", "got 2"});
    checkRefused([](RigidBodyDef& def, PhysicsServer&) { def.elements.resize(3); },
                 {"rigid body 'forceps': elements[1]", "the pose that follows from its joint"});
    checkRefused(
        [](RigidBodyDef& def, PhysicsServer&) {
            def.collision = {{.mesh = geometry::shapes::box({1, 1, 1}), .element = 3}};
        },
        {"collision[0].element", "[0, 3)", "got 3"});
    const auto to = [](auto make, int element = 0) {
        return [=](RigidBodyDef& def, PhysicsServer& physics) {
            def.articulation.to = make(physics);
            def.articulation.toElement = element;
        };
    };
    checkRefused(to([](PhysicsServer&) { return BodyId{7}; }), {"articulation.to", "body 7", "no such body"});
    checkRefused(
        to([](PhysicsServer& physics) { return physics.add(SoftBodyDef{.name = "liver", .mesh = oneTetrahedron()}); }),
        {"articulation.to", "must be a kinematic rigid body", "soft body 'liver'"});
    checkRefused(to([](PhysicsServer& physics) {
                     return physics.add(RigidBodyDef{.name = "ball", .dynamic = true, .mass = GivenInertia{}});
                 }),
                 {"articulation.to", "must be a kinematic rigid body", "rigid body 'ball'"});
    checkRefused(to([](PhysicsServer& physics) { return physics.add(RigidBodyDef{}); }, 1),
                 {"articulation.toElement", "[0, 1)", "got 1"});
    checkRefused(to([](PhysicsServer& physics) { return physics.add(tool()); }, 1),
                 {"articulation.toElement", "[0, 1)", "got 1"});
    checkRefused([](RigidBodyDef& def, PhysicsServer&) { def.articulation.toElement = 1; },
                 {"articulation.toElement", "must be 0", "got 1"});
    checkRefused(
        [](RigidBodyDef& def, PhysicsServer& physics) {
            def.articulation.joints.clear();
            def.articulation.to = physics.add(RigidBodyDef{});
        },
        {"articulation.joints", "at least one entry"});
}

TEST_CASE("joints follow commands, and a wrong command is an error at the caller")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    const BodyId id = server.add(tool()), plain = server.add(RigidBodyDef{.name = "probe"}),
                 soft = server.add(SoftBodyDef{.name = "liver", .mesh = oneTetrahedron()});
    server.setJoint(id, 0, JointPosition{0.25});
    server.setJoint(id, 1, JointForce{-3.0});
    server.setPose(id, Pose{});
    server.step(0.1);
    const SetJoint& position = command<SetJoint>(calls, 4);
    CHECK((position.id == id && position.joint == 0));
    CHECK(std::get<JointPosition>(position.command).value == 0.25);
    CHECK(std::get<JointForce>(command<SetJoint>(calls, 5).command).value == -3.0);
    calls.commands.clear();

    checkError([&] { server.setJoint(id, 2, JointPosition{}); }, {"'forceps': joint", "[0, 2)", "got 2"});
    checkError([&] { server.setJoint(id, -1, JointPosition{}); }, {"'forceps': joint", "[0, 2)", "got -1"});
    checkError([&] { server.setJoint(plain, 0, JointPosition{}); }, {"rigid body 'probe'", "no such joint"});
    checkError([&] { server.setJoint(soft, 0, JointPosition{}); }, {"soft body 'liver'", "must be a rigid body"});
    checkError([&] { server.setJoint(BodyId{99}, 0, JointPosition{}); }, {"body 99", "no such body"});
    checkError([&] { server.setJoint(id, 0, JointPosition{1.01}); }, {"joint 0: position", "[-1, 1] rad", "got 1.01"});
    checkError([&] { server.setJoint(id, 0, JointPosition{kNan}); }, {"joint 0", "must be finite", "got nan"});
    checkError([&] { server.setJoint(id, 1, JointForce{kNan}); }, {"joint 1", "must be finite", "got nan"});
    checkError([&] { server.setJoint(id, 0, JointForce{1.0}); }, {"joint 0", "a force needs something that resists"});
    checkError([&] { server.setPose(id, Pose{}, 1); }, {"'forceps'", "element 1", "only the base"});

    RigidBodyDef carried = tool();
    carried.name = "carried";
    carried.articulation.to = plain;
    const BodyId follower = server.add(carried);
    checkError([&] { server.setPose(follower, Pose{}); }, {"'carried'", "follows body 2"});
    server.remove(plain);
    server.setPose(follower, Pose{});
    server.step(0.1);
    CHECK(calls.commands.size() == 3); // refused commands have not arrived
}

} // namespace articulation_test
