#include "physics/fake_engine.h"

#include "filasofia/core/log.h"
#include "filasofia/physics/registry_hold.h"

#include <atomic>
#include <chrono>
#include <future>
#include <thread>

namespace stepping_test {

using namespace filasofia;
using namespace filasofia::physics;
using namespace std::chrono_literals;

namespace {

RigidBodyDef rigid(const std::string& name, bool dynamic = false)
{
    return {.name = name, .dynamic = dynamic, .mass = GivenInertia{}};
}

/// The kinds of all commands of the steps, in their order, as indices in the variant.
std::vector<std::size_t> kindsOf(const EngineCalls& calls)
{
    std::vector<std::size_t> kinds;
    for (const Command& each : calls.commands) kinds.push_back(each.index());
    return kinds;
}

} // namespace

TEST_CASE("the stepping thread asks, commands and steps while another thread holds the callers' lock")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    const BodyId probe = server.add(rigid("probe")), ball = server.add(rigid("ball", true));
    const BodyId tissue = server.add(SoftBodyDef{.name = "tissue", .mesh = oneTetrahedron()});

    auto hold = std::make_unique<RegistryHold>(server);
    std::future<bool> other = std::async(std::launch::async, [&] { return server.has(probe); });
    CHECK(other.wait_for(20ms) == std::future_status::timeout); // so it is held
    std::future<int> stepping = std::async(std::launch::async, [&] {
        const PhysicsServer::Stepping here(server);
        int made = 0;
        for (int i = 0; i < 50; ++i) {
            server.setPose(probe, {{0.001 * i, 0, 0}, {}});
            server.setHaptic(ball, {});
            server.setWrench(ball, {1, 0, 0}, {});
            server.setPressure(tissue, i);
            server.setMaterial(tissue, SoftBodyDef{}.material);
            const AttachmentId held = server.attach(tissue, AttachmentDef{.nodes = {0}});
            server.release(server.grasp(ball, tissue));
            server.release(held);
            server.pause(false);
            if (server.has(probe) && server.bodies().size() == 3 && server.def(ball) &&
                server.attachments(ball).empty())
                ++made;
            server.step(1e-3);
        }
        server.remove(ball);
        server.step(1e-3);
        return made;
    });
    const bool ended = stepping.wait_for(10s) == std::future_status::ready;
    hold.reset();
    CHECK(ended);
    CHECK(stepping.get() == 50);
    CHECK(other.get());
    CHECK_FALSE(server.has(ball)); // now the others know
    CHECK(server.bodies() == std::vector<BodyId>{probe, tissue});
    CHECK_THROWS_WITH(server.setWrench(ball, {}, {}), Catch::Contains("no such body"));
    CHECK(server.attach(tissue, AttachmentDef{.nodes = {0}}).value ==
          101); // ids continue after those assigned in steps
}

TEST_CASE("the order of one thread's commands is kept, whether or not it is the stepping thread")
{
    const auto play = [](bool stepping) {
        EngineCalls calls;
        PhysicsServer server = fakeServer(calls);
        const BodyId probe = server.add(rigid("probe"));
        std::optional<PhysicsServer::Stepping> here;
        if (stepping) here.emplace(server);
        server.setPose(probe, {});
        const BodyId late = server.add(rigid("late", true));
        server.setWrench(late, {1, 0, 0}, {});
        server.step(0.1);
        server.remove(probe);
        here.reset();
        server.setGravity({});
        server.step(0.1);
        if (stepping) here.emplace(server);
        server.remove(late);
        server.reset();
        server.step(0.1);
        return kindsOf(calls);
    };
    CHECK(play(true) == play(false));
}

TEST_CASE("commands of other threads for a body that the stepping thread has just removed are dropped with a warning")
{
    std::string logged;
    setLogSink([&](LogLevel, std::string_view line) { logged = line; });
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    const BodyId ball = server.add(rigid("ball", true)), other = server.add(rigid("other", true));
    server.step(0.1);
    const std::size_t before = calls.commands.size();

    // Another thread adds a body that is attached to the ball, and is blocked while it is checked, under the lock.
    std::atomic<int> counted = 0;
    std::atomic<bool> goOn = false;
    calls.counted = [&] {
        if (++counted == 2) // the first time was before the lock
            while (!goOn) std::this_thread::yield();
    };
    BodyId late;
    std::thread adder([&] {
        late = server.add(
            SoftBodyDef{.name = "late", .mesh = oneTetrahedron(), .attachments = {{.nodes = {0}, .to = ball}}});
    });
    while (counted < 2) std::this_thread::yield();
    {
        const PhysicsServer::Stepping here(server);
        server.remove(ball);
        goOn = true;
        adder.join();
        CHECK_FALSE(server.has(ball));
        CHECK_FALSE(server.has(late));
        CHECK_THROWS_WITH(server.setWrench(ball, {}, {}), Catch::Contains("no such body"));
        server.step(0.1);
    }
    setLogSink({});
    CHECK(logged ==
          text("physics: a command came too late: soft body 'late': attachments[0].to: rigid body 'ball' (body ",
               ball.value, "): no such body any more: it was removed"));
    CHECK(calls.commands.size() == before + 1); // the removal
    CHECK_THROWS_WITH(server.setPressure(late, 1.0), Catch::Contains("no such body"));
    server.setWrench(other, {}, {});
    server.step(0.1);
    CHECK(calls.commands.size() == before + 2);
}

TEST_CASE("two threads that attach at the same time get ids of their own, and every step's commands can be replayed")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls, {.logLength = 100'000});
    server.keepLog(true);
    const BodyId tissue = server.add(SoftBodyDef{.name = "tissue", .mesh = oneTetrahedron()});
    constexpr int kEach = 1000;
    std::vector<AttachmentId> theirs, ours;
    std::thread other([&] {
        for (int i = 0; i < kEach; ++i) {
            theirs.push_back(server.attach(tissue, AttachmentDef{.nodes = {1}}));
            server.release(theirs.back());
        }
    });
    {
        const PhysicsServer::Stepping here(server);
        for (int i = 0; i < kEach; ++i) {
            ours.push_back(server.attach(tissue, AttachmentDef{.nodes = {0}}));
            server.step(1e-3);
        }
    }
    other.join();
    server.step(1e-3);
    std::vector<AttachmentId> all = theirs;
    all.insert(all.end(), ours.begin(), ours.end());
    std::ranges::sort(all);
    CHECK(std::ranges::adjacent_find(all) == all.end());

    EngineCalls again;
    PhysicsServer replay = fakeServer(again);
    std::size_t attached = 0;
    for (; StepRecord* step = server.nextRecord(); server.popRecord()) {
        std::vector<Command> commands;
        for (Command& command : step->commands) {
            if (auto* add = std::get_if<AddBody>(&command)) add->body = replay.engine().build(*add->def);
            attached += std::holds_alternative<Attach>(command);
            commands.push_back(std::move(command));
        }
        replay.expect(std::move(commands));
        replay.replayStep(1e-3);
    }
    CHECK(attached == all.size());
}

} // namespace stepping_test
