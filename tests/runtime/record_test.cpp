#include "filasofia/filasofia.h"

#include "filasofia/core/log.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/record/recording.h"
#include "filasofia/record/replay.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <future>
#include <iostream>
#include <mutex>
#include <thread>

namespace record_test {

using namespace filasofia;

namespace {

SoftBodyDef bunny()
{
    return {.name = "bunny",
            .mesh = asset("meshes/bunny_756.msh"),
            .attachments = {{.box = Box{{-1, 0.105, -1}, {1, 1, 1}}}}};
}

/// A folder for this test's files, removed at the end.
struct Folder {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / text("filasofia_runtime_record_test_", getpid());
    Folder() { std::filesystem::create_directory(path); }
    ~Folder() { std::filesystem::remove_all(path); }
    [[nodiscard]] std::string operator/(const char* name) const { return (path / name).string(); }
};

/// Replays a recorded run and returns its last hash; the test fails if a step differs.
std::uint64_t madeAgain(const std::string& file, std::size_t steps)
{
    const record::Recording recording = record::readRecording(file);
    CHECK(recording.steps.size() == steps);
    const auto engine = engine::makeNativeEngine({.period = recording.header.period});
    CHECK_FALSE(record::replay(recording.steps, *engine));
    return engine->hash();
}

} // namespace

TEST_CASE("a headless run with commands on its way is replayed from its recording")
{
    const Folder folder;
    Simulation sim({.physics = {.rate = 500}});
    const BodyId body = sim.add(bunny());
    std::optional<BodyId> guest;
    sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent& update) {
        if (update.step == 3) sim.physics().setMaterial(body, FemMaterial{.youngModulus = 4_kPa});
        if (update.step == 6) sim.physics().setForces(body, {{.node = 5, .force = {0.05, 0, 0}}});
        if (update.step == 9) sim.physics().setPressure(body, 30.0);
        if (update.step == 12) guest = sim.add(bunny());
        if (update.step == 15) sim.physics().reset();
        if (update.step == 18) sim.physics().remove(*guest);
    });
    const RunReport report = sim.run({.headless = true, .steps = 25, .record = folder / "run.rec"});
    CHECK(record::RecordingReader(folder / "run.rec").header().period == 1.0 / 500);
    CHECK(record::RecordingReader(folder / "run.rec").header().simd == engine::simdTargets().front());
    CHECK(madeAgain(folder / "run.rec", 25) == report.hash);
}

TEST_CASE("a live run is replayed from its recording")
{
    const Folder folder;
    Simulation sim;
    const BodyId body = sim.add(bunny());
    sim.show(body);
    sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent& update) {
        if (update.step == 50) sim.physics().setPressure(body, 20.0); // at whichever step it comes
    });
    const RunReport report =
        sim.run({.backend = Backend::Null, .steps = 300, .log = folder / "run.csv", .record = folder / "run.rec"});
    CHECK(madeAgain(folder / "run.rec", 300) == report.hash);
    std::ifstream table(folder / "run.csv"); // both files are written from the same log
    int lines = 0;
    for (std::string line; std::getline(table, line);) ++lines;
    CHECK(lines == 301);
}

TEST_CASE("a live run whose solvers were stopped by the deadline is replayed without one")
{
    const Folder folder;
    Simulation sim({.physics = {.deadline = 1e-9}}); // has always passed
    for (const char* name : {"left", "right"}) {
        SoftBodyDef body = bunny();
        body.name = name;
        body.solver = ConjugateGradient{.tolerance = 1e-8};
        sim.add(body);
    }
    const RunReport report = sim.run({.backend = Backend::Null, .steps = 200, .record = folder / "run.rec"});
    CHECK(report.outOfTime > 100);
    CHECK(madeAgain(folder / "run.rec", 200) == report.hash);
}

TEST_CASE("only a simulation's first run can be recorded")
{
    const Folder folder;
    Simulation sim;
    sim.run({.headless = true, .steps = 2});
    CHECK_THROWS_WITH(sim.run({.headless = true, .steps = 2, .record = folder / "run.rec"}),
                      "run: record is for a simulation's first run, but this one has already made 2 steps");
    CHECK(sim.run({.headless = true, .steps = 2}).steps == 4);
}

TEST_CASE("a run whose files find no room on the disk goes on, and reports each file once")
{
    const Folder folder;
    std::filesystem::create_symlink("/dev/full", folder.path / "full.rec");
    std::filesystem::create_symlink("/dev/full", folder.path / "full.csv");
    for (const bool headless : {true, false}) {
        Simulation sim;
        sim.add(bunny());
        std::mutex mutex;
        std::vector<std::string> logged, posted;
        sim.on<FileFailedEvent>([&](const FileFailedEvent& failed) {
            const std::lock_guard lock(mutex);
            posted.push_back(failed.problem);
        });
        setLogSink([&](LogLevel level, std::string_view line) {
            const std::lock_guard lock(mutex);
            if (level == LogLevel::Error) logged.emplace_back(line);
        });
        const RunReport report = sim.run({.headless = headless,
                                          .backend = Backend::Null,
                                          .steps = 400,
                                          .log = folder / "full.csv",
                                          .record = folder / "full.rec"});
        sim.events().deliverAll();
        setLogSink({});
        CHECK(report.steps == 400);
        const std::string why = ": cannot be written (disk full?)";
        const std::vector<std::string> problems = {folder / "full.csv" + why, folder / "full.rec" + why};
        std::vector<std::string> found = report.fileProblems;
        std::ranges::sort(found);
        CHECK(found == problems);
        std::ranges::sort(posted);
        CHECK(posted == problems);
        std::ranges::sort(logged);
        REQUIRE(logged.size() == 2);
        for (std::size_t i = 0; i < 2; ++i) CHECK_THAT(logged[i], Catch::StartsWith(problems[i]));
        CHECK_THAT(runtime::summary(report), Catch::Contains("incomplete: " + problems[1]));
    }
}

TEST_CASE("physics goes on while a disk takes nothing, and no step is lost")
{
    const Folder folder;
    const std::string pipe = folder / "slow.rec";
    REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
    std::promise<void> far; // set when physics has come far although nobody read its data
    std::thread disk([&] {
        const int from = open(pipe.c_str(), O_RDONLY);
        fcntl(from, F_SETPIPE_SZ, 4096);
        far.get_future().wait();
        std::ofstream to(folder / "whole.rec", std::ios::binary);
        char bytes[4096];
        for (ssize_t got = 0; (got = read(from, bytes, sizeof bytes)) > 0;) to.write(bytes, got);
        close(from);
    });
    Simulation sim;
    sim.add(bunny());
    sim.on<PhysicsUpdateEvent>([&, reached = false](const PhysicsUpdateEvent& update) mutable {
        if (update.step >= 1500 && !std::exchange(reached, true)) far.set_value(); // else the reader waits for ever
    });
    const RunReport report = sim.run({.backend = Backend::Null, .steps = 1600, .record = pipe});
    disk.join();
    CHECK(report.fileProblems.empty());
    const record::Recording recording = record::readRecording(folder / "whole.rec");
    CHECK(recording.steps.size() == 1600);
    for (const auto& step : recording.steps) REQUIRE_FALSE(step.report.has(physics::StepFlag::RecordLost));
}

TEST_CASE("a recording has the run's session and trainee names")
{
    const Folder folder;
    Simulation sim;
    sim.run({.headless = true, .steps = 1, .record = folder / "run.rec", .seed = 5, .session = "s", .trainee = "<T>"});
    const record::RecordingHeader header = record::RecordingReader(folder / "run.rec").header();
    CHECK((header.seed == 5 && header.session == "s" && header.trainee == "<T>"));
    CHECK(header.date.size() == std::string("2026-11-20 18:05:31").size());
}

TEST_CASE("a simulation's command line records")
{
    const Folder folder;
    const std::string file = folder / "run.rec";
    Simulation sim;
    sim.add(bunny());
    const char* words[] = {"program", "--headless", "--steps", "3", "--record", file.c_str()};
    CHECK(sim.run(6, words) == 0);
    madeAgain(file, 3);
}

TEST_CASE("the summary counts what did not go as asked")
{
    RunReport report;
    CHECK_THAT(runtime::summary(report), Catch::StartsWith("0 steps, "));
    CHECK_THAT(runtime::summary(report),
               Catch::Contains("rolled back 0, solver at its iteration limit 0, at the deadline 0\n"));
    report.timing.stepCount = 1;
    CHECK_THAT(runtime::summary(report), Catch::StartsWith("1 step, "));
    report.undone = 5;
    report.notConverged = 2;
    report.damped = 3;
    report.outOfTime = 4;
    report.inverted = 6;
    report.worstInverted.count = 7;
    report.worstInvertedBody = "liver";
    report.worstInverted.place = {0.001, 0.002, 0.003};
    report.intersecting = 9;
    report.deepestIntersection = {.first = BodyId{3}, .second = BodyId{3}, .crossings = 4, .depth = 1.234e-3};
    report.deepestIntersection.cause = physics::IntersectionCause::Own;
    report.deepestIntersection.force = 0.25;
    report.deepestBodies = {"tube", "tube"};
    report.beyondStrain = 1;
    report.worstStrained.strain = 0.4567;
    report.worstStrained.valid = 0.3;
    report.worstStrainedBody = "gall bladder";
    report.restless = 8;
    report.worstUnrest.speed = 0.0123;
    report.worstUnrest.undriven = 6.04;
    report.worstUnrestBody = "stump";
    CHECK_THAT(runtime::summary(report),
               Catch::Contains("elements inside out in 6 steps, at most 7 at once; then the worst was in 'liver' at "
                               "(1.0 2.0 3.0) mm\n"));
    CHECK_THAT(runtime::summary(report),
               Catch::Contains("surfaces pass through each other in 9 steps: the surface of "
                               "'tube' through itself by 1.23 mm (it does not collide with itself, 0.25 N) at "
                               "(0.0 0.0 0.0) mm\n"));
    CHECK_THAT(runtime::summary(report), Catch::Contains("tissue beyond the range of its material in 1 step: strain "
                                                         "0.457 in 'gall bladder', valid up to 0.3, at "));
    const std::string unrest = "not at rest in 8 steps: 'stump' moved at 12.3 mm/s, 6 s after anything drove it";
    CHECK_THAT(runtime::summary(report), Catch::Contains(unrest + "\n"));
    report.opened = {{.body = "liver", .steps = 3, .cut = 12.34e-6, .torn = 0.5e-6, .pieces = 2}};
    report.nothingChanged = 1;
    CHECK_THAT(runtime::summary(report),
               Catch::Contains("\n'liver': cut 12.3 mm^2, torn 0.5 mm^2, in 3 steps; pieces that came off: 2\n"));
    report.opened = {{.body = "silk", .steps = 1, .cut = 0.0314e-6, .pieces = 1}}; // a thread of 0.1 mm
    CHECK_THAT(runtime::summary(report), Catch::Contains("\n'silk': cut 0.031 mm^2, torn 0.0 mm^2, in 1 step; pieces"));
    CHECK_THAT(runtime::summary(report), Catch::Contains("(SetTissue) found no element in 1 step\n"));
    report.refused = {.steps = 5, .jumped = 2, .off = 3};
    CHECK_THAT(
        runtime::summary(report),
        Catch::Contains("\nblades that cut nothing in 5 steps, jumped in 2, switched off and pushed on into tissue "
                        "in 3\n"));
    report.energyGained = 2;
    CHECK_THAT(runtime::summary(report), Catch::Contains(unrest + "; energy from nowhere in 2 of them\n"));
    CHECK_THAT(
        runtime::summary(report),
        Catch::Contains(
            "rolled back 5 (3 advanced again with damping), solver at its iteration limit 2, at the deadline 4\n"));
}

TEST_CASE("a simulation's command line refuses in one line what is no number, out of bounds or unknown")
{
    Simulation sim;
    const auto refusal = [&](std::vector<const char*> words) {
        words.insert(words.begin(), "program");
        std::ostringstream said;
        std::streambuf* const before = std::cerr.rdbuf(said.rdbuf());
        const int code = sim.run(static_cast<int>(words.size()), words.data());
        std::cerr.rdbuf(before);
        CHECK(code == 2);
        return said.str();
    };
    CHECK(refusal({"--steps", "abc"}) == "run: --steps must be a whole number in [0, 2147483647], got 'abc'\n");
    CHECK(refusal({"--steps", ""}) == "run: --steps must be a whole number in [0, 2147483647], got ''\n");
    CHECK(refusal({"--steps", "-1"}) == "run: --steps must be a whole number in [0, 2147483647], got -1\n");
    CHECK(refusal({"--seconds", "1e9"}) == "run: --seconds must be in [0, 100000000] s, got 1e9\n");
    CHECK(refusal({"--picture-every", "often"}) == "run: --picture-every must be >= 0 s, got 'often'\n");
    CHECK(refusal({"--record", ""}) == "run: --record must not be empty\n");
    CHECK(refusal({"--steps"}) == "--steps must be given once, with one value\n");
    CHECK(refusal({"--stesp", "3"}) == "unknown word '--stesp'; --help lists the known ones\n");
    const std::string endless = text("/", std::string(1000, 'x'), ".rec");
    CHECK(refusal({"--record", endless.c_str()}).size() < 200);
}

TEST_CASE("one file by two names is refused for log and recording")
{
    const Folder folder;
    std::filesystem::create_symlink(folder / "run.rec", folder / "run.csv");
    Simulation sim;
    CHECK_THROWS_WITH(sim.run({.headless = true, .steps = 3, .log = folder / "run.csv", .record = folder / "run.rec"}),
                      folder / "run.rec" + ": is already being written, under this or another name");
}

TEST_CASE("a run that begins paused is replayed from its recording")
{
    const Folder folder;
    Simulation sim;
    sim.add(bunny());
    sim.physics().pause(true);
    int steps = 0;
    sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent&) {
        if (++steps == 4) sim.physics().pause(false);
    });
    const RunReport report = sim.run({.headless = true, .steps = 10, .record = folder / "run.rec"});
    CHECK(report.steps == 6);
    CHECK(madeAgain(folder / "run.rec", 10) == report.hash);
}

} // namespace record_test
