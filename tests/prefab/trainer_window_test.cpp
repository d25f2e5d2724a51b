#include "filasofia/geometry/shapes.h"
#include "filasofia/metric/session_file.h"
#include "filasofia/prefab/trainer_task.h"

#include "window/attended.h"

#include <catch2/catch.hpp>

#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace trainer_window_test {

using namespace filasofia;
using namespace filasofia::prefab;
using runtime::Simulation;
namespace fs = std::filesystem;

namespace {

/// A folder in which the test works, and programs of its own on PATH.
class Workplace {
public:
    Workplace() : before_(fs::current_path()), path_("PATH", place.c_str())
    {
        fs::remove_all(place);
        fs::create_directories(place);
        fs::current_path(place);
    }
    ~Workplace()
    {
        fs::current_path(before_);
        fs::remove_all(place);
    }
    void script(const std::string& name, const std::string& words) const
    {
        std::ofstream(place / name) << "#!/bin/sh\n" << words;
        chmod((place / name).c_str(), 0755);
    }
    [[nodiscard]] std::string read(const std::string& name) const
    {
        std::ifstream in(place / name);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    const fs::path place = fs::temp_directory_path() / text("filasofia_trainer_", getpid());

private:
    fs::path before_;
    window::ScopedVariable path_;
};

} // namespace

TEST_CASE("a trainee starts with a key, reaches the end, asks for the report, sees the replay, and goes")
{
    const window::VirtualDisplay display;
    const Workplace workplace;
    workplace.script("filasofia", "/bin/cat \"$2\" > \"$4\"\n"); // unless the real one is beside this program
    workplace.script("xdg-open", text("echo \"$1\" > ", (workplace.place / "opened").string()));
    visual::savePng({2, 2, std::vector<std::uint8_t>(16, 200)}, workplace.place / "drill.png");
    fs::create_directories("experts");
    metric::Session expert;
    expert.tracks = {{.name = "tool", .samples = {{.time = 0.1}, {.time = 0.2}}}};
    metric::writeSession("experts/drill_tooth_easy_1.jsonl", expert);

    int started = 0, looks = 0, allLooks = 0, step = 0;
    double end = 0.0, now = 0.0, earliest = 1e9; // [m], places of the box as drawn: at the end, now, in the replay
    const auto act = [&](window::Person& person) {
        const auto press = [&](const char* name) {
            person.key(name, true);
            person.key(name, false);
        };
        ++looks;
        if (++allLooks > 5000) return person.requestClose(); // something has failed: the checks below say what
        if (started == 0) return looks == 5 ? press("Return") : void();
        if (started == 1 && step == 5) { // back at the start screen
            if (looks == 5) person.requestClose();
            return;
        }
        if (step == 0 && fs::exists("drill_results.csv")) {
            end = now;
            press("p");
            step = 1;
        } else if (step == 1 && !workplace.read("opened").empty()) {
            press("v");
            step = 2;
        } else if (step == 2) {
            earliest = std::min(earliest, now);
            if (now < 0.5 * end) step = 3;
        } else if (step == 3) {
            press("Escape"); // closes the replay
            step = 4;
            looks = 0;
        } else if (step == 4 && now >= end && looks > 3) {
            press("Escape"); // ends the session
            step = 5;
            looks = 0;
        }
    };
    TrainerDef def{.name = "drill",
                   .cases = {"tooth"},
                   .difficulties = {"easy"},
                   .motions = {"expert"},
                   .pictures = {"drill.png"},
                   .window = {"Drill", 480, 360},
                   .openWindow = [&](const window::WindowDef& window) -> std::unique_ptr<window::Window> {
                       looks = 0;
                       return std::make_unique<window::Attended>(window, act);
                   }};
    const std::vector<const char*> words = {"drill", "--trainee", "Ada"};
    const int code = runTrainer(static_cast<int>(words.size()), words.data(), def, [&](const Training& training) {
        ++started;
        Simulation sim({.physics = {.gravity = {}}, .window = def.window, .look = {.mouse = false, .keys = false}});
        const BodyId box =
            sim.add(physics::RigidBodyDef{.name = "box", .mesh = geometry::shapes::box({0.1, 0.1, 0.1})});
        sim.show(box);
        sim.everyStep([&](double time) { sim.physics().setPose(box, {{0.1 * time, 0, 0}, {}}); });
        TrainerTaskDef task{
            .steps = {{.name = "push", .done = [](const frame::Frame& frame) { return frame.time > 1; }}},
            .observed = {.bodies = {{.body = box}}},
            .force = {.bodies = {box}},
            .results =
                [](const TaskProgress& progress) {
                    return std::vector<ResultLine>{{"Time", text(progress.time, " s")}};
                },
            .score = [](const TaskProgress&) { return 12.5; }};
        visual::VisualServer* server = nullptr;
        task.dress = [&](visual::VisualServer& its) {
            visual::addEndoscopeLook(its, {{-0.2, -0.2, -0.2}, {0.2, 0.2, 0.2}}, visual::Quality::Low);
            server = &its;
        };
        task.observed.session.task = "drill easy";
        TrainerTask run(sim, training, task);
        sim.show(visual::GuiDef{.name = "script",
                                .renderCallback = [&] { now = server->bodies().front()->worldPose().position.x; }});
        return run.run(0, [] { return std::string("pushed"); });
    });
    CHECK(code == 0);
    CHECK(started == 1);
    CHECK(step == 5);
    CHECK(end >= 0.1);
    CHECK(earliest < 0.05);
    const std::string page = (workplace.place / "drill_tooth_1_1.html").string();
    CHECK(workplace.read("opened") == page + "\n");
    const metric::Session reported = metric::readSession("drill_tooth_1_1.jsonl");
    CHECK_THAT(workplace.read("drill_tooth_1_1.html"), Catch::Contains("Ada"));
    CHECK(reported.complete);
    REQUIRE(reported.events.size() == 1);
    CHECK(reported.events[0].what == "push");
    CHECK(reported.tracks[0].samples.back().time < reported.events[0].time + 0.1); // nothing after the end
    CHECK_THAT(workplace.read("drill_results.csv"), Catch::Contains("\"Ada\",\"tooth\",\"easy\",1,yes,"));
    CHECK_THAT(workplace.read("drill_results.csv"), Catch::Contains(",12.5,\"drill_tooth_1_1.jsonl\""));
}

TEST_CASE("a picture of a case that is no picture, or too large, is refused before a window opens")
{
    Simulation sim;
    const auto start = [&](std::vector<std::string> cases, std::vector<std::string> pictures) {
        const StartScreen screen(sim, {.cases = std::move(cases), .pictures = std::move(pictures)});
    };
    CHECK_THROWS_WITH(start({"a"}, {"/nowhere/a.png"}), Catch::Contains("/nowhere/a.png"));
    CHECK_THROWS_WITH(start({"a", "b"}, {"a.png"}),
                      "start screen: pictures must have one entry for each of the 2 cases, got 1");
    const fs::path large = fs::temp_directory_path() / text("filasofia_large_", getpid(), ".png");
    visual::savePng({257, 2, std::vector<std::uint8_t>(4 * 257 * 2, 0)}, large);
    CHECK_THROWS_WITH(start({"a"}, {large.string()}), Catch::Contains("at most 256 pixels per side, got 257"));
    fs::remove(large);
}

} // namespace trainer_window_test
