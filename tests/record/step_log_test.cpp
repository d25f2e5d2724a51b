#include "filasofia/record/step_log.h"

#include "filasofia/engine/native/native.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/record/replay.h"
#include "record/runs.h"

namespace step_log_test {

using namespace filasofia;

namespace {

record::StepLog logOfEventfulRun()
{
    physics::PhysicsServer server(engine::makeNativeEngine());
    record::StepLog log;
    record::eventfulRun(server, [] {});
    log.drain(server);
    return log;
}

} // namespace

TEST_CASE("a recorded run is replayed with the same hash at every step")
{
    const record::StepLog log = logOfEventfulRun();
    CHECK(log.steps().size() == record::kEventfulSteps);
    CHECK(log.replayable());
    CHECK_FALSE(record::replay(log.steps(), *engine::makeNativeEngine()));
}

TEST_CASE("a replay names the first step that differs")
{
    record::StepLog log = logOfEventfulRun();
    std::vector<physics::StepRecord> steps = log.take();
    steps[10].report.dt *= 1.0 + 1e-15;
    const auto difference = record::replay(steps, *engine::makeNativeEngine());
    REQUIRE(difference);
    CHECK(difference->step == steps[10].report.step);
    CHECK(difference->recorded != difference->replayed);
}

TEST_CASE("a log with tune() is not replayable")
{
    physics::PhysicsServer server(engine::makeNativeEngine());
    server.keepLog(true);
    engine::tune(server, [](engine::Native& native) { native.gravity() = {}; });
    server.step(1e-3);
    record::StepLog log;
    log.drain(server);
    CHECK_FALSE(log.replayable());
    CHECK_THROWS_WITH(record::replay(log.steps(), *engine::makeNativeEngine()),
                      "step 1 cannot be replayed: tune() ran before it");
}

TEST_CASE("a log that begins after the first step is not replayable")
{
    physics::PhysicsServer server(engine::makeNativeEngine());
    server.add(record::bunny());
    server.step(1e-3);
    server.keepLog(true);
    server.step(1e-3);
    record::StepLog log;
    log.drain(server);
    CHECK_FALSE(log.replayable());
    CHECK_THROWS_WITH(record::replay(log.steps(), *engine::makeNativeEngine()),
                      "step 2 cannot be replayed: steps before it were lost during recording");
}

TEST_CASE("a log of which a reader took the beginning is not replayable")
{
    std::vector<physics::StepRecord> steps = logOfEventfulRun().take();
    steps.erase(steps.begin() + 4);
    CHECK_THROWS_WITH(record::replay(steps, *engine::makeNativeEngine()),
                      "step 6 cannot be replayed: step 5 is missing");
    steps.erase(steps.begin());
    CHECK_THROWS_WITH(record::replay(steps, *engine::makeNativeEngine()),
                      "step 2 cannot be replayed: step 1 is missing");
}

TEST_CASE("a full log is visible to its reader")
{
    physics::PhysicsServer server(engine::makeNativeEngine(), {.logLength = 4});
    server.keepLog(true);
    for (int i = 0; i < 4; ++i) CHECK_FALSE(server.step(1e-3).has(physics::StepFlag::RecordLost));
    CHECK(server.step(1e-3).has(physics::StepFlag::RecordLost));
    record::StepLog log;
    log.drain(server);
    CHECK(log.replayable());
    server.step(1e-3);
    log.drain(server);
    CHECK(log.steps().size() == 5);
    CHECK_FALSE(log.replayable());
    CHECK_THROWS_WITH(record::replay(log.steps(), *engine::makeNativeEngine()), Catch::Contains("lost"));
}

TEST_CASE("a list of iterations that is not one per soft body is refused, of a step that was not cut short too")
{
    for (const bool cutShort : {false, true})
        for (const int change : {-1, 1}) {
            std::vector<physics::StepRecord> steps = logOfEventfulRun().take();
            physics::StepReport& report = steps[18].report; // two soft bodies by then
            if (cutShort) report.set(physics::StepFlag::OutOfTime);
            report.solves.resize(2 + change);
            CHECK_THROWS_WITH(record::replay(steps, *engine::makeNativeEngine()),
                              text("step ", report.step,
                                   ": iterations must have a number of entries in [2, 2], one per solve, got ",
                                   2 + change));
        }
}

TEST_CASE("a paused step has no iterations")
{
    std::vector<physics::StepRecord> steps = logOfEventfulRun().take();
    const auto paused = std::ranges::find(steps, 0.0, [](const auto& step) { return step.report.dt; });
    REQUIRE(paused != steps.end());
    CHECK(paused->report.solves.empty());
    paused->report.solves.resize(1);
    CHECK_THROWS_WITH(record::replay(steps, *engine::makeNativeEngine()),
                      Catch::Contains("a number of entries in [0, 0], one per solve, got 1"));
}

} // namespace step_log_test
