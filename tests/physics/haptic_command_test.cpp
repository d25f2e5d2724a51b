#include "physics/fake_engine.h"

#include <limits>

namespace haptic_command_test {

using namespace filasofia;
using namespace filasofia::physics;

TEST_CASE("a haptic target arrives as it was given, an invalid one is an error at the caller")
{
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    const BodyId tool = server.add(RigidBodyDef{.name = "tool", .elements = {Pose{}, Pose{}}}),
                 soft = server.add(SoftBodyDef{.name = "liver", .mesh = oneTetrahedron()});
    const HapticTarget good{.pose = {{1, 2, 3}, {0.5, 0, 0, 0}}, .velocity = {4, 5, 6}};
    server.setHaptic(tool, good, 1);
    server.step(0.1);
    const SetHaptic& arrived = command<SetHaptic>(calls, 3);
    CHECK((arrived.id == tool && arrived.element == 1));
    CHECK(arrived.target.pose == good.pose); // the engine normalises its orientation
    CHECK(arrived.target.velocity == Vec3{4, 5, 6});

    const auto with = [&](auto&& change) {
        HapticTarget bad = good;
        change(bad);
        return [&server, tool, bad] { server.setHaptic(tool, bad); };
    };
    checkError([&] { server.setHaptic(soft, good); },
               {"soft body 'liver'", "must be a rigid body to be held by a hand"});
    checkError([&] { server.setHaptic(BodyId{99}, good); }, {"body 99", "no such body"});
    checkError([&] { server.setHaptic(tool, good, 2); }, {"rigid body 'tool'", "element", "[0, 2)", "got 2"});
    checkError(with([](HapticTarget& t) { t.pose.position.x = nan; }), {"tool", "target.pose.position.x", "got nan"});
    checkError(with([](HapticTarget& t) {
                   t.pose.orientation = {0, 0, 0, 0};
               }),
               {"tool", "target.pose", "orientation"});
    checkError(with([](HapticTarget& t) { t.velocity.y = nan; }), {"tool", "target.velocity.y", "got nan"});
    checkError(with([](HapticTarget& t) { t.angularVelocity.y = 1e5; }),
               {"tool", "target", "must have a length < 10000"});
    checkError(with([](HapticTarget& t) { t.coupling.linearStiffness = -1; }), {"linearStiffness", "must be >= 0 N/m"});
    checkError(with([](HapticTarget& t) { t.coupling.forceLimit = 0; }), {"forceLimit", "must be > 0 N", "got 0"});
    RigidBodyDef forceps{.name = "forceps", .articulation = {.joints = {{.lower = -1, .upper = 1}}}};
    const BodyId kinematic = server.add(forceps);
    forceps.dynamic = true;
    forceps.mass = GivenInertia{.mass = 0.1};
    const BodyId free = server.add(forceps);
    checkError([&] { server.setHaptic(kinematic, good, 1); }, {"forceps", "element 1", "only the base, element 0"});
    checkError([&] { server.setHaptic(free, good); },
               {"forceps", "must not be a dynamic body with joints to be held by a hand"});
    server.step(0.1);
    calls.commands.clear();
    server.step(0.1);
    CHECK(calls.commands.empty());
}

TEST_CASE("a base that follows another body cannot be held by a hand until that body is removed")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    const BodyId arm = server.add(RigidBodyDef{.name = "arm"});
    const BodyId forceps =
        server.add(RigidBodyDef{.name = "forceps", .articulation = {.joints = {{.lower = -1, .upper = 1}}, .to = arm}});
    checkError([&] { server.setHaptic(forceps, {}); }, {"forceps", "its base follows body 1 and cannot be set"});
    server.remove(arm);
    server.setHaptic(forceps, {});
    server.step(0.1);
    CHECK(command<SetHaptic>(calls, 4).id == forceps);
}

} // namespace haptic_command_test
