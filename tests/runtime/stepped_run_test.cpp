#include "filasofia/filasofia.h"

#include "filasofia/record/recording.h"
#include "filasofia/runtime/replay.h"
#include "filasofia/runtime/stepped_run.h"
#include "filasofia/window/null_window.h"
#include "skip.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <thread>

#include <unistd.h>

namespace stepped_run_test {

using namespace filasofia;
using runtime::SteppedRun;

namespace {

/// A ball that is pressed into a block of tissue: scripted, with contacts and their events.
struct Poke {
    Simulation sim;
    BodyId block, ball;
    int begins = 0;

    Poke()
    {
        block = sim.add(SoftBodyDef{.name = "block",
                                    .mesh = shapes::block({60_mm, 30_mm, 60_mm}, {5, 3, 5}),
                                    .attachments = {{.box = Box{{-1, -1, -1}, {1, -14.9_mm, 1}}}},
                                    .collision = {{}}});
        ball = sim.add(RigidBodyDef{
            .name = "ball", .elements = {{{0, 25_mm, 0}}}, .mesh = shapes::sphere(8_mm), .collision = {{}}});
        sim.everyStep([this](double time) { sim.physics().setPose(ball, {{0, 25_mm - 0.1 * time, 0}}); });
        sim.on<ContactEvent>([this](const ContactEvent& touch) { begins += touch.kind == ContactEvent::Kind::Begin; });
    }
};

} // namespace

TEST_CASE("a run that is stepped from outside ends in the hash of a headless run, with the same events")
{
    Poke whole, stepped;
    const RunReport expected = whole.sim.run({.headless = true, .steps = 60});
    SteppedRun run(stepped.sim);
    for (int i = 0; i < 60; ++i) {
        const physics::StepReport step = run.step();
        CHECK(step.step == static_cast<std::uint64_t>(i + 1));
    }
    CHECK_THAT(summary(run.report()), Catch::Contains("ended: not yet") && !Catch::Contains("one step takes"));
    const RunReport report = run.end();
    CHECK(report.hash == expected.hash);
    CHECK(report.steps == 60);
    CHECK(report.time == Approx(0.06));
    CHECK(report.finished == "made 60 steps");
    CHECK(whole.begins == 1);
    CHECK(stepped.begins == 1);
    REQUIRE(report.contacts.size() == 1);
    CHECK(report.contacts[0].maxNormalForce == expected.contacts.at(0).maxNormalForce);
}

TEST_CASE("steps that no clock counts have the exact length of the rate, whole nanoseconds or not")
{
    // Rounded to 33,333 ns, a minute at 30 kHz lasted 0.6 ms less.
    for (const double rate : {30e3, 60.0, 1000.0}) {
        const SimulationDef def{.physics = {.rate = rate}};
        Simulation whole(def), stepped(def);
        for (Simulation* each : {&whole, &stepped})
            each->add(RigidBodyDef{.mesh = shapes::sphere(10_mm), .dynamic = true});
        const RunReport expected = whole.run({.headless = true, .steps = 3000});
        SteppedRun run(stepped);
        for (int i = 0; i < 3000; ++i) run.step();
        CHECK(run.report().hash == expected.hash);
        CHECK(expected.time * rate == Approx(3000.0).epsilon(1e-10));
        CHECK(run.report().time == expected.time);
    }
}

TEST_CASE("without a pose the first picture frames what is shown where it is then")
{
    if (skipIf(!visual::hasBackend(Backend::Headless), "this build draws nothing")) return;
    // The picture framed where the ball had started: after half a second in free fall it showed nothing.
    Simulation sim;
    sim.show(sim.add(RigidBodyDef{.mesh = shapes::sphere(10_mm), .dynamic = true, .linearDamping = 0.0}));
    SteppedRun run(sim);
    for (int i = 0; i < 500; ++i) run.step();
    const visual::DepthImage depth = run.depth({.width = 96, .height = 72});
    const auto shows = [&](int x, int y) { return depth.label[static_cast<std::size_t>(y * 96 + x)] > 0; };
    CHECK(std::ranges::count_if(depth.label, [](auto label) { return label > 0; }) > 96 * 72 / 10);
    CHECK(shows(48, 36));
    for (int x = 0; x < 96; ++x) CHECK(!(shows(x, 0) || shows(x, 71)));
}

TEST_CASE("a stepped run may be stepped by one thread after another")
{
    Poke whole, stepped;
    const RunReport expected = whole.sim.run({.headless = true, .steps = 20});
    SteppedRun run(stepped.sim);
    for (int i = 0; i < 20; ++i) std::thread([&] { run.step(); }).join();
    CHECK(run.report().hash == expected.hash);
}

TEST_CASE("the recording of a stepped run replays bit for bit")
{
    const std::string file = (std::filesystem::temp_directory_path() / "stepped_run_test.rec").string();
    Poke poke;
    {
        SteppedRun run(poke.sim, {.record = file});
        for (int i = 0; i < 40; ++i) run.step();
    } // the destructor closes the file
    const runtime::ReplayReport replayed = runtime::replay({.file = file, .check = true});
    CHECK(replayed.made == 40);
    CHECK_FALSE(replayed.difference);
    CHECK(replayed.hash == poke.sim.physics().hash());
    std::filesystem::remove(file);
}

TEST_CASE("a stepped run is the only run of its simulation, and says what it cannot do")
{
    Poke poke;
    SteppedRun run(poke.sim);
    CHECK_THROWS_WITH(SteppedRun(poke.sim), Catch::Contains("a run is going on"));
    CHECK_THROWS_WITH(poke.sim.run({.headless = true, .steps = 1}), Catch::Contains("a run is going on"));
    run.end();
    CHECK_THROWS_WITH(run.step(), Catch::Contains("the run has ended"));
    CHECK_THROWS_WITH(run.end(), Catch::Contains("the run has ended"));
    CHECK_THROWS_WITH(SteppedRun(poke.sim, {.steps = 5}), Catch::Contains("steps and seconds must be 0"));
    CHECK_THROWS_WITH(SteppedRun(poke.sim, {.video = "a.mp4"}), Catch::Contains("video"));
    CHECK_THROWS_WITH(SteppedRun(poke.sim, {.log = "log.txt"}), Catch::Contains("log"));
    CHECK(poke.sim.run({.headless = true, .steps = 1}).steps == 1); // the failed ones left nothing behind
}

#ifdef FILASOFIA_HAS_FILAMENT
TEST_CASE("pictures of a stepped run have the size asked for and see the present state from any place")
{
    Poke poke;
    SteppedRun run(poke.sim);
    CHECK_THROWS_WITH(run.picture(), Catch::Contains("nothing is shown"));
    poke.sim.show(poke.block);
    poke.sim.show(poke.ball);
    const visual::Image before = run.picture({.width = 64, .height = 48});
    CHECK(before.width == 64);
    CHECK(before.height == 48);
    CHECK(run.picture({.width = 64, .height = 48}) == before);
    for (int i = 0; i < 60; ++i) run.step();
    visual::Image after;
    std::thread([&] { after = run.picture({.width = 64, .height = 48}); }).join(); // any thread
    CHECK_FALSE(after == before);
    const Pose above = visual::lookAt({0, 0.15, 0}, {}, {0, 0, 1});
    CHECK_FALSE(run.picture({.width = 64, .height = 48, .pose = above}) == after);
    CHECK(run.picture({.width = 64, .height = 48}) == after); // the look's camera is back
    CHECK(run.picture({.width = 96, .height = 32}).rgba.size() == 4u * 96 * 32);
    CHECK_THROWS_WITH(run.picture({.width = 0}), Catch::Contains("width must be in [1, 8192] px"));
    CHECK_THROWS_WITH(run.picture({.camera = visual::CameraDef{.near = -1}}), Catch::Contains("near"));
}
#endif

namespace {

/// A viewer whose window nobody sees; `person` acts on it as soon as it is open.
void watch(
    Simulation& sim, SteppedRun& run, visual::Backend backend,
    std::function<void(window::NullWindow&)> person = [](window::NullWindow&) {})
{
    sim.useWindow([person = std::move(person)](const window::WindowDef& def) {
        auto window = std::make_unique<window::NullWindow>(def);
        person(*window);
        return window;
    });
    run.openViewer({.window = {.width = 80, .height = 60}, .backend = backend, .rate = 1000.0});
}

} // namespace

TEST_CASE("a viewer changes no bit of a run, whose recording replays")
{
    const std::string file = (std::filesystem::temp_directory_path() / "viewer_test.rec").string();
    Poke watched, alone;
    watched.sim.show(watched.block);
    {
        SteppedRun run(watched.sim, {.record = file}), other(alone.sim);
        CHECK_FALSE(run.viewing());
        run.showInViewer(); // does nothing yet
        watch(watched.sim, run, visual::Backend::Null);
        CHECK(run.viewing());
        CHECK_THROWS_WITH(run.openViewer({.backend = visual::Backend::Null}), Catch::Contains("has one already"));
        for (int i = 0; i < 60; ++i) {
            run.step();
            other.step();
            if (i == 20) run.showInViewer();
            if (i == 30) {
                run.closeViewer();
                CHECK_FALSE(run.viewing());
                run.closeViewer(); // does nothing now
            }
            if (i == 40) watch(watched.sim, run, visual::Backend::Null);
        }
        CHECK(run.viewing());
        CHECK(run.report().hash == other.report().hash);
        run.end();
        CHECK_FALSE(run.viewing());
        CHECK_THROWS_WITH(run.openViewer(), Catch::Contains("the run has ended"));
    }
    const runtime::ReplayReport replayed = runtime::replay({.file = file, .check = true});
    CHECK(replayed.made == 60);
    CHECK_FALSE(replayed.difference);
    std::filesystem::remove(file);
}

TEST_CASE("the person closes a viewer, and the run goes on")
{
    Poke poke;
    poke.sim.show(poke.block);
    SteppedRun run(poke.sim);
    watch(poke.sim, run, visual::Backend::Null, [](window::NullWindow& window) {
        auto close = std::make_unique<event::WindowEvent>();
        close->kind = event::WindowEvent::Kind::CloseRequested;
        window.inject(std::move(close));
    });
    CHECK_FALSE(run.viewing());
    watch(poke.sim, run, visual::Backend::Null, [](window::NullWindow& window) {
        auto escape = std::make_unique<event::KeyEvent>();
        escape->key = event::KeyCode::Escape;
        escape->pressed = true;
        window.inject(std::move(escape));
    });
    CHECK_FALSE(run.viewing());
    CHECK(run.step().step == 1);
}

TEST_CASE("a viewer that cannot open is an Error and leaves the pictures as they were")
{
    Poke poke;
    SteppedRun run(poke.sim);
    CHECK_THROWS_WITH(watch(poke.sim, run, visual::Backend::Null), Catch::Contains("nothing is shown"));
    CHECK_FALSE(run.viewing());
    CHECK_THROWS_WITH(run.openViewer({.rate = 0.0}), Catch::Contains("rate must be in [1, 1000] 1/s"));
    poke.sim.show(poke.block);
    poke.sim.useWindow([](const window::WindowDef&) -> std::unique_ptr<window::Window> { fail("no display here"); });
    CHECK_THROWS_WITH(run.openViewer(), Catch::Contains("no display here"));
    CHECK_FALSE(run.viewing());
    CHECK(run.step().step == 1);
}

#ifdef FILASOFIA_HAS_FILAMENT
TEST_CASE("pictures beside a viewer are those without one, wherever the person looks")
{
    Poke poke;
    poke.sim.show(poke.block);
    poke.sim.show(poke.ball);
    SteppedRun run(poke.sim);
    for (int i = 0; i < 20; ++i) run.step();
    const Pose above = visual::lookAt({0, 0.15, 0}, {}, {0, 0, 1});
    const runtime::PictureDef usual{.width = 64, .height = 48}, other{.width = 32, .height = 48, .pose = above};
    const visual::Image first = run.picture(usual), second = run.picture(other);
    const visual::DepthImage depth = run.depth(other);
    for (const bool turned : {false, true}) {
        watch(poke.sim, run, visual::Backend::Headless, [&](window::NullWindow& window) {
            if (!turned) return;
            auto press = std::make_unique<event::MouseButtonEvent>();
            press->button = event::MouseButton::Left;
            press->pressed = true;
            window.inject(std::move(press));
            auto move = std::make_unique<event::MouseMoveEvent>();
            move->dx = 30.0;
            window.inject(std::move(move));
        });
        CHECK(run.picture(usual) == first);
        CHECK_THROWS_WITH(run.picture({.camera = visual::CameraDef{.near = -1}}), Catch::Contains("near"));
        CHECK(run.picture(other) == second);
        CHECK(run.depth(other) == depth);
        CHECK(run.viewing());
        run.closeViewer();
    }
    CHECK(run.picture(usual) == first);
}
#endif

TEST_CASE("a run that is refused leaves nothing behind: the next one records what was shown before")
{
    const std::string file = (std::filesystem::temp_directory_path() / "stepped_run_refused.rec").string();
    const std::string nowhere = "/nowhere/at/all.rec";
    const auto changes = [&](const std::function<void(Simulation&)>& refuse) { // the scene, before the first step
        Poke poke;
        poke.sim.show(poke.block);
        refuse(poke.sim);
        poke.sim.run({.headless = true, .steps = 2, .record = file});
        record::RecordingReader reader(file);
        static_cast<void>(reader.next());
        return reader.takeScene().size();
    };
    const std::size_t all = changes([](Simulation&) {});
    CHECK(all > 0);
    CHECK(changes([&](Simulation& sim) {
              CHECK_THROWS_WITH(sim.run({.headless = true, .steps = 2, .record = nowhere}), Catch::Contains(nowhere));
          }) == all);
    CHECK(changes([&](Simulation& sim) {
              CHECK_THROWS_WITH(SteppedRun(sim, {.record = nowhere}), Catch::Contains(nowhere));
          }) == all);
    std::filesystem::remove(file);
}

TEST_CASE("a stepped run returns to a saved state, and another simulation with the same bodies continues it")
{
    Poke poke, other;
    SteppedRun run(poke.sim);
    CHECK_THROWS_WITH(run.save(), "save: make a step first: the last AddBody has not taken effect");
    for (int i = 0; i < 70; ++i) run.step();
    const BodyId block = poke.block;
    poke.sim.physics().setPressure(poke.block, 500.0); // it waits for the next step
    const auto state = run.save();
    const auto follow = [block](Simulation& sim, SteppedRun& stepped) {
        std::vector<std::uint64_t> hashes;
        for (int i = 0; i < 20; ++i) {
            if (i == 5) sim.physics().attach(block, {.nodes = {0}, .stiffness = 10});
            stepped.step();
            hashes.push_back(sim.physics().hash());
        }
        return hashes;
    };
    const auto hashes = follow(poke.sim, run);
    poke.sim.physics().setPressure(poke.block, -500.0); // dropped
    run.restore(*state);
    CHECK(poke.sim.physics().latest()->step == 70);
    CHECK(poke.sim.physics().latest()->time == Approx(0.07));
    CHECK(follow(poke.sim, run) == hashes);
    SteppedRun second(other.sim);
    second.step();
    second.restore(*state);
    CHECK(follow(other.sim, second) == hashes);
    CHECK(run.report().steps == 90);

    poke.sim.physics().setMaterial(poke.block, FemMaterial{});
    CHECK_THROWS_WITH(run.save(), Catch::Contains("the last SetMaterial has not"));
    poke.sim.add(RigidBodyDef{.name = "late"});
    CHECK_THROWS_WITH(run.restore(*state), "restore: bodies were added or removed since the state was saved");
    Simulation lonely;
    lonely.add(SoftBodyDef{.name = "cube", .mesh = shapes::block({1_cm, 1_cm, 1_cm}, {1, 1, 1})});
    lonely.add(RigidBodyDef{.name = "ball"});
    SteppedRun third(lonely);
    third.step();
    CHECK_THROWS_WITH(third.restore(*state), Catch::Contains("the state has soft body 'block' with"));
    Poke recorded;
    const std::string file = (std::filesystem::temp_directory_path() / text("restore_", getpid(), ".rec")).string();
    {
        SteppedRun written(recorded.sim, {.record = file});
        written.step();
        CHECK_THROWS_WITH(written.restore(*state), Catch::Contains("where time only goes on"));
    }
    std::filesystem::remove(file);
}

TEST_CASE("a saved state has what a part of the program remembers, and what it does not know is an error")
{
    Simulation sim, other;
    int here = 0, there = 0;
    const auto remember = [](Simulation& in, int& count, const std::string& of) {
        in.remember({.of = of,
                     .save = [&] { return std::any(count); },
                     .restore = [&](const std::any& copy) { count = std::any_cast<int>(copy); }});
        in.everyStep([&count](double) { ++count; });
    };
    remember(sim, here, "count");
    remember(other, there, "count");
    CHECK_THROWS_WITH(sim.remember({.of = "count"}), "simulation: remember: of, save and restore must not be empty");
    bool gone = false;
    sim.remember({.of = "count", // another one of this name
                  .save = [&] { return gone ? std::any() : std::any(0.5); },
                  .restore = [](const std::any&) {}});
    std::string refused;
    sim.everyStep([&](double) {
        try {
            sim.remember({.of = "a", .save = [] { return std::any(); }, .restore = [](const std::any&) {}});
        } catch (const Error& error) {
            refused = error.what();
        }
    });
    SteppedRun run(sim), second(other);
    run.step();
    second.step();
    CHECK(refused ==
          "simulation: remember must be called before a run or between two steps of a stepped run, but a run "
          "or a step is going on");
    const auto early = run.save();
    for (int i = 0; i < 4; ++i) run.step();
    sim.finish("done");
    CHECK(run.report().finished == "done");
    run.restore(*early);
    CHECK(here == 1);
    CHECK(run.report().finished == "not yet");
    for (int i = 0; i < 2; ++i) run.step();
    const auto late = run.save();
    second.restore(*late);
    CHECK(there == 3);
    CHECK_THROWS_WITH(run.restore(*second.save()), "restore: the state knows nothing of count (2)");
    auto strange = *early;
    strange.memories["count"] = std::string("three");
    CHECK_THROWS_WITH(run.restore(strange), "restore: the state has another kind of count");
    CHECK(here == 3);
    gone = true;
    run.restore(*second.save());
    CHECK(here == 3);
}

TEST_CASE("a state is not restored while readers hold all frames, and nothing changes then")
{
    Poke poke;
    SteppedRun run(poke.sim);
    run.step();
    const auto state = run.save();
    std::vector<frame::FrameRef> held;
    for (int i = 0; i < 12; ++i) {
        held.push_back(poke.sim.physics().latest());
        run.step();
    }
    const std::uint64_t hash = poke.sim.physics().hash();
    CHECK_THROWS_WITH(run.restore(*state), "restore: readers hold all frames: release them first");
    CHECK(poke.sim.physics().hash() == hash);
    held.clear();
    run.restore(*state);
    CHECK(poke.sim.physics().latest()->step == 1);
}

} // namespace stepped_run_test
