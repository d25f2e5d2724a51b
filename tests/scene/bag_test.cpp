#include "adding_fails.h"
#include "filasofia/filasofia.h"
#include "filasofia/scene/scene_file.h"
#include "scene_folder.h"

#include <catch2/catch.hpp>

namespace bag_test {

using namespace filasofia;
using namespace filasofia::scene;

TEST_CASE("scenes: a bag catches a ball, closes and is drawn back with it, also after saving")
{
    const SceneFolder folder;
    const SceneDef scene = loadScene(text(FILASOFIA_SOURCE_DIR, "/examples/scenes/bag.json"));
    saveScene(scene, folder.file("again.json"));
    std::vector<std::uint64_t> hashes;
    for (const SceneDef& each : {scene, loadScene(folder.file("again.json"))}) {
        Simulation sim(simulationDef(each));
        const AddedScene added = addScene(sim, each);
        const RunReport report = sim.run({.headless = true, .backend = visual::Backend::Null, .steps = 1600});
        CHECK(report.callbackProblems.empty());
        CHECK(report.intersecting == 0);
        hashes.push_back(report.hash);
        const auto frame = sim.physics().latest();
        const Vec3 ball = frame->rigidBody(added.bodies[0])->poses[0].position;
        CHECK(ball.y > -85_mm);
        CHECK(ball.z > 0.0); // 60 mm nearer than where it fell
    }
    CHECK(hashes[0] == hashes[1]);
}

TEST_CASE("scenes: a bag needs arms that are open")
{
    const SceneFolder folder;
    const auto says = [&](const std::string& members) {
        return addingFails(folder, R"({"instruments": [{"name": "holder", "bag": {}, )" + members + "}]}");
    };
    CHECK_THAT(says(R"("kind": "grasper")"), Catch::Contains("bag needs an instrument of kind specimenBag"));
    CHECK_THAT(says(R"("kind": "specimenBag")"), Catch::Contains("the tool must be open at the start"));
}

} // namespace bag_test
