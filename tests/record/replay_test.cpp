#include "filasofia/record/replay.h"

#include "filasofia/engine/native_engine.h"
#include "filasofia/record/recording.h"
#include "filasofia/record/step_log.h"
#include "physics/fake_engine.h"
#include "record/runs.h"

namespace replay_test {

using namespace filasofia;
using namespace filasofia::physics;

namespace {

/// The eventful run of the native engine, as a file.
void recordEventfulRun(const record::ScratchFile& file)
{
    PhysicsServer server(engine::makeNativeEngine());
    record::RecordingWriter writer(file.path(), {});
    record::eventfulRun(server, [&] {
        writer.write(*server.nextRecord());
        server.popRecord();
    });
}

/// A step of a recording of one soft body (1) and one rigid body (2), with an invalid command `wrong`.
StepRecord wrongStep(Command wrong)
{
    StepRecord step;
    step.report = {.step = 1, .dt = 1e-3};
    const auto add = [&](std::uint32_t id, BodyDef def) {
        step.commands.push_back(AddBody{BodyId{id}, std::make_shared<const BodyDef>(std::move(def)), nullptr});
    };
    add(1, SoftBodyDef{.name = "liver", .mesh = oneTetrahedron()});
    add(2, RigidBodyDef{.name = "forceps"});
    step.commands.push_back(std::move(wrong));
    return step;
}

void checkRefused(const StepRecord& step, const std::vector<std::string>& says)
{
    const auto engine = engine::makeNativeEngine();
    record::Replayer replayer(*engine);
    checkError([&] { replayer.step(step); }, says);
}

constexpr double kInf = std::numeric_limits<double>::infinity();

} // namespace

TEST_CASE("a run read back from its file is replayed with the same hash at every step")
{
    const record::ScratchFile file("eventful.rec");
    recordEventfulRun(file);
    const record::Recording recording = record::readRecording(file.path());
    REQUIRE(recording.steps.size() == record::kEventfulSteps);
    for (const StepRecord& step : recording.steps) CHECK(step.hash != 0);
    CHECK_FALSE(record::replay(recording.steps, *engine::makeNativeEngine({.period = recording.header.period})));
}

TEST_CASE("a step that differs is named with both hashes, whatever comes after it")
{
    const record::ScratchFile file("differs.rec");
    recordEventfulRun(file);
    record::Recording recording = record::readRecording(file.path());
    recording.steps[16].hash ^= 1;
    const auto difference = record::replay(recording.steps, *engine::makeNativeEngine());
    REQUIRE(difference);
    CHECK(difference->step == recording.steps[16].report.step);
    CHECK(difference->recorded == (difference->replayed ^ 1));
}

TEST_CASE("a solver that a deadline stopped makes the same iterations again, without a clock")
{
    EngineCalls calls{.needed = 10};
    std::int64_t time = 0;
    calls.iterate = [&] { time += 100; };
    const record::ScratchFile file("deadline.rec");
    {
        PhysicsServer server = fakeServer(calls);
        server.keepLog(true);
        server.hashEveryStep(true);
        server.add(SoftBodyDef{.mesh = oneTetrahedron()});
        server.add(SoftBodyDef{.mesh = oneTetrahedron()});
        record::RecordingWriter writer(file.path(), {});
        for (const int iterationsInTime : {100, 13, 4, 0, 100}) {
            const StepReport report =
                server.step(1e-3, 0, {.now = [&] { return time; }, .deadline = time + 100 * iterationsInTime});
            CHECK(report.has(StepFlag::OutOfTime) == (iterationsInTime < 20));
            writer.write(*server.nextRecord());
            server.popRecord();
        }
    }
    const std::vector<std::vector<int>> made = {{10, 10}, {10, 3}, {4, 0}, {0, 0}, {10, 10}};
    CHECK(calls.iterations == made);

    EngineCalls again{.needed = 10};
    FakeEngine fresh(again);
    CHECK_FALSE(record::replay(record::readRecording(file.path()).steps, fresh));
    CHECK(again.iterations == made);
    CHECK(again.deadlines.empty());
}

TEST_CASE("a step in which nothing ran out of time must come out by itself")
{
    EngineCalls calls{.needed = 10};
    PhysicsServer server = fakeServer(calls);
    server.keepLog(true);
    server.hashEveryStep(true);
    server.add(SoftBodyDef{.mesh = oneTetrahedron()});
    server.step(1e-3);
    record::StepLog log;
    log.drain(server);
    EngineCalls again{.needed = 11}; // a different engine: if it got the counts, it would hide that it differs
    FakeEngine fresh(again);
    const auto difference = record::replay(log.steps(), fresh);
    REQUIRE(difference);
    CHECK(difference->step == 1);
}

TEST_CASE("a step out of time without a count for every soft body is refused")
{
    StepRecord step = wrongStep(Reset{});
    step.report.set(StepFlag::OutOfTime);
    checkRefused(step, {"step 1", "iterations", "one per solve", "got 0"});
    step.report.solves.resize(2);
    checkRefused(step, {"step 1", "iterations", "got 2"});
}

TEST_CASE("a recording's commands get the same checks as those of a server's callers")
{
    checkRefused(wrongStep(RemoveBody{BodyId{3}}), {"step 1", "body 3", "no such body"});
    checkRefused(wrongStep(SetPose{BodyId{1}, 0, {}}), {"step 1", "soft body 'liver'", "pose"});
    checkRefused(wrongStep(SetPose{BodyId{2}, 1, {}}),
                 {"step 1", "rigid body 'forceps'", "element", "[0, 1)", "got 1"});
    checkRefused(wrongStep(SetPose{BodyId{2}, 0, {{}, {0, 0, 0, 0}}}), {"step 1", "orientation", "got 0"});
    checkRefused(wrongStep(SetForces{BodyId{1}, {{4, {}}}}), {"step 1", "forces[0].node", "[0, 4)", "got 4"});
    checkRefused(wrongStep(SetForces{BodyId{1}, {{-1, {}}}}), {"step 1", "forces[0]", "node", "got -1"});
    checkRefused(wrongStep(SetMaterial{BodyId{1}, MassSpringMaterial{}}), {"step 1", "material", "kind"});
    checkRefused(wrongStep(SetPressure{BodyId{1}, kInf}), {"step 1", "pressure", "finite"});
    checkRefused(wrongStep(SetGravity{{kInf, 0, 0}}), {"step 1", "gravity", "finite"});
    const auto twice = std::make_shared<const BodyDef>(RigidBodyDef{});
    checkRefused(wrongStep(AddBody{BodyId{2}, twice, nullptr}), {"step 1", "body 2", "id must be > "});
    const auto empty = std::make_shared<const BodyDef>(RigidBodyDef{.name = "nothing", .elements = {}});
    checkRefused(wrongStep(AddBody{BodyId{3}, empty, nullptr}), {"step 1", "nothing"});
    checkRefused(wrongStep(Tune{}), {"step 1", "tune"});
    StepRecord endless = wrongStep(Reset{});
    endless.report.dt = kInf;
    checkRefused(endless, {"step 1", "dt", ">= 0 s", "inf"});
}

} // namespace replay_test
