#include "physics/fake_engine.h"

#include <thread>

namespace commands_test {

using namespace filasofia;
using namespace filasofia::physics;

TEST_CASE("commands reach the engine at the next step, in the order of posting, with what was said")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls, {.gravity = {1, 2, 3}});
    const BodyId soft = server.add(SoftBodyDef{.name = "tissue", .mesh = oneTetrahedron()});
    const BodyId rigid = server.add(RigidBodyDef{.elements = {Pose{}, Pose{}}});
    server.setPose(rigid, {{4, 5, 6}, axisAngle({0, 0, 1}, 0.3)}, 1);
    server.setGravity({7, 8, 9});
    server.setMaterial(soft, FemMaterial{.youngModulus = 77});
    server.setForces(soft, {{3, {1, 0, 0}}});
    server.setPressure(soft, -11);
    server.reset();
    server.remove(rigid);
    CHECK(calls.commands.empty());

    server.step(0.25);
    REQUIRE(calls.commands.size() == 10);
    CHECK(command<SetGravity>(calls, 0).gravity == Vec3{1, 2, 3});
    CHECK(command<AddBody>(calls, 1).id == soft);
    CHECK(std::get<SoftBodyDef>(*command<AddBody>(calls, 1).def).name == "tissue");
    CHECK(command<AddBody>(calls, 1).body->nodeCount() == 4);
    CHECK(command<AddBody>(calls, 2).id == rigid);
    CHECK(command<SetPose>(calls, 3).id == rigid);
    CHECK(command<SetPose>(calls, 3).element == 1);
    CHECK(command<SetPose>(calls, 3).pose.position == Vec3{4, 5, 6});
    CHECK(command<SetGravity>(calls, 4).gravity == Vec3{7, 8, 9});
    CHECK(std::get<FemMaterial>(command<SetMaterial>(calls, 5).material).youngModulus == 77);
    const auto& rebuilt = dynamic_cast<const FakeBody&>(*command<SetMaterial>(calls, 5).body);
    CHECK(std::get<SoftBodyDef>(rebuilt.def).name == "tissue");
    CHECK(std::get<FemMaterial>(std::get<SoftBodyDef>(rebuilt.def).material).youngModulus == 77);
    CHECK(std::get<FemMaterial>(std::get<SoftBodyDef>(*server.def(soft)).material).youngModulus ==
          FemMaterial{}.youngModulus); // the Def stays what the body was made from
    REQUIRE(command<SetForces>(calls, 6).forces.size() == 1);
    CHECK(command<SetForces>(calls, 6).forces[0].node == 3);
    CHECK(command<SetPressure>(calls, 7).pressure == -11);
    CHECK(std::holds_alternative<Reset>(calls.commands[8]));
    CHECK(command<RemoveBody>(calls, 9).id == rigid);
    CHECK(calls.dts == std::vector{0.25});

    server.step(0.5);
    CHECK(calls.commands.size() == 10); // each command once
    CHECK(calls.dts == std::vector{0.25, 0.5});
}

TEST_CASE("ids are used once, increase, and are never zero")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    std::uint32_t last = 0;
    for (int i = 0; i < 10; ++i) {
        const BodyId id = i % 2 ? server.add(SoftBodyDef{.mesh = oneTetrahedron()}) : server.add(RigidBodyDef{});
        CHECK(id);
        CHECK(id.value > last);
        last = id.value;
        if (i % 3 == 0) server.remove(id);
    }
}

TEST_CASE("while paused the engine steps with dt = 0 and still gets its commands")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    server.step(0.1);
    server.pause(true);
    CHECK_FALSE(server.paused()); // not before the next step
    CHECK(server.step(0.1).dt == 0.0);
    CHECK(server.paused());
    server.setGravity({1, 0, 0});
    server.step(0.1);
    CHECK(command<SetGravity>(calls, calls.commands.size() - 1).gravity == Vec3{1, 0, 0});
    server.pause(false);
    CHECK(server.step(0.1).dt == 0.1);
    CHECK_FALSE(server.paused());
    server.pause(true);
    server.pause(false); // the last command counts
    server.step(0.1);
    CHECK(calls.dts == std::vector{0.1, 0.0, 0.0, 0.1, 0.1});
}

TEST_CASE("tune runs once, on the stepping thread, with the engine in hand")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    int runs = 0;
    std::thread::id where;
    std::thread([&] {
        server.tune([&](PhysicsEngine& engine) {
            ++runs;
            where = std::this_thread::get_id();
            CHECK(dynamic_cast<FakeEngine*>(&engine) != nullptr);
        });
    }).join();
    CHECK(runs == 0);
    server.step(0.1);
    server.step(0.1);
    CHECK(runs == 1);
    CHECK(where == std::this_thread::get_id());
}

TEST_CASE("def() returns what a body was made from")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    const BodyId id = server.add(SoftBodyDef{.name = "polyp", .mesh = oneTetrahedron(), .pressure = 3});
    CHECK(std::get<SoftBodyDef>(*server.def(id)).name == "polyp");
    CHECK(std::get<SoftBodyDef>(*server.def(id)).pressure == 3);
    CHECK(describeBody(*server.def(id)) == "soft body 'polyp'");
    CHECK(describeBody(*server.def(server.add(RigidBodyDef{.name = "forceps"}))) == "rigid body 'forceps'");
}

TEST_CASE("commands from several threads all arrive, each thread's in its own order")
{
    constexpr int kThreads = 4, kEach = 2000;
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    std::vector<std::thread> threads;
    for (int t = 0; t < kThreads; ++t)
        threads.emplace_back([&, t] {
            for (int i = 0; i < kEach; ++i) server.setGravity({double(t), double(i), 0});
        });
    for (int i = 0; i < 200; ++i) server.step(0.1);
    for (std::thread& thread : threads) thread.join();
    for (int i = 0; i < 3; ++i) server.step(0.1); // a step takes at most 4096 commands

    REQUIRE(calls.commands.size() == 1 + kThreads * kEach);
    std::vector<int> next(kThreads, 0);
    for (std::size_t c = 1; c < calls.commands.size(); ++c) {
        const Vec3 gravity = std::get<SetGravity>(calls.commands[c]).gravity;
        REQUIRE(gravity.y == next[static_cast<std::size_t>(gravity.x)]++);
    }
}

TEST_CASE("bodies added from several threads arrive in the order of their ids")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&] {
            for (int i = 0; i < 300; ++i) server.add(SoftBodyDef{.mesh = oneTetrahedron()});
        });
    for (std::thread& thread : threads) thread.join();
    server.step(0.1);
    REQUIRE(calls.commands.size() == 1201);
    for (std::size_t c = 1; c < calls.commands.size(); ++c)
        REQUIRE(std::get<AddBody>(calls.commands[c]).id.value == static_cast<std::uint32_t>(c));
}

TEST_CASE("whatever other threads do, no command follows the removal of its body")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    std::vector<BodyId> ids;
    for (int i = 0; i < 2000; ++i) ids.push_back(server.add(SoftBodyDef{.mesh = oneTetrahedron()}));
    const auto untilRemoved = [&](const auto& post) {
        for (BodyId id : ids) {
            try {
                for (;;) post(id);
            } catch (const Error&) { // removed by the other thread: take the next body
            }
        }
    };
    std::thread pressing([&] { untilRemoved([&](BodyId id) { server.setPressure(id, 1.0); }); });
    for (BodyId id : ids) {
        server.setForces(id, {});
        server.remove(id);
    }
    pressing.join();
    server.step(0.1);

    std::vector<bool> removed(ids.size() + 1, false);
    for (const Command& each : calls.commands) {
        if (const auto* remove = std::get_if<RemoveBody>(&each)) removed[remove->id.value] = true;
        if (const auto* press = std::get_if<SetPressure>(&each)) REQUIRE_FALSE(removed[press->id.value]);
    }
}

} // namespace commands_test
