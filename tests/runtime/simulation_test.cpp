#include "filasofia/filasofia.h"

#include "filasofia/engine/native/native.h"

#include <csignal>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <thread>

namespace simulation_test {

using namespace filasofia;

namespace {

SoftBodyDef bunny(const std::string& name = "bunny")
{
    return {
        .name = name, .mesh = asset("meshes/bunny_756.msh"), .attachments = {{.box = Box{{-1, 0.105, -1}, {1, 1, 1}}}}};
}

RunDef live(double seconds) { return {.backend = visual::Backend::Null, .seconds = seconds}; }
RunDef headless(int steps) { return {.headless = true, .steps = steps}; }

std::vector<std::string> linesOf(const std::string& file)
{
    std::vector<std::string> lines;
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}

} // namespace

TEST_CASE("an empty list is the default Def")
{
    Simulation sim({}), other;
    CHECK(sim.run(headless(2)).hash == other.run(headless(2)).hash);
    Simulation slow({.physics = {.rate = 100}});
    CHECK(slow.run(headless(2)).time == Approx(0.02));
    STATIC_REQUIRE_FALSE(std::is_copy_constructible_v<Simulation>);
}

TEST_CASE("two headless runs of the same scene end in the same hash")
{
    std::uint64_t hash[2];
    for (std::uint64_t& each : hash) {
        Simulation sim;
        sim.show(sim.add(bunny()));
        const RunReport report = sim.run(headless(50));
        each = report.hash;
        CHECK(report.steps == 50);
        CHECK(report.time == Approx(0.05));
        CHECK(report.finished == "made 50 steps");
    }
    CHECK(hash[0] == hash[1]);
}

TEST_CASE("a live run without a window steps, draws and ends")
{
    Simulation sim;
    const BodyId body = sim.add(bunny());
    sim.show(body, {.surface = asset("meshes/bunny.obj"), .subdivision = 1});
    sim.show(body);
    const RunReport report = sim.run({.backend = visual::Backend::Null, .steps = 100});
    CHECK(report.steps == 100);
    CHECK(report.visual.framesDrawn >= 1);
    CHECK(report.visual.bodies == 2);
    CHECK(report.undone == 0);
    const auto frame = sim.physics().latest();
    CHECK(frame->step == report.steps);
}

TEST_CASE("a simulation may run again and goes on where it was")
{
    Simulation sim;
    sim.show(sim.add(bunny()));
    sim.run(live(0.05));
    const RunReport first = sim.run(headless(5));
    const RunReport second = sim.run(headless(5));
    CHECK(second.steps == first.steps + 5);
}

TEST_CASE("every event of a headless step is delivered before the next step begins")
{
    std::uint64_t hash[2];
    for (std::uint64_t& each : hash) {
        Simulation sim;
        sim.add(bunny());
        std::vector<std::uint64_t> steps;
        sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent& update) {
            steps.push_back(update.step);
            if (update.step == 10) sim.physics().setGravity({9.81, 0, 0}); // at the same step every time
        });
        each = sim.run(headless(20)).hash;
        REQUIRE(steps.size() == 20);
        for (std::size_t i = 0; i < steps.size(); ++i) CHECK(steps[i] == i + 1);
    }
    CHECK(hash[0] == hash[1]);
}

TEST_CASE("finish() ends a run from another thread, and the report says why")
{
    Simulation sim;
    sim.add(bunny());
    std::thread other([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        sim.finish("the polyp is out");
    });
    const RunReport report = sim.run({.backend = visual::Backend::Null});
    other.join();
    CHECK(report.finished == "the polyp is out");
}

TEST_CASE("an observer may end a headless run")
{
    Simulation sim;
    sim.add(bunny());
    sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent& update) {
        if (update.step == 3) sim.finish("enough");
    });
    const RunReport report = sim.run(headless(0));
    CHECK(report.steps == 3);
    CHECK(report.finished == "enough");
}

TEST_CASE("Ctrl-C ends a run cleanly")
{
    for (const bool isHeadless : {false, true}) {
        Simulation sim;
        sim.add(bunny());
        std::atomic<int> steps = 0;
        sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent&) {
            if (++steps == 2) std::raise(SIGINT);
        });
        const RunReport report = sim.run({.headless = isHeadless, .backend = visual::Backend::Null});
        CHECK(report.finished == "interrupted");
    }
}

TEST_CASE("the end of the terminal ends a run cleanly, unless nohup has told it to go on")
{
    for (const bool ignored : {false, true}) {
        CAPTURE(ignored);
        const auto before = std::signal(SIGHUP, ignored ? SIG_IGN : SIG_DFL);
        Simulation sim;
        sim.add(bunny());
        int steps = 0;
        sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent&) {
            if (++steps == 2) std::raise(SIGHUP);
        });
        const RunReport report = sim.run(headless(10));
        CHECK(report.finished == (ignored ? "made 10 steps" : "interrupted"));
        CHECK(std::signal(SIGHUP, before) == (ignored ? SIG_IGN : SIG_DFL));
    }
}

TEST_CASE("bodies are added and removed while a simulation runs")
{
    Simulation sim;
    std::thread surgeon([&] {
        for (int i = 0; i < 5; ++i) {
            const BodyId id = sim.add(bunny("guest"));
            sim.show(id);
            std::this_thread::sleep_for(std::chrono::milliseconds(40));
            sim.physics().remove(id);
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        sim.finish("done");
    });
    const RunReport report = sim.run({.backend = visual::Backend::Null});
    surgeon.join();
    CHECK(report.finished == "done");
    CHECK(report.visual.bodies == 0);
}

TEST_CASE("finish() between two runs ends the next one at once, and only that one")
{
    Simulation sim;
    sim.finish("not today");
    CHECK(sim.run(headless(5)).finished == "not today");
    CHECK(sim.run(headless(5)).finished == "made 5 steps");
}

TEST_CASE("a run inside a run is refused, and the outer one does not notice")
{
    Simulation sim;
    sim.add(bunny());
    std::string refused;
    const auto inner = [&] {
        try {
            sim.run(headless(50));
        } catch (const Error& error) {
            refused = error.what();
        }
    };
    sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent&) { inner(); });
    CHECK(sim.run(headless(5)).steps == 5);
    CHECK_THAT(refused, Catch::Contains("a run is going on"));
    refused.clear();
    CHECK(sim.run({.backend = visual::Backend::Null, .steps = 20}).steps == 25);
    CHECK_THAT(refused, Catch::Contains("a run is going on"));
}

TEST_CASE("an empty event or tune is refused")
{
    Simulation sim;
    CHECK_THROWS_AS(sim.post(std::unique_ptr<event::Event>()), Error);
    CHECK_THROWS_AS(sim.tune({}), Error);
}

TEST_CASE("a run that fails leaves a simulation that can run")
{
    Simulation sim;
    sim.show(sim.add(bunny()));
    sim.dress([](visual::VisualServer&) { fail("no light today"); });
    CHECK_THROWS_WITH(sim.run({.backend = visual::Backend::Null, .steps = 3}), "no light today");
    sim.dress({});
    const RunReport report = sim.run({.backend = visual::Backend::Null, .steps = 3});
    CHECK(report.finished == "made 3 steps");
    CHECK(report.visual.bodies == 1);
}

TEST_CASE("what was asked of blades and not done is told at the end of a run")
{
    Simulation sim;
    physics::SoftBodyDef tissue = bunny();
    tissue.dynamicTopology = true;
    const BodyId body = sim.add(tissue);
    CHECK(warnings(sim.run(headless(2))).empty());
    sim.add(physics::RigidBodyDef{
        .name = "knife",
        .elements = {{{1.0, 0.0, 0.0}, {}}},
        .collision = {{.mesh = geometry::shapes::box({0.01, 0.01, 0.01}), .group = 3, .cutting = true}}});
    sim.physics().removePiece(body, 7);
    const RunReport report = sim.run(headless(2));
    const std::string idle = "blade of 'knife' cuts nothing: no body that may be cut has its group";
    const std::string gone = "pieces that could not be removed: 1";
    CHECK(warnings(report) == std::vector<std::string>{gone, idle});
    CHECK_THAT(summary(report), Catch::Contains(gone + "\n" + idle + "\n"));
    CHECK(warnings(sim.run(headless(2))) == std::vector{idle}); // it still is
    tissue.collision = {{.group = 3}};
    sim.add(tissue);
    CHECK(warnings(sim.run(headless(2))).empty());
    RunReport cut;
    cut.refused.inVain = 2;
    CHECK(warnings(cut) == std::vector<std::string>{"strokes of blades that opened nothing: 2"});
}

TEST_CASE("a run at whose end a body is rolled back has failed, and one that recovers has not")
{
    Simulation sim;
    const BodyId body = sim.add(bunny());
    const RunReport good = sim.run(headless(20));
    CHECK(good.complete());
    CHECK(good.undoneAtEnd == 0);
    std::vector<NodalForce> beyond; // all numbers, in every step
    for (int node = 0; node < 237; ++node) beyond.push_back({node, {1e300, 1e300, 0.0}});
    sim.physics().setForces(body, beyond);
    const RunReport failed = sim.run(headless(30));
    CHECK(failed.undoneAtEnd == 30);
    CHECK_FALSE(failed.complete());
    CHECK_THAT(summary(failed), Catch::Contains("physics failed: in the last 30 steps of the run a body had no finite "
                                                "state and was rolled back"));
    const std::string undone = text("a new state was not finite and was rolled back in 30 steps, first of '",
                                    sim.physics().nameOf(body), "'; in 30 of them it advanced again with damping");
    REQUIRE_FALSE(warnings(failed).empty());
    CHECK(warnings(failed)[0] == undone);
    CHECK_THAT(summary(failed), Catch::Contains(undone + "\n"));
    CHECK(warnings(good).empty());
    sim.physics().setForces(body, {});
    const RunReport again = sim.run(headless(20));
    CHECK(again.undoneAtEnd == 0);
    CHECK(again.complete());
    CHECK_THAT(summary(again), !Catch::Contains("physics failed"));
}

TEST_CASE("several functions dress a scene in order, and none can be set during a run")
{
    Simulation sim;
    std::string order, refused;
    sim.dress([&](visual::VisualServer&) { order += 'a'; });
    sim.dress([&](visual::VisualServer&) {
        order += 'b';
        try {
            sim.dress({});
        } catch (const Error& error) {
            refused = error.what();
        }
    });
    sim.run({.backend = visual::Backend::Null, .steps = 3});
    CHECK(order == "ab");
    CHECK(refused == "simulation: dress must be set before a run, but one is going on");
}

TEST_CASE("a kinematic rigid body goes to the pose that was set")
{
    Simulation sim;
    const BodyId probe = sim.add(RigidBodyDef{.name = "probe"});
    sim.show(probe, {.surface = asset("meshes/bunny.obj"), .material = MetalMaterial{}});
    visual::VisualServer* server = nullptr;
    sim.dress([&](visual::VisualServer& visual) { server = &visual; });
    const Pose pose{{0.1, 0.2, 0.3}, axisAngle({0, 1, 0}, 1.0)};
    sim.physics().setPose(probe, pose);
    const RunReport report = sim.run(live(0.1));
    CHECK(server != nullptr);
    CHECK(report.visual.bodies == 1);
    CHECK(sim.physics().latest()->rigidBody(probe)->poses[0] == pose);
}

TEST_CASE("tune() reaches the engine of a simulation")
{
    Simulation sim;
    sim.add(bunny());
    int elements = 0;
    sim.tune([&](engine::Native& native) { elements = native.elementCount(native.softBodies().front()); });
    sim.run(headless(1));
    CHECK(elements == 754); // the mesh file's number, within 1 % of its name
}

TEST_CASE("a log has a line per step with the state's hash")
{
    const std::string file =
        (std::filesystem::temp_directory_path() / text("filasofia_simulation_test_", getpid(), ".csv")).string();
    Simulation sim;
    sim.add(bunny());
    const RunReport report = sim.run({.headless = true, .steps = 12, .log = file});
    const auto lines = linesOf(file);
    REQUIRE(lines.size() == 13);
    char hash[20];
    std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(report.hash));
    CHECK_THAT(lines.back(), Catch::Contains(text(",", hash, ",")));
    std::filesystem::remove(file);
}

TEST_CASE("what cannot be run is refused before anything starts")
{
    Simulation sim;
    CHECK_THROWS_WITH(sim.run({.headless = true, .steps = -1}), "run: steps must be >= 0, got -1");
    CHECK_THROWS_WITH(sim.run({.headless = true, .picture = "x.jpg"}), "run: picture must end in .png, got 'x.jpg'");
    CHECK_THROWS_WITH(sim.run({.headless = true, .record = "x.csv"}), "run: record must end in .rec, got 'x.csv'");
    CHECK_THROWS_WITH(Simulation({.physics = {.deadline = 0.0}}), "simulation: physics.deadline must be > 0 s, got 0");
    CHECK_THROWS_WITH(sim.run({.headless = true, .picture = "/no/folder/x.png"}),
                      "run: picture '/no/folder/x.png': there is no such folder");
    CHECK_THROWS_WITH(sim.run({.headless = true, .seconds = 1}),
                      "run: seconds is for live runs; a headless run ends after steps");
    CHECK_THROWS_WITH(Simulation({.physics = {.rate = 0}}),
                      "simulation: physics.rate must be in [1, 100000] Hz, got 0");
    RunDef longName = headless(1);
    longName.picture.assign(300, 'x').append(".png"); // longer than a file name can be
    CHECK_THROWS_AS(sim.run(longName), Error);
    CHECK_THROWS_WITH(sim.run({.headless = true, .picture = "x.png", .pictureEvery = 1e-20}),
                      Catch::Contains("run: pictureEvery must be 0 or >= 0.001 s"));
    CHECK_THROWS_WITH(Simulation({.look = {.direction = {}}}), Catch::Contains("look.direction"));
    CHECK_THROWS_WITH(Simulation({.look = {.around = Box{{1, 0, 0}, {0, 1, 1}}}}), Catch::Contains("look.around"));
    CHECK_THROWS_WITH(sim.show(BodyId{77}), Catch::Contains("no such body"));
    const BodyId probe = sim.add(RigidBodyDef{.name = "probe"});
    CHECK_THROWS_WITH(
        sim.show(probe),
        "show rigid body 'probe': surface must name a file or be a surface, as the body has no mesh of its own");
    CHECK_THROWS_WITH(sim.show(probe, {.surface = asset("meshes/bunny.obj"), .element = 1}),
                      "show rigid body 'probe': element must be in [0, 1), got 1");
    CHECK_THROWS_WITH(sim.show(sim.add(bunny()), {.subdivision = 4}),
                      "show soft body 'bunny': subdivision must be in [0, 3], got 4");
    CHECK_THROWS_WITH(asset("meshes/cow.msh"), Catch::Contains("asset 'meshes/cow.msh' is in none of"));
}

TEST_CASE("a simulation's command line refuses what it does not know with exit code 2")
{
    Simulation sim;
    const char* unknown[] = {"program", "--headles"};
    CHECK(sim.run(2, unknown) == 2);
    const char* wrong[] = {"program", "--headless", "--steps", "many"};
    CHECK(sim.run(4, wrong) == 2);
    const char* good[] = {"program", "--headless", "--steps", "3"};
    CHECK(sim.run(4, good) == 0);
}

TEST_CASE("an exception in a user's dress ends the run with one line, --fps without a video is refused")
{
    Simulation sim;
    sim.dress([](visual::VisualServer&) { throw std::runtime_error("no lamp"); });
    const char* picture[] = {"program", "--headless", "--steps", "2", "--picture", "never.png"};
    CHECK(sim.run(6, picture) == 2);
    sim.dress({});
    sim.dress([](visual::VisualServer&) { throw 42; });
    CHECK(sim.run(6, picture) == 2);
    const char* fps[] = {"program", "--headless", "--steps", "2", "--fps", "20"};
    CHECK(sim.run(6, fps) == 2);
    const char* good[] = {"program", "--headless", "--steps", "2"};
    CHECK(sim.run(4, good) == 0);
}

TEST_CASE("bodies that were shown and removed before a run are not drawn, however many there were")
{
    const auto ball = shapes::sphere(5_mm, 1);
    Simulation sim;
    sim.show(sim.add(RigidBodyDef{.name = "stays", .mesh = ball}));
    for (int i = 0; i < 1500; ++i) { // more than a visual server holds
        const BodyId id = sim.add(RigidBodyDef{.name = "goes", .mesh = ball});
        sim.show(id);
        sim.physics().remove(id);
    }
    const RunReport report = sim.run({.backend = Backend::Null, .steps = 5});
    CHECK(report.visual.bodies == 1);
}

} // namespace simulation_test
