#include "filasofia/filasofia.h"

#include "filasofia/core/log.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/record/recording.h"
#include "filasofia/record/replay.h"
#include "filasofia/runtime/stepped_run.h"

#include <unistd.h>

#include <filesystem>

namespace every_step_test {

using namespace filasofia;

namespace {

Pose poseAt(double time) { return {{0.1 * std::sin(3.0 * time), 0.02 * time, 0}, axisAngle({0, 1, 0}, time)}; }

} // namespace

TEST_CASE("a script is called once before every step of a headless run, with the time at its end")
{
    Simulation sim({.physics = {.rate = 500}});
    std::vector<double> asked, made;
    std::vector<int> order;
    sim.everyStep([&](double time) {
        asked.push_back(time);
        order.push_back(1);
    });
    sim.everyStep([&](double) { order.push_back(2); });
    sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent& update) { made.push_back(update.time); });
    sim.run({.headless = true, .steps = 30});
    sim.run({.headless = true, .steps = 5});
    CHECK(asked.size() == 35);
    CHECK(asked == made);
    REQUIRE(order.size() == 70);
    for (std::size_t i = 0; i < order.size(); ++i) CHECK(order[i] == 1 + static_cast<int>(i % 2));
}

TEST_CASE("a body that a script moves is exactly where the script says, headless and live")
{
    for (const bool headless : {true, false}) {
        Simulation sim;
        const BodyId probe = sim.add(RigidBodyDef{.name = "probe"});
        sim.everyStep([&](double time) { sim.physics().setPose(probe, poseAt(time)); });
        sim.run({.headless = headless, .backend = Backend::Null, .steps = 100});
        const auto frame = sim.physics().latest();
        CHECK(frame->time > 0.05);
        const Pose pose = frame->rigidBody(probe)->poses[0], wanted = poseAt(frame->time);
        CHECK(distance(pose.position, wanted.position) == 0.0);
        CHECK(std::abs(dot(pose.orientation, wanted.orientation)) == Approx(1.0));
    }
}

TEST_CASE("a script's commands are in the recording, which is replayed without the script")
{
    const std::string file =
        (std::filesystem::temp_directory_path() / text("filasofia_every_step_test_", getpid(), ".rec")).string();
    Simulation sim;
    sim.add(SoftBodyDef{.mesh = shapes::block({20_mm, 20_mm, 20_mm}, {2, 2, 2}),
                        .attachments = {{.box = Box{{-1, -1, -1}, {1, -9.9_mm, 1}}}},
                        .collision = {{}}});
    const BodyId ball =
        sim.add(RigidBodyDef{.elements = {{{0, 16_mm, 0}, {}}}, .mesh = shapes::sphere(5_mm), .collision = {{}}});
    sim.everyStep([&](double time) { sim.physics().setPose(ball, {{0, 16_mm - 0.05 * time, 0}, {}}); });
    const RunReport report = sim.run({.headless = true, .steps = 60, .record = file});
    CHECK(report.contacts.size() == 1);
    const record::Recording recording = record::readRecording(file);
    REQUIRE(recording.steps.size() == 60);
    const auto engine =
        engine::makeNativeEngine({.period = recording.header.period, .contact = recording.header.contact});
    CHECK_FALSE(record::replay(recording.steps, *engine));
    CHECK(engine->hash() == report.hash);
    std::filesystem::remove(file);
}

TEST_CASE("a script rests while physics is paused")
{
    Simulation sim;
    int calls = 0;
    sim.everyStep([&](double) { ++calls; });
    sim.run({.headless = true, .steps = 5});
    sim.physics().pause(true);
    sim.run({.headless = true, .steps = 5});
    CHECK(calls == 6); // the step that starts the pause is known to be paused only when it is made
    sim.physics().pause(false);
    sim.run({.headless = true, .steps = 5});
    CHECK(calls == 10);
}

TEST_CASE("a script that throws is not called again, and the others go on")
{
    for (const bool headless : {true, false}) {
        Simulation sim;
        int thrown = 0, calls = 0;
        sim.everyStep([&](double) {
            ++thrown;
            sim.physics().setPose(BodyId{77}, {});
        });
        sim.everyStep([&](double) { ++calls; });
        const RunReport report = sim.run({.headless = headless, .backend = Backend::Null, .steps = 20});
        CHECK(report.steps == 20);
        CHECK(thrown == 1);
        CHECK(calls == 20);
    }
}

TEST_CASE("a script that throws something that is not a std::exception is reported like any other")
{
    std::vector<std::string> lines; // written by the stepping thread, read after the run
    setLogSink([&](LogLevel, std::string_view line) { lines.emplace_back(line); });
    for (const bool headless : {true, false}) {
        lines.clear();
        Simulation sim;
        int thrown = 0, calls = 0;
        sim.everyStep([&](double) {
            ++thrown;
            throw 42;
        });
        sim.everyStep([&](double) { ++calls; });
        CHECK(sim.run({.headless = headless, .backend = Backend::Null, .steps = 20}).steps == 20);
        CHECK((thrown == 1 && calls == 20));
        REQUIRE(lines.size() >= 1);
        CHECK(lines[0] ==
              "simulation: everyStep: it threw something that is not a std::exception; it is not called again");
    }
    setLogSink({});
}

TEST_CASE("an empty script is refused, and so is a new one during a run")
{
    Simulation sim;
    CHECK_THROWS_WITH(sim.everyStep({}), "simulation: everyStep: needs a function to call, got an empty one");
    std::string refused;
    sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent&) {
        try {
            sim.everyStep([](double) {});
        } catch (const Error& error) {
            refused = error.what();
        }
    });
    sim.run({.headless = true, .steps = 2});
    CHECK(refused ==
          "simulation: everyStep must be set before a run or between two steps of a stepped run, but a run or "
          "a step is going on");
}

TEST_CASE("a script and a memory may be added between two steps of a stepped run, not in one, nor in the run after it")
{
    Simulation sim;
    bool inStep = false;
    int calls = 0, refused = 0;
    const auto tryIt = [&] {
        try {
            sim.everyStep([](double) {});
        } catch (const Error&) {
            ++refused;
        }
        try {
            sim.remember({.of = "x", .save = [] { return std::any(); }, .restore = [](const std::any&) {}});
        } catch (const Error&) {
            ++refused;
        }
    };
    sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent&) {
        if (inStep) tryIt();
    });
    {
        runtime::SteppedRun run(sim, RunDef{.backend = Backend::Null});
        run.step();
        sim.everyStep([&](double) { ++calls; });
        sim.remember({.of = "calls",
                      .save = [&] { return std::any(calls); },
                      .restore = [&](const std::any& copy) { calls = std::any_cast<int>(copy); }});
        run.step();
        CHECK(calls == 1);
        const auto saved = run.save();
        run.step();
        run.restore(*saved);
        CHECK(calls == 1);
        inStep = true;
        run.step();
        CHECK(refused == 2);
        run.end();
    }
    sim.run({.headless = true, .backend = Backend::Null, .steps = 1});
    CHECK(refused == 4);
}

TEST_CASE("steps that were undone are told in the log once, also if nobody ends the run")
{
    std::vector<std::string> warned;
    setLogSink([&](LogLevel level, std::string_view line) {
        if (level == LogLevel::Warning && line.find("(Undone)") != std::string_view::npos) warned.emplace_back(line);
    });
    Simulation sim{SimulationDef{.physics = {.rate = 500, .threads = 1}}};
    const BodyId thread = sim.add(RodBodyDef{.points = {{0, 0, 0}, {50_mm, 0, 0}}, .spacing = 1_mm});
    runtime::SteppedRun run(sim, RunDef{.backend = Backend::Null});
    int undone = 0;
    for (int i = 0; i < 20; ++i) {
        if (i == 3) sim.physics().setForces(thread, {{.node = 20, .force = {0, 1e9, 0}}});
        const physics::StepReport report = run.step();
        undone += report.has(physics::StepFlag::Undone);
        CHECK(report.undone == (report.has(physics::StepFlag::Undone) ? std::vector{thread} : std::vector<BodyId>{}));
    }
    CHECK(undone > 1);
    REQUIRE(warned.size() == 1);
    CHECK_THAT(warned[0], Catch::Contains("the new state of '" + sim.physics().nameOf(thread) + "' was not finite"));
    setLogSink({});
}

TEST_CASE("an orientation of any length is made unit where a body goes")
{
    Simulation sim;
    const BodyId kinematic = sim.add(physics::RigidBodyDef{.name = "kinematic"});
    const BodyId free = sim.add(physics::RigidBodyDef{
        .name = "free", .dynamic = true, .mass = physics::GivenInertia{.mass = 1.0}, .gravity = false});
    for (const BodyId body : {kinematic, free}) sim.physics().setPose(body, {{0, 1e-3, 0}, {0.3, 0, 0, 0.4}});
    sim.run({.headless = true, .backend = visual::Backend::Null, .steps = 2});
    for (const BodyId body : {kinematic, free}) {
        const Quat q = sim.physics().latest()->rigidBody(body)->poses[0].orientation;
        CHECK(std::sqrt(dot(q, q)) == Approx(1.0).epsilon(1e-15));
        CHECK(q.z == Approx(0.8).epsilon(1e-12));
    }
}

} // namespace every_step_test
