#include "filasofia/filasofia.h"
#include "filasofia/scene/scene_file.h"

#include <catch2/catch.hpp>

/// The scenes of asset:scenes/box_trainer.json.
namespace box_trainer_test {

using namespace filasofia;
using namespace filasofia::scene;

SceneDef example(const std::string& name)
{
    return loadScene(text(FILASOFIA_SOURCE_DIR, "/examples/scenes/", name, ".json"));
}

/// Runs a scene until its task is done, or for so many steps.
struct Run {
    Run(const std::string& name, int steps)
        : sim(simulationDef(example(name))), scene(addScene(sim, example(name))),
          report(sim.run({.headless = true, .backend = visual::Backend::Null, .steps = steps}))
    {
    }
    [[nodiscard]] FrameRef frame() { return sim.physics().latest(); }
    [[nodiscard]] bool done() const { return scene.task->progress().state == TaskProgress::State::Done; }

    Simulation sim;
    AddedScene scene;
    RunReport report;
};

TEST_CASE("scenes: the tasks of the box trainer begin, and all keys and commands are right")
{
    for (const char* name : {"peg_transfer", "pattern_cutting", "ligating_loop", "cannulation"}) {
        CAPTURE(name);
        Run run(name, 30);
        CHECK(run.report.undone == 0);
        CHECK(run.report.callbackProblems.empty());
        CHECK(run.frame()->step == 30);
        CHECK_FALSE(run.done());
    }
}

TEST_CASE("scenes: a hand of the box trainer takes a ring off its peg")
{
    Run run("peg_transfer", 2300);
    CHECK(run.scene.task->progress().doneAt.size() == 1);
    CHECK(run.frame()->rigidBody(run.scene.bodies[3])->poses[0].position.y > 20_mm);
}

TEST_CASE("scenes: hands put three rings onto pegs of the other side", "[long]")
{
    Run run("peg_transfer", 21600);
    CHECK(run.done());
    for (std::size_t ring : {3, 4, 5}) {
        const Vec3 place = run.frame()->rigidBody(run.scene.bodies[ring])->poses[0].position;
        CHECK(place.x == Approx(50_mm).margin(5.5_mm));
        CHECK(place.y < 18_mm); // the height of a peg
    }
}

TEST_CASE("scenes: scissors cut the circle out of the gauze", "[long]")
{
    Run run("pattern_cutting", 15300);
    CHECK(run.done());
    REQUIRE(run.report.opened.size() == 1);
    CHECK(run.report.opened[0].pieces == 1);
}

TEST_CASE("scenes: the loop holds the appendage narrow after the knot was let go", "[long]")
{
    Run run("ligating_loop", 13500);
    CHECK(run.done());
    const auto frame = run.frame();
    double pressed = 0.0; // [N], by the thread
    for (const auto& each : frame->contacts)
        if (std::minmax(each.first, each.second) == std::minmax(run.scene.bodies[1], run.scene.bodies[8]))
            pressed += each.normalForce;
    CHECK(pressed > 0.4);
}

TEST_CASE("scenes: the catheter is in the duct, and stays when it is let go", "[long]")
{
    Run run("cannulation", 10500);
    CHECK(run.done());
    const auto frame = run.frame();
    CHECK(std::ranges::none_of(frame->attachments,
                               [&](const auto& each) { return each.body == run.scene.bodies[4] && !each.broken; }));
    CHECK(run.report.opened.empty()); // the duct is whole
}

} // namespace box_trainer_test
