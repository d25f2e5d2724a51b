#include "filasofia/filasofia.h"

#include "filasofia/core/log.h"
#include "filasofia/record/recording.h"
#include "filasofia/runtime/run_keys.h"
#include "filasofia/window/null_window.h"

#include <filesystem>
#include <fstream>

namespace controls_test {

using namespace filasofia;
using namespace filasofia::runtime;
using window::NullWindow;

namespace {

namespace fs = std::filesystem;

std::unique_ptr<event::Event> key(KeyCode code)
{
    auto event = std::make_unique<KeyEvent>();
    event->key = code;
    event->pressed = true;
    return event;
}

std::unique_ptr<event::Event> button(bool pressed)
{
    auto event = std::make_unique<MouseButtonEvent>();
    event->pressed = pressed;
    return event;
}

std::unique_ptr<event::Event> move(double dx, double dy)
{
    auto event = std::make_unique<MouseMoveEvent>();
    event->dx = dx;
    event->dy = dy;
    return event;
}

/// A simulation with a falling box, in a window that nobody sees.
struct Live {
    explicit Live(const LookDef& look = {}) : sim({.look = look})
    {
        body = sim.add(RigidBodyDef{.mesh = shapes::box({0.01, 0.01, 0.01}), .dynamic = true});
        sim.show(body);
        sim.useWindow([this](const window::WindowDef& def) {
            auto opened = std::make_unique<NullWindow>(def);
            window = opened.get();
            for (auto& event : first) window->inject(std::move(event));
            return opened;
        });
    }
    RunReport run() { return sim.run({.backend = Backend::Null}); }

    Simulation sim;
    BodyId body;
    NullWindow* window = nullptr;
    std::vector<std::unique_ptr<event::Event>> first; ///< what the person does at once
};

/// Opens a window with a person: `person` is called on the main thread each time the run looks for input.
auto personAt(std::function<void(NullWindow&, int look)> person)
{
    struct Watched final : window::Window {
        Watched(const window::WindowDef& def, std::function<void(NullWindow&, int)> who)
            : inner(def), person(std::move(who))
        {
        }
        [[nodiscard]] void* nativeWindow() const override { return nullptr; }
        [[nodiscard]] window::WindowSize size() const override { return inner.size(); }
        [[nodiscard]] double scale() const override { return 1.0; }
        void poll(const event::EventSink& sink) override
        {
            person(inner, ++looks);
            inner.poll(sink);
        }
        [[nodiscard]] bool shouldClose() const override { return false; }
        void setTitle(const std::string&) override {}

        NullWindow inner;
        std::function<void(NullWindow&, int)> person;
        int looks = 0;
    };
    return
        [person = std::move(person)](const window::WindowDef& def) { return std::make_unique<Watched>(def, person); };
}

/// A folder for one test; it is the working folder meanwhile.
struct OwnFolder {
    fs::path before = fs::current_path();
    fs::path folder = fs::temp_directory_path() / text("filasofia_controls_", getpid());
    OwnFolder()
    {
        fs::remove_all(folder);
        fs::create_directories(folder);
        fs::current_path(folder);
    }
    ~OwnFolder()
    {
        fs::current_path(before);
        fs::remove_all(folder);
    }
};

} // namespace

TEST_CASE("Escape ends a live run, unless its keys are switched off")
{
    {
        Live live;
        live.first.push_back(key(KeyCode::Escape));
        CHECK(live.run().finished == "Escape");
    }
    Live live({.keys = false});
    live.first.push_back(key(KeyCode::Escape));
    live.sim.on<KeyEvent>([&](const KeyEvent&) { live.sim.finish("mine"); });
    CHECK(live.run().finished == "mine");
}

TEST_CASE("a key held, released, or with Control does nothing to the run, observers hear of every key")
{
    KeyEvent event;
    event.key = KeyCode::Space;
    CHECK_FALSE(actionOf(event));
    event.pressed = true;
    CHECK(actionOf(event) == RunAction::Pause);
    event.repeat = true;
    CHECK_FALSE(actionOf(event));
    event.repeat = false;
    event.modifiers.control = true;
    CHECK_FALSE(actionOf(event));
}

TEST_CASE("a single step while paused makes one step, with everyStep, and is paused again")
{
    Simulation sim({.physics = {.gravity = {}}});
    std::vector<double> ends;
    sim.everyStep([&](double end) { ends.push_back(end); });
    sim.pause(true);
    sim.singleStep(); // has no effect: the simulation runs in the first step
    int made = 0;
    sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent&) {
        ++made;
        if (made == 1) CHECK(sim.paused());
        if (made == 5) sim.singleStep();
    });
    const RunReport report = sim.run({.headless = true, .steps = 10});
    CHECK(made == 10);
    CHECK(report.time == Approx(0.001));
    CHECK(sim.paused());
    sim.pause(false);
    CHECK(sim.run({.headless = true, .steps = 10}).time == Approx(0.011));
}

TEST_CASE("who goes on during a single step, or after asking for one, goes on: the last word counts")
{
    Simulation sim({.physics = {.gravity = {}}});
    sim.pause(true);
    int made = 0;
    sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent&) {
        if (++made != 3) return;
        sim.singleStep();
        sim.pause(false);
    });
    CHECK(sim.run({.headless = true, .steps = 10}).time == Approx(0.007)); // all after the third
    CHECK_FALSE(sim.paused());
}

TEST_CASE("Space pauses a live run, N makes one step of it, R puts the bodies back")
{
    Live live;
    Simulation& sim = live.sim;
    int did = 0;
    double pausedAt = 0.0, steppedTo = 0.0;
    Vec3 fallen, back;
    const auto now = [&] { return sim.physics().latest(); };
    // Each key waits for the effect of the one before it.
    live.sim.useWindow(personAt([&](NullWindow& window, int) {
        const FrameRef frame = now();
        if (!frame || frame->step < 20) return;
        if (did == 0) {
            window.inject(key(KeyCode::Space));
            ++did;
        } else if (did == 1 && sim.paused()) {
            pausedAt = now()->time; // the newest frame's time, not that of `frame`
            window.inject(key(KeyCode::N));
            ++did;
        } else if (did == 2 && frame->time > pausedAt) {
            steppedTo = frame->time;
            fallen = frame->rigidBodies.front().poses.front().position;
            window.inject(key(KeyCode::R));
            ++did;
        } else if (did == 3 && frame->rigidBodies.front().poses.front().position.y > fallen.y) {
            back = frame->rigidBodies.front().poses.front().position;
            window.inject(key(KeyCode::Escape));
            ++did;
        }
    }));
    CHECK(live.run().finished == "Escape");
    CHECK(steppedTo - pausedAt <= 0.003 + 1e-9); // one step: at most a period and its slack
    CHECK(fallen.y < 0.0);
    CHECK(back == Vec3{});
    CHECK(sim.paused());
}

TEST_CASE("single steps are in a recording, and it can be replayed")
{
    const OwnFolder folder;
    Simulation sim;
    const BodyId body = sim.add(RigidBodyDef{.mesh = shapes::box({0.01, 0.01, 0.01}), .dynamic = true});
    sim.on<PhysicsUpdateEvent>([&, made = 0](const PhysicsUpdateEvent&) mutable {
        ++made;
        if (made == 3) sim.pause(true);
        if (made == 6) sim.singleStep();
    });
    sim.run({.headless = true, .steps = 10, .record = "steps.rec"});
    int moving = 0;
    for (const auto& step : record::readRecording("steps.rec").steps) moving += step.report.dt > 0.0;
    CHECK(moving == 4);
    CHECK(sim.physics().latest()->rigidBody(body)->poses.front().position.y < 0.0);
}

TEST_CASE("a person turns the camera given to steer(), and observers hear of it too")
{
    Live live;
    visual::Camera* camera = nullptr;
    Vec3 turned;
    live.sim.dress([&](visual::VisualServer& visual) {
        camera = &visual.add(visual::CameraDef{});
        live.sim.steer(*camera, {.start = {{0, 0, 1}, {}}, .height = 720});
        CHECK(camera->pose().position == Vec3{0, 0, 1});
    });
    std::atomic<int> heard = 0;
    live.sim.on<MouseMoveEvent>([&](const MouseMoveEvent&) { ++heard; });
    live.sim.useWindow(personAt([&](NullWindow& window, int look) {
        if (look == 1) {
            window.inject(button(true));
            window.inject(move(360, 0)); // a quarter turn
            window.inject(button(false));
        }
        turned = camera->pose().position;
        if (look > 1 && heard > 0) live.sim.finish("seen");
    }));
    CHECK(live.run().finished == "seen");
    CHECK(heard == 1);
    CHECK(distance(turned, {-1, 0, 0}) < 1e-12);
}

#ifdef FILASOFIA_HAS_FILAMENT
TEST_CASE("the look of a live run turns with the mouse and comes back, not where that is switched off")
{
    const OwnFolder folder;
    const auto read = [](const std::string& name) {
        std::ifstream file(name, std::ios::binary);
        return std::string{std::istreambuf_iterator<char>(file), {}};
    };
    for (const bool mouse : {true, false}) {
        Simulation sim({.physics = {.gravity = {}},
                        .window = {.width = 64, .height = 48},
                        .look = {.direction = {0, 0, 1}, .quality = visual::Quality::Low, .mouse = mouse}});
        sim.show(sim.add(RigidBodyDef{.mesh = shapes::box({0.01, 0.02, 0.05})}));
        sim.useWindow(personAt([&](NullWindow& window, int look) {
            if (look == 1) sim.screenshot("before.png");
            if (look == 2) {
                sim.screenshot("turned.png");
                window.inject(button(true));
                window.inject(move(12, 5));
                window.inject(button(false));
            }
            if (look == 3) {
                sim.screenshot("home.png");
                window.inject(key(KeyCode::Home));
            }
            if (look == 4) sim.finish("seen");
        }));
        CHECK(sim.run({.backend = Backend::Headless}).pictures.size() == 3);
        CHECK((read("turned.png") != read("before.png")) == mouse);
        CHECK(read("home.png") == read("before.png"));
    }
}
#endif

TEST_CASE("only a camera of the visual server, without a parent, can be steered")
{
    Live live;
    live.first.push_back(key(KeyCode::Escape));
    visual::VisualServer other({.backend = Backend::Null});
    visual::Camera& foreign = other.add(visual::CameraDef{});
    CHECK_THROWS_WITH(live.sim.steer(foreign, {}),
                      Catch::Contains("steer: the camera does not belong to the visual server"));
    live.sim.dress([&](visual::VisualServer& visual) {
        CHECK_THROWS_AS(live.sim.steer(foreign, {}), Error);
        visual::Camera& camera = visual.add(visual::CameraDef{.name = "eye"});
        camera.attachTo(visual.addTransform("rig"));
        CHECK_THROWS_WITH(live.sim.steer(camera, {}), "steer: 'eye' has the parent 'rig': steer the parent");
        visual::Transform& gone = visual.addTransform("gone");
        live.sim.steer(gone, {});
        visual.remove(gone); // nothing touches it any more
    });
    live.first.push_back(button(true));
    live.first.push_back(move(10, 10));
    CHECK(live.run().finished == "Escape");
}

TEST_CASE("screenshots come from the program and from the key, without overwriting one another")
{
    const OwnFolder folder;
    std::ofstream("filasofia_001.png") << "somebody's";
    Live live;
    live.sim.screenshot("mine.png"); // before the run: its first picture
    live.first.push_back(key(KeyCode::P));
    live.first.push_back(key(KeyCode::F12));
    live.sim.on<event::VisualUpdateEvent>([&](const event::VisualUpdateEvent&) { live.sim.finish("drawn"); });
    const RunReport report = live.run();
    CHECK(report.pictures == std::vector<std::string>{"mine.png", "filasofia_002.png", "filasofia_003.png"});
    for (const std::string& picture : report.pictures) CHECK(fs::file_size(picture) > 100);
    CHECK(fs::file_size("filasofia_001.png") == 10);
    CHECK_THROWS_WITH(live.sim.screenshot("no/such/place.png"), Catch::Contains("there is no such folder"));
    CHECK_THROWS_WITH(live.sim.screenshot("mine.jpg"), Catch::Contains("must end in .png"));
}

TEST_CASE("a screenshot asked for just before finish() is taken, and one that cannot be written ends nothing")
{
    const OwnFolder folder;
    fs::create_directory("gone");
    std::vector<std::string> lines;
    setLogSink([&](LogLevel, std::string_view line) { lines.emplace_back(line); });
    Live live;
    live.sim.on<event::VisualUpdateEvent>([&, pictures = 0](const event::VisualUpdateEvent&) mutable {
        if (++pictures > 1) return;
        live.sim.screenshot("gone/one.png");
        std::error_code written;
        fs::remove("gone", written);
        live.sim.screenshot("last.png");
        live.sim.finish("enough");
    });
    // The folder is gone when the picture is written. If the picture was quicker, nothing is wrong.
    const RunReport report = live.run();
    setLogSink({});
    CHECK(report.finished == "enough");
    CHECK(report.pictures.back() == "last.png");
    CHECK(fs::exists("last.png"));
    CHECK(lines.size() + report.pictures.size() == 2);
}

TEST_CASE("the page about showing and the help name every key")
{
    std::ifstream file(FILASOFIA_SOURCE_DIR "/docs/guide/showing.md");
    const std::string page{std::istreambuf_iterator<char>(file), {}};
    for (const auto& [keys, meaning] : keyLines()) {
        CHECK_THAT(page, Catch::Contains(text("| ", keys, " | ", meaning, " |")));
        CHECK_THAT(keyHelp(), Catch::Contains(std::string(meaning)));
    }
}

} // namespace controls_test
