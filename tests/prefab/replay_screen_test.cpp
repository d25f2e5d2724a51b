#include "filasofia/prefab/replay_screen.h"

#include "filasofia/geometry/shapes.h"
#include "filasofia/metric/session_file.h"
#include "filasofia/prefab/child_program.h"
#include "filasofia/prefab/expert_session.h"
#include "filasofia/prefab/session_report.h"
#include "filasofia/prefab/training_results.h"
#include "filasofia/window/null_window.h"

#include <catch2/catch.hpp>

#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

namespace replay_screen_test {

using namespace filasofia;
using namespace filasofia::prefab;
using metric::EventKind;
using runtime::Simulation;
namespace fs = std::filesystem;

namespace {

/// A folder of its own, which is the only one on PATH: no browser opens.
class Folder {
public:
    Folder() : path_(std::getenv("PATH"))
    {
        fs::remove_all(place);
        fs::create_directories(place);
        setenv("PATH", place.c_str(), 1);
    }
    ~Folder()
    {
        setenv("PATH", path_.c_str(), 1);
        fs::remove_all(place);
    }
    void script(const std::string& name, const std::string& words) const
    {
        std::ofstream(place / name) << "#!/bin/sh\n" << words;
        chmod((place / name).c_str(), 0755);
    }
    [[nodiscard]] std::string file(const std::string& name) const { return (place / name).string(); }
    [[nodiscard]] std::string read(const std::string& name) const
    {
        std::ifstream in(place / name);
        return {std::istreambuf_iterator<char>(in), {}};
    }

    const fs::path place = fs::temp_directory_path() / text("filasofia_replay_", getpid());

private:
    std::string path_;
};

template <class Poll> auto waited(Poll poll)
{
    auto got = poll();
    for (int i = 0; i < 3000 && !got; ++i, got = poll()) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    REQUIRE(got);
    return *got;
}

metric::Session withSteps(std::vector<std::pair<std::string, double>> steps)
{
    metric::Session session;
    for (const auto& [name, time] : steps)
        session.events.push_back({.time = time, .kind = EventKind::Step, .what = name});
    return session;
}

} // namespace

TEST_CASE("an expert is shown where the same step of the task was as far")
{
    const metric::Session own = withSteps({{"a", 10}, {"b", 40}}), expert = withSteps({{"a", 2}, {"b", 6}, {"c", 9}});
    CHECK(sameMoment(own, expert, 0) == 0.0);
    CHECK(sameMoment(own, expert, 5) == Approx(1));
    CHECK(sameMoment(own, expert, 10) == Approx(2));
    CHECK(sameMoment(own, expert, 25) == Approx(4));
    CHECK(sameMoment(own, expert, 43) == Approx(9)); // as fast as the expert
    CHECK(sameMoment(own, withSteps({}), 7) == Approx(7));
    CHECK(sameMoment(own, withSteps({{"b", 3}, {"a", 5}}), 20) == Approx(15)); // in another order: by the first alone
}

TEST_CASE("a replay goes from the beginning to the end, and keys pause it, go back by a second and close it")
{
    Simulation sim({.physics = {.gravity = {}},
                    .window = {.title = "T", .width = 720, .height = 480},
                    .look = {.mouse = false, .keys = false}});
    window::NullWindow* person = nullptr;
    sim.useWindow([&](const window::WindowDef& def) {
        auto opened = std::make_unique<window::NullWindow>(def);
        person = opened.get();
        return opened;
    });
    const BodyId box = sim.add(physics::RigidBodyDef{.mesh = geometry::shapes::box({0.01, 0.01, 0.01})});
    sim.show(box);
    sim.everyStep([&](double time) { sim.physics().setPose(box, {{time, 0, 0}, {}}); });
    visual::VisualServer* server = nullptr;
    ReplayScreen replay(sim, {.rate = 100});
    sim.dress([&](visual::VisualServer& its) {
        visual::addEndoscopeLook(its, {{-0.1, -0.1, -0.1}, {2, 0.1, 0.1}}, visual::Quality::Low);
        replay.dress(its);
        server = &its;
    });
    const auto key = [&](event::KeyCode code) {
        auto pressed = std::make_unique<event::KeyEvent>();
        pressed->key = code;
        pressed->pressed = true;
        person->inject(std::move(pressed));
    };
    metric::Session session = withSteps({{"a", 0.5}});
    session.tracks.push_back({.name = "tool"});
    for (int i = 0; i < 130; ++i)
        session.tracks[0].samples.push_back({.time = 0.01 * i, .pose = {{0.01 * i, 0, 0}, {}}});

    double first = -1.0, atEnd = 0.0, drawnAtEnd = 0.0, back = 0.0, afterClosing = 0.0;
    long lines = 0;
    bool closed = false;
    sim.show(visual::GuiDef{.name = "script", .renderCallback = [&, step = 0, pictures = 0, before = 0.0]() mutable {
                                const frame::FrameRef now = sim.physics().latest();
                                if (!now) return;
                                if (step == 0 && now->time > 1.3) {
                                    sim.pause(true);
                                    replay.setOwn(session);
                                    replay.setExpert(session);
                                    replay.open([&] { closed = true; });
                                    step = 1;
                                } else if (step == 1 && first < 0.0 && replay.shownAt() > 0.05) {
                                    first = replay.shownAt();
                                    lines = server->debug().counts().vertices;
                                } else if (step == 1 && first >= 0.0 && replay.shownAt() > 1.25 &&
                                           replay.shownAt() == before) {
                                    atEnd = before; // it stands at the end
                                    drawnAtEnd = server->bodies().front()->worldPose().position.x;
                                    key(event::KeyCode::Left);
                                    step = 2;
                                } else if (step == 2 && replay.shownAt() < before) {
                                    step = 3;
                                    pictures = 0;
                                } else if (step == 3 && ++pictures == 3) {
                                    back = server->bodies().front()->worldPose().position.x;
                                    key(event::KeyCode::Escape);
                                    step = 4;
                                } else if (step == 4 && closed && ++pictures == 8) {
                                    afterClosing = server->bodies().front()->worldPose().position.x;
                                    sim.finish("seen");
                                }
                                before = replay.shownAt();
                            }});
    sim.run({.backend = visual::Backend::Null, .seconds = 60});
    CHECK(first < 1.0); // it began at the beginning
    CHECK(lines > 0);   // the paths
    CHECK(drawnAtEnd == Approx(atEnd).margin(0.02));
    CHECK(back == Approx(atEnd - 1.0).margin(0.02));
    CHECK(closed);
    CHECK_FALSE(replay.isOpen());
    CHECK(afterClosing >= 1.3);
}

TEST_CASE("the program of the report is given session and page, its page is opened, and what goes wrong is said")
{
    const Folder folder;
    folder.script("filasofia", text("echo \"$@\" > ", folder.file("words"), "\necho page > \"$4\"\n"));
    SessionReport report;
    CHECK_FALSE(report.poll());
    CHECK(report.write(folder.file("my session.jsonl"), "filasofia") == "The report is being written");
    CHECK(report.writing());
    CHECK(waited([&] { return report.poll(); }) == text("Report: ", folder.file("my session.html")));
    CHECK(folder.read("words") ==
          text("report ", folder.file("my session.jsonl"), " --html ", folder.file("my session.html"), "\n"));
    CHECK(folder.read("my session.html") == "page\n");
    CHECK_FALSE(report.writing());

    folder.script("xdg-open", text("echo \"$1\" > ", folder.file("opened")));
    static_cast<void>(report.write(folder.file("a.jsonl"), "filasofia"));
    CHECK(waited([&] { return report.poll(); }) == text("Report: ", folder.file("a.html"), " (opened)"));
    const auto opened = [&]() -> std::optional<std::string> {
        const std::string page = folder.read("opened");
        return page.empty() ? std::nullopt : std::optional(page);
    };
    CHECK(waited(opened) == folder.file("a.html") + "\n");

    folder.script("filasofia", "echo first >&2\necho 'a.jsonl: line 3: damaged' >&2\nexit 2\n");
    static_cast<void>(report.write("a.jsonl", "filasofia"));
    CHECK(waited([&] { return report.poll(); }) == "No report: a.jsonl: line 3: damaged");
    folder.script("filasofia", "exit 3\n");
    static_cast<void>(report.write("a.jsonl", "filasofia"));
    CHECK(waited([&] { return report.poll(); }) == "No report: exit code 3");
    fs::remove(folder.place / "filasofia");
    CHECK_THAT(report.write("a.jsonl", "filasofia"),
               Catch::StartsWith("No report: the program 'filasofia' cannot be started: "));
    CHECK_FALSE(report.writing());
}

TEST_CASE("an expert's session is read if there is one, and what cannot be read or played is said")
{
    const Folder folder;
    metric::Session session = withSteps({{"a", 1}});
    session.steps = {"a"};
    fs::create_directories(folder.place / "experts");
    const std::string file = folder.file("experts/peg.jsonl");
    metric::writeSession(file, session);
    ExpertSession there;
    CHECK(there.find(file, {}).empty());
    const auto read = there.poll();
    REQUIRE(read);
    CHECK(read->events.size() == 1);
    CHECK_FALSE(there.poll()); // once

    std::ofstream(file) << "no session";
    ExpertSession damaged;
    CHECK_THAT(damaged.find(file, {}), Catch::StartsWith("No expert: ") && Catch::Contains("peg.jsonl"));

    // This program has no expert: it ends with an error, and leaves no file.
    ExpertSession none;
    const std::string other = folder.file("more/experts/ring.jsonl");
    CHECK(none.find(other, {"--no-such-option"}) == "The expert is at work, and will be shown");
    CHECK_THAT(waited([&] {
                   static_cast<void>(none.poll());
                   return none.news();
               }),
               Catch::StartsWith("No expert: "));
    CHECK(fs::is_empty(folder.place / "more/experts"));
}

TEST_CASE("a program that is still at work is ended with its object, unless it was left")
{
    const Folder folder;
    folder.script("slow", "/bin/sleep 1\necho done > \"$1\"\n");
    {
        ChildProgram killed("slow", {folder.file("killed")});
        CHECK_FALSE(killed.ended());
    }
    {
        ChildProgram left("slow", {folder.file("left")});
        left.leave();
    }
    waited([&] { return folder.read("left").empty() ? std::nullopt : std::optional(true); });
    CHECK_FALSE(fs::exists(folder.place / "killed")); // it began earlier
    CHECK_THROWS_WITH(ChildProgram("no_such_program", {}),
                      Catch::StartsWith("the program 'no_such_program' cannot be started: "));
}

TEST_CASE("results are kept in a table, and a trainee's own make a history")
{
    const Folder folder;
    const std::string file = folder.file("results.csv");
    CHECK(readResults(file).empty());
    const auto add = [&](const char* date, const std::string& trainee, const char* difficulty, bool done,
                         double seconds, std::optional<double> score) {
        appendResult(file, {date, trainee, "peg", difficulty, 7, done, seconds, score, "a, \"b\".jsonl"});
    };
    const std::string nasty = "=A1, \"x\"\ny"; // a formula, a comma, quotes and a line break
    add("2026-02-01", "Ada", "easy", true, 60, 240);
    add("2026-01-01", "Ada", "easy", true, 90, 210.4);
    add("2026-03-01", "Ada", "easy", false, 300, 0);
    add("2026-03-02", "Ada", "hard", true, 50, 250);
    add("2026-03-03", nasty, "easy", true, 70.26, {});
    add("2026-03-04", nasty, "easy", false, 300, {});
    std::ofstream(file, std::ios::app) << "nonsense\n1,2,3,4,x,yes,1,2,3\n\"\",\"\",\"\",\"\",1,yes,nan,,\"\"\n";
    const auto all = readResults(file);
    REQUIRE(all.size() == 6);
    CHECK(all[0].session == "a, \"b\".jsonl");
    CHECK(all[1].score == 210.4);
    CHECK_FALSE(all[4].score.has_value());

    const CaseHistory ada = historyOf(all, "Ada", "peg", "easy");
    CHECK(ada.scored);
    CHECK(ada.values == std::vector<double>{210.4, 240, 0}); // by date
    CHECK(ada.best == "240");
    CHECK(ada.last == "not done");
    const CaseHistory other = historyOf(all, nasty, "peg", "easy");
    CHECK_FALSE(other.scored);
    CHECK(other.values == std::vector<double>{70.26});
    CHECK(other.best == "70.3 s");
    CHECK(other.last == "not done");
    add("2026-03-05", "Bo", "easy", false, 300, 260);
    const CaseHistory broken = historyOf(readResults(file), "Bo", "peg", "easy");
    CHECK(broken.best.empty()); // it was broken off
    CHECK(broken.values == std::vector<double>{260});
    CHECK(historyOf(all, "Ada", "suturing", "easy").last.empty());
    CHECK_THROWS_WITH(appendResult(folder.file("none/results.csv"), {}), Catch::Contains("cannot be written"));
}

} // namespace replay_screen_test
