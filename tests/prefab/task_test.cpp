#include "filasofia/prefab/task.h"

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/core/text.h"
#include "filasofia/core/units.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/prefab/overlays.h"
#include "filasofia/prefab/screens.h"
#include "filasofia/window/null_window.h"

#include <catch2/catch.hpp>

namespace task_test {

using namespace filasofia;
using namespace filasofia::prefab;
using runtime::Simulation;

namespace {

void run(Simulation& sim, int steps) { sim.run({.headless = true, .backend = visual::Backend::Null, .steps = steps}); }

/// Draws some pictures that nobody sees.
void draw(Simulation& sim)
{
    int pictures = 0;
    sim.show(visual::GuiDef{.name = "count", .renderCallback = [&] {
                                if (++pictures == 6) sim.finish("drawn");
                            }});
    sim.run({.backend = visual::Backend::Null});
}

/// A step that is done at this time.
TaskStep after(double time, std::string name)
{
    return {.name = std::move(name),
            .instruction = text("wait until ", time, " s"),
            .done = [time](const frame::Frame& frame) { return frame.time >= time - 1e-9; },
            .target =
                [](const frame::Frame&) {
                    return Vec3{0, 0, 0.1};
                }};
}

/// A weight of 0.1 kg that lies on a table.
BodyId addWeight(Simulation& sim)
{
    sim.add(physics::RigidBodyDef{.name = "table",
                                  .elements = {{{0, -5_mm, 0}, {}}},
                                  .mesh = geometry::shapes::box({60_mm, 10_mm, 60_mm}),
                                  .collision = {{}}});
    return sim.add(physics::RigidBodyDef{.name = "weight",
                                         .elements = {{{0, 5.01_mm, 0}, {}}},
                                         .mesh = geometry::shapes::box({20_mm, 10_mm, 20_mm}),
                                         .dynamic = true,
                                         .mass = physics::TotalMass{0.1},
                                         .collision = {{}}});
}

} // namespace

TEST_CASE("the steps of a task are done in their order, each at its time, and it ends once")
{
    Simulation sim;
    std::vector<bool> over;
    // The second step's condition holds at once, but it waits for the first.
    Task task(sim, {.steps = {after(0.02, "first"), after(0.01, "second"), after(0.03, "third")},
                    .over = [&](bool done) { over.push_back(done); }});
    CHECK(task.instruction() == "wait until 0.02 s");
    run(sim, 10);
    CHECK(task.progress().step == 0);
    CHECK(task.progress().target == Vec3{0, 0, 0.1});
    run(sim, 40);
    const TaskProgress end = task.progress();
    CHECK(end.state == TaskProgress::State::Done);
    CHECK(end.step == 3);
    REQUIRE(end.doneAt.size() == 3);
    CHECK(end.doneAt[1] - end.doneAt[0] == Approx(1e-3).epsilon(1e-6)); // one step of the simulation apart
    CHECK(end.doneAt[2] - end.doneAt[0] == Approx(10e-3).epsilon(1e-6));
    CHECK(over == std::vector{true});
    CHECK(task.instruction().empty());
    task.restart();
    run(sim, 1);
    CHECK(task.progress().step < 3);
}

TEST_CASE("a task fails at its time limit, and a step that takes too long is a mistake in the session")
{
    Simulation sim;
    const BodyId probe = sim.add(physics::RigidBodyDef{.name = "probe"});
    MetricTracker tracker(sim, {.bodies = {{.body = probe}}, .keep = true});
    std::vector<bool> over;
    TaskStep slow = after(0.02, "slow");
    slow.timeLimit = 0.01;
    Task task(sim,
              {.steps = {slow, after(1.0, "never")}, .timeLimit = 0.05, .tracker = &tracker, .over = [&](bool done) {
                   over.push_back(done);
               }});
    run(sim, 100);
    tracker.close();
    CHECK(task.progress().state == TaskProgress::State::Failed);
    CHECK(over == std::vector{false});
    std::vector<metric::EventKind> kinds;
    for (const metric::Event& event : tracker.session().events) kinds.push_back(event.kind);
    using enum metric::EventKind;
    CHECK(kinds == std::vector{Mistake, Step, Unfinished});
    CHECK(metric::findUnfinished(tracker.session())->what ==
          "out of time after 0.05 s: 1 of 2 steps done, next 'never'");
}

TEST_CASE("a task that a run leaves before its end is unfinished in the session, and one that is done is not")
{
    for (const double last : {1.0, 0.03}) {
        Simulation sim;
        const BodyId probe = sim.add(physics::RigidBodyDef{.name = "probe"});
        MetricTracker tracker(sim, {.bodies = {{.body = probe}}, .keep = true});
        const Task task(sim, {.steps = {after(0.02, "first"), after(last, "last")}, .tracker = &tracker});
        run(sim, 50);
        CHECK(task.status() == (last == 1.0 ? "1 of 2 steps done, next 'last'" : "2 of 2 steps done"));
        task.leave();
        tracker.close();
        const metric::Event* event = metric::findUnfinished(tracker.session());
        REQUIRE((event != nullptr) == (last == 1.0));
        if (event) CHECK(event->what == "the run ended: 1 of 2 steps done, next 'last'");
    }
}

TEST_CASE("a wrong task Def is refused with its name and field")
{
    Simulation sim;
    CHECK_THROWS_WITH(Task(sim, {.name = "t"}), Catch::Contains("task 't': steps must have at least one entry"));
    CHECK_THROWS_WITH(Task(sim, {.name = "t", .steps = {{}}}), Catch::Contains("steps[0].done must be a function"));
    CHECK_THROWS_WITH(Task(sim, {.name = "t", .steps = {after(1, "a")}, .timeLimit = 0.0}),
                      Catch::Contains("timeLimit must be > 0"));
}

TEST_CASE("typed text is shown as one line, cut between characters")
{
    CHECK(shown("plain") == "plain");
    CHECK(shown("two\nlines") == "two lines");
    CHECK(shown(std::string(10'000, 'x')).size() == 80 + 3);
    CHECK(shown("\u00e4\u00e4\u00e4", 3) == "\u00e4\u2026"); // the second character would end beyond the limit
    CHECK(shown("\u00e4\u00e4\u00e4", 0) == "\u2026");
}

TEST_CASE("a force bar shows the weight of what lies on a body, and counts warnings")
{
    Simulation sim;
    const BodyId weight = addWeight(sim);
    ForceBar bar(sim, {.bodies = {weight}, .warning = 0.5, .full = 2.0});
    run(sim, 600);
    CHECK(bar.force() == Approx(0.981).epsilon(0.02));
    CHECK(bar.highest() >= bar.force());
    CHECK(bar.warnings() == 1);
    // 0.43 N is below the threshold but above 80 % of it: no new warning.
    sim.physics().setWrench(weight, {0, 0.55, 0}, {});
    run(sim, 300);
    CHECK(bar.force() == Approx(0.431).epsilon(0.03));
    sim.physics().setWrench(weight, {}, {});
    run(sim, 300);
    CHECK(bar.warnings() == 1);
    sim.physics().setWrench(weight, {0, 0.7, 0}, {});
    run(sim, 300);
    sim.physics().setWrench(weight, {}, {});
    run(sim, 300);
    CHECK(bar.warnings() == 2);
    CHECK_THROWS_WITH(ForceBar(sim, {}), Catch::Contains("force bar: bodies must have at least one entry"));
    CHECK_THROWS_WITH(ForceBar(sim, {.bodies = {weight}, .warning = 3.0}), Catch::Contains("full must be > warning"));
}

TEST_CASE("a panel of fluid needs a fluid")
{
    Simulation sim;
    CHECK_THROWS_WITH(FluidPanel(sim), Catch::Contains("distension: there is none"));
    sim.addDistension({.room = geometry::Box{{-1, -1, -1}, {1, 1, 1}}});
    CHECK_NOTHROW(FluidPanel(sim));
}

TEST_CASE("guidance, bar and screens draw names of any length and content without an error")
{
    Simulation sim;
    std::string nasty(10'000, 'n');
    nasty += "##%s\n<b>\xff\xfe";
    const BodyId weight = addWeight(sim);
    TaskStep step = after(1.0, nasty);
    step.instruction = nasty;
    const Task task(sim, {.name = nasty, .steps = {step}});
    Guidance guidance(sim, task);
    sim.dress([&](visual::VisualServer& server) {
        visual::addEndoscopeLook(server, {{-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1}}, visual::Quality::Low);
        guidance.dress(server);
    });
    const ForceBar bar(sim, {.name = nasty, .bodies = {weight}});
    EndScreen end(sim);
    end.show(nasty, {{nasty, nasty}, {nasty, nasty}}, nasty);
    std::vector<std::string> lines;
    setLogSink([&](LogLevel, std::string_view line) { lines.emplace_back(line); });
    draw(sim);
    setLogSink({});
    CHECK(lines.empty());
}

TEST_CASE("a start screen holds the simulation until Start is pressed, and an end screen waits for its button")
{
    Simulation sim({.window = {.title = "T", .width = 720, .height = 480}});
    window::NullWindow* person = nullptr;
    sim.useWindow([&](const window::WindowDef& def) {
        auto opened = std::make_unique<window::NullWindow>(def);
        person = opened.get();
        return opened;
    });
    const auto click = [&](double x, double y) {
        auto move = std::make_unique<event::MouseMoveEvent>();
        move->x = x;
        move->y = y;
        person->inject(std::move(move));
        for (const bool pressed : {true, false}) {
            auto button = std::make_unique<event::MouseButtonEvent>();
            button->pressed = pressed;
            button->x = x;
            button->y = y;
            person->inject(std::move(button));
        }
    };
    const std::string longName(10'000, 'x');
    std::vector<StartChoice> chosen;
    const StartScreen start(sim, {.title = "T",
                                  .cases = {"a", "b"},
                                  .difficulties = {"easy", "hard"},
                                  .choice = {.trainee = longName, .caseIndex = 7, .difficulty = 0, .seed = 5},
                                  .start = [&](const StartChoice& choice) { chosen.push_back(choice); }});
    EndScreen end(sim);
    end.onClose([&] { sim.finish("closed"); });
    double pausedAt = -1.0;
    sim.show(visual::GuiDef{.name = "script", .renderCallback = [&, pictures = 0]() mutable {
                                ++pictures;
                                if (pictures == 8) {
                                    pausedAt = sim.physics().latest()->time;
                                    for (double x = 460; x <= 620; x += 20) // the Start button, right of the choices
                                        for (double y = 190; y <= 250; y += 20) click(x, y);
                                }
                                if (pictures == 20)
                                    end.show("Done", {{"a", "1"}, {"b", "2"}, {"c", "3"}}, "file.jsonl");
                                if (pictures > 30 && pictures % 10 == 0)
                                    for (double x = 280; x <= 360; x += 20) click(x, 295); // the Close button, anywhere
                            }});
    const auto report = sim.run({.backend = visual::Backend::Null, .seconds = 60});
    CHECK(report.finished == "closed");
    CHECK(pausedAt == 0.0);
    CHECK(report.time > 0.0);
    REQUIRE(chosen.size() == 1);
    CHECK(chosen[0].trainee == longName); // longer than its field and not edited, so it is complete
    CHECK(chosen[0].caseIndex == 1);      // the last case
    CHECK(chosen[0].seed == 5);
}

} // namespace task_test
