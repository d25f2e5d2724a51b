#include "physics/fake_engine.h"

#include <atomic>
#include <thread>

namespace log_test {

using namespace filasofia;
using namespace filasofia::physics;

TEST_CASE("without a reader no step is logged")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    server.hashEveryStep(true);
    server.step(0.1);
    CHECK(server.nextRecord() == nullptr);
    CHECK(calls.hashes == 0);
}

TEST_CASE("if two threads step one server at once, the second is refused, and the first goes on")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    const auto refused = "physics: a step is already in progress: only one thread at a time may step a server";
    std::atomic<bool> inside = false, done = false;
    server.tune([&](PhysicsEngine&) {
        inside = true;
        while (!done) std::this_thread::yield();
    });
    std::thread stepper([&] { server.step(0.1); });
    while (!inside) std::this_thread::yield();
    CHECK_THROWS_WITH(server.step(0.1), refused);
    CHECK_THROWS_WITH(server.replayStep(0.1), refused);
    CHECK_THROWS_WITH(server.expect({}), refused);
    done = true;
    stepper.join();
    CHECK(server.step(0.1).step == 2);
    server.tune([&](PhysicsEngine&) { CHECK_THROWS_WITH(server.step(0.1), refused); }); // nor from within a step
    CHECK(server.step(0.1).step == 3);
}

TEST_CASE("the log holds every step once, in order")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls, {.logLength = 4});
    server.keepLog(true);
    std::uint64_t expected = 1;
    for (int round = 0; round < 5; ++round) {
        for (int i = 0; i < 3; ++i) CHECK_FALSE(server.step(0.1 * (round + 1)).has(StepFlag::RecordLost));
        for (int i = 0; i < 3; ++i) {
            const StepRecord* record = server.nextRecord();
            REQUIRE(record != nullptr);
            CHECK(record->report.step == expected++);
            CHECK(record->report.dt == 0.1 * (round + 1));
            CHECK(record->rigidPoses.size() == 2);
            CHECK(record->hash == 0); // hashes were not turned on
            server.popRecord();
        }
        CHECK(server.nextRecord() == nullptr);
    }
}

TEST_CASE("a record holds the commands applied at the start of its step, and no other step's")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls, {.gravity = {1, 2, 3}, .logLength = 2});
    server.keepLog(true);
    const BodyId id = server.add(SoftBodyDef{.name = "tissue", .mesh = oneTetrahedron()});
    for (int i = 0; i < 4; ++i) { // longer than the ring, so that a slot is used again
        if (i == 2) server.setPressure(id, 7);
        server.step(0.1);
        const auto& commands = server.nextRecord()->commands;
        if (i == 0) {
            REQUIRE(commands.size() == 2);
            CHECK(std::get<SetGravity>(commands[0]).gravity == Vec3{1, 2, 3});
            CHECK(std::get<AddBody>(commands[1]).id == id);
            CHECK(std::get<AddBody>(commands[1]).body == nullptr);
            CHECK(std::get<SoftBodyDef>(*std::get<AddBody>(commands[1]).def).name == "tissue");
        } else {
            REQUIRE(commands.size() == (i == 2 ? 1 : 0));
            if (i == 2) CHECK(std::get<SetPressure>(commands[0]).pressure == 7);
        }
        server.popRecord();
    }
}

TEST_CASE("flags that the caller sets reach the engine's report and the log")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    server.keepLog(true);
    const auto late = static_cast<std::uint32_t>(StepFlag::Late);
    CHECK(server.step(0.1, late).flags == late);
    CHECK(server.nextRecord()->report.flags == late);
    server.popRecord();
    CHECK(server.step(0.1).flags == 0);
}

TEST_CASE("when the log is full the step says that its record is lost")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls, {.logLength = 3});
    server.keepLog(true);
    for (int i = 0; i < 3; ++i) CHECK_FALSE(server.step(0.1).has(StepFlag::RecordLost));
    for (int i = 0; i < 2; ++i) CHECK(server.step(0.1).has(StepFlag::RecordLost));
    CHECK(server.nextRecord()->report.step == 1);
    server.popRecord();
    CHECK_FALSE(server.step(0.1).has(StepFlag::RecordLost));
    for (std::uint64_t step : {2u, 3u, 6u}) {
        REQUIRE(server.nextRecord() != nullptr);
        CHECK(server.nextRecord()->report.step == step);
        CHECK(server.nextRecord()->report.has(StepFlag::RecordLost) == (step == 6)); // the gap is before this record
        server.popRecord();
    }
}

TEST_CASE("hashes are computed for every step once asked for, and not after that")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    server.keepLog(true);
    server.hashEveryStep(true);
    for (int i = 0; i < 3; ++i) server.step(0.1);
    server.hashEveryStep(false);
    server.step(0.1);
    CHECK(calls.hashes == 3);
    for (std::uint64_t hash : {1001u, 1002u, 1003u, 0u}) {
        CHECK(server.nextRecord()->hash == hash);
        server.popRecord();
    }
    CHECK(server.hash() == 1004);
}

TEST_CASE("flags of a report are set one by one")
{
    StepReport report;
    CHECK(report.flags == 0);
    report.set(StepFlag::Undone);
    report.set(StepFlag::Late);
    CHECK(report.has(StepFlag::Undone));
    CHECK(report.has(StepFlag::Late));
    CHECK_FALSE(report.has(StepFlag::NotConverged));
}

} // namespace log_test
