#include "adding_fails.h"
#include "filasofia/filasofia.h"
#include "filasofia/runtime/stepped_run.h"
#include "filasofia/scene/scene_file.h"
#include "scene_folder.h"

#include <catch2/catch.hpp>

namespace knots_test {

using namespace filasofia;
using namespace filasofia::scene;
using Catch::Matchers::Contains;

namespace {

const std::string kTie = text(FILASOFIA_SOURCE_DIR, "/examples/scenes/tie.json");
const std::string kInstrumentTie = text(FILASOFIA_SOURCE_DIR, "/examples/scenes/instrument_tie.json");

/// A thread, and a knot of these fields.
std::string thread(const std::string& knot)
{
    return R"({
"bodies": [{"type": "RodBodyDef", "name": "silk", "points": ["-20 50 0 mm", "0 -4 0 mm", "20 50 0 mm"], "spacing": "1 mm",
            "collision": {}},
           {"type": "RodBodyDef", "name": "loose", "points": ["-20 50 0 mm", "20 50 0 mm"], "spacing": "2 mm",
            "collision": {"self": false}},
           {"type": "RigidBodyDef", "name": "bar"}],
"knots": [{)" +
           knot + "}]}";
}

} // namespace

TEST_CASE("scenes: a knot is saved as it is")
{
    const SceneFolder folder;
    const SceneDef scene = loadScene(kTie);
    REQUIRE(scene.knots.size() == 1);
    saveScene(scene, folder.file("again.json"));
    CHECK(loadScene(folder.file("again.json")).knots[0].release == scene.knots[0].release);
}

TEST_CASE("scenes: a knot around an instrument is saved as it is")
{
    const SceneFolder folder;
    const SceneDef scene = loadScene(kInstrumentTie);
    REQUIRE(scene.knots.size() == 1);
    saveScene(scene, folder.file("again.json"));
    const SceneDef again = loadScene(folder.file("again.json"));
    const auto& def = std::get<prefab::InstrumentTieDef>(scene.knots[0].def);
    const auto& read = std::get<prefab::InstrumentTieDef>(again.knots[0].def);
    CHECK(read.turns == def.turns);
    CHECK(read.nodes == def.nodes);
    CHECK(read.driver.kind == prefab::InstrumentKind::NeedleDriver);
    CHECK(read.driver.friction == def.driver.friction); // that of the tie's Def, not that of an instrument
}

TEST_CASE("scenes: a needle driver comes to tie a knot at its time, also after restoring")
{
    SceneDef scene = loadScene(kInstrumentTie);
    std::get<prefab::InstrumentTieDef>(scene.knots[0].def).turns = {1};
    Simulation sim(simulationDef(scene));
    const AddedScene added = addScene(sim, scene);
    CHECK(added.bodies.size() == 3); // hand and driver have no number
    runtime::SteppedRun run(sim);
    const auto held = [&] { return sim.physics().latest()->attachments.size(); };
    run.step();
    CHECK(held() == 1); // the thread's own
    const auto state = run.save();
    for (int i = 0; i < 100; ++i) run.step();
    CHECK(held() == 4); // by the hand, and by two fingers of an assistant
    REQUIRE(added.knots.size() == 1);
    CHECK(added.knots[0]().name == "instrument tie");
    CHECK(added.knots[0]().throws == 1);
    CHECK(added.knots[0]().tied == 0);
    const std::uint64_t hash = sim.physics().hash();
    run.restore(*state);
    for (int i = 0; i < 100; ++i) run.step();
    CHECK(sim.physics().hash() == hash);
}

TEST_CASE("scenes: hands tie a knot at its time, let go, and the knot holds, also after restoring", "[long]")
{
    const SceneDef scene = loadScene(kTie);
    Simulation sim(simulationDef(scene));
    const AddedScene added = addScene(sim, scene);
    CHECK(added.bodies.size() == 3); // the hands have no number
    runtime::SteppedRun run(sim);
    const auto to = [&](double time) {
        while (sim.physics().latest()->time < time) run.step();
    };
    run.step();
    to(1.0);
    const auto state = run.save();
    const auto held = [&] { return sim.physics().latest()->attachments.size(); };
    CHECK(held() > 3); // the thread's own, and those of hands and fingers
    for (int i = 0; i < 200; ++i) run.step();
    const std::uint64_t hash = sim.physics().hash();
    run.restore(*state);
    for (int i = 0; i < 200; ++i) run.step();
    CHECK(sim.physics().hash() == hash);
    to(7.0);
    CHECK(held() == 1);
    CHECK(added.knots[0]().tied == added.knots[0]().throws);
    CHECK(added.knots[0]().largestForce > 0.1);
    double tight = 0.0; // [N] on the left bar, which was drawn away
    for (const frame::Contact& each : sim.physics().latest()->contacts)
        if (each.first == added.bodies[0] || each.second == added.bodies[0])
            tight += std::abs(each.normal.x) * each.normalForce;
    CHECK(tight > 0.15);
    run.restore(*state); // the hands have let go since
    for (int i = 0; i < 200; ++i) run.step();
    CHECK(sim.physics().hash() == hash);
}

TEST_CASE("scenes: a wrong knot is an Error with its place")
{
    const SceneFolder folder;
    const auto problem = [&](const std::string& knot) { return addingFails(folder, thread(knot)); };
    CHECK(problem(R"("thread": "silk", "force": "1 N", "release": "5 s")") == "no error");
    CHECK_THAT(folder.errorOf(thread("")), Contains("thread"));
    CHECK_THAT(folder.errorOf(thread(R"("thread": "wool")")), Contains("knots[0].thread") && Contains("wool"));
    CHECK_THAT(folder.errorOf(thread(R"("thread": "silk", "force": "0 N")")),
               Contains("knots[0].force must be > 0 N, got"));
    CHECK_THAT(folder.errorOf(thread(R"("thread": "silk", "begun": 1)")), Contains("begun") && Contains("begin"));
    CHECK_THAT(problem(R"("thread": "bar")"), Contains("scene.json:7:11: knots[0]: knot 'knot': thread must be a rod"));
    CHECK_THAT(problem(R"("thread": "loose")"),
               Contains("knot 'knot': thread must collide with itself (collision.self), got rod 'loose'"));
    CHECK_THAT(problem(R"("thread": "silk", "begin": "2 s", "release": "2 s")"),
               Contains("knots[0]: release must be > begin = 2 s, got 2"));
    CHECK_THAT(problem(R"("thread": "silk", "nodes": [0, 9999])"), Contains("nodes must be in [0, "));
    const std::string tie = R"("type": "InstrumentTieDef", "thread": )";
    CHECK(problem(tie + R"("silk", "turns": [1])") == "no error");
    CHECK_THAT(problem(tie + R"("bar")"), Contains("knots[0]: instrument tie 'instrument tie': thread must be a rod"));
    CHECK_THAT(problem(tie + R"("silk", "driver": {"grasps": false})"), Contains("driver.grasps must be true"));
    CHECK_THAT(folder.errorOf(thread(tie + R"("silk", "loop": 1)")), Contains("loop"));
    CHECK_THAT(folder.errorOf(thread(R"("thread": "silk", "type": "Tie")")),
               Contains("KnotDef") && Contains("InstrumentTieDef"));
}

} // namespace knots_test
