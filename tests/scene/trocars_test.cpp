#include "filasofia/filasofia.h"
#include "filasofia/scene/scene_file.h"
#include "scene_folder.h"

#include <catch2/catch.hpp>

namespace trocars_test {

using namespace filasofia;
using namespace filasofia::scene;
using Catch::Matchers::Contains;

namespace {

/// Two instruments and a laparoscope over a table; `left` and `others` are members of the left one and of the scene.
std::string sceneWith(const std::string& left, const std::string& others = {})
{
    return R"({"physics": {"gravity": [0, 0, 0]}, "instruments": [
 {"type": "LaparoscopicInstrumentDef", "name": "left", "tool": {"kind": "dissector", "groups": []},
  "trocar": {"fulcrum": "-90 130 110 mm", "axis": [0.5, -0.6, -0.6]}, "start": {"insertion": "80 mm"})" +
           left + R"(},
 {"type": "LaparoscopicInstrumentDef", "name": "right", "tool": {"groups": []}, "trocar": {"fulcrum": "90 130 110 mm"}},
 {"type": "LaparoscopeDef", "name": "scope", "inclination": "45 deg", "trocar": {"fulcrum": "0 150 120 mm"}}])" +
           others + "}";
}

std::string failsWith(const SceneFolder& folder, const std::string& content)
{
    try {
        const SceneDef scene = folder.load(content);
        Simulation sim(simulationDef(scene));
        static_cast<void>(addScene(sim, scene));
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

void run(Simulation& sim, int steps) { sim.run({.headless = true, .backend = visual::Backend::Null, .steps = steps}); }

} // namespace

TEST_CASE("scenes: keys move an instrument in its trocar, its jaws follow the grip, and a saved scene does the same")
{
    const SceneFolder folder;
    const SceneDef scene =
        folder.load(sceneWith(R"(, "trocarKeys": [{"time": 0.2, "pose": {"yaw": "10 deg", "insertion": "100 mm"}}],
                     "grip": [{"time": 0.05, "opening": 0.5}])"));
    saveScene(scene, folder.file("again.json"));
    std::vector<std::uint64_t> hashes;
    for (const SceneDef& each : {scene, loadScene(folder.file("again.json"))}) {
        Simulation sim(simulationDef(each));
        const AddedScene added = addScene(sim, each);
        run(sim, 500);
        const frame::RigidBodyFrame* left = sim.physics().latest()->rigidBody(added.bodies[0]);
        const TrocarDef trocar{.fulcrum = {-90_mm, 130_mm, 110_mm}, .axis = {0.5, -0.6, -0.6}};
        const Pose expected = prefab::pivotOf(trocar, {.yaw = 10_deg, .insertion = 100_mm});
        CHECK(distance(left->poses[0].position, expected.position) < 1e-6);
        CHECK(left->joints[0].position == Approx(0.5 * 40_deg).epsilon(1e-3));
        hashes.push_back(sim.physics().hash());
    }
    CHECK(hashes[0] == hashes[1]);
}

TEST_CASE("scenes: the grasper of the example takes the flap and lifts it")
{
    const SceneDef scene = loadScene(text(FILASOFIA_SOURCE_DIR, "/examples/scenes/retraction.json"));
    Simulation sim(simulationDef(scene));
    const AddedScene added = addScene(sim, scene);
    run(sim, 2450);
    CHECK(added.task->progress().state == prefab::TaskProgress::State::Done);
}

TEST_CASE("scenes: a person moves what has no keys, and a haptic device the handle of what is haptic")
{
    const SceneFolder folder;
    const SceneDef scene = folder.load(sceneWith(""));
    Simulation sim(simulationDef(scene));
    const AddedScene added = addScene(sim, scene);
    event::MouseWheelEvent wheel;
    wheel.dy = 5.0;
    sim.post(wheel); // the right hand is chosen at first
    run(sim, 1000);
    const Vec3 right = sim.physics().latest()->rigidBody(added.bodies[1])->poses[0].position;
    CHECK(distance(right, {90_mm, 130_mm, 110_mm - 100_mm - 15_mm}) < 0.1_mm);

    const SceneDef held = folder.load(sceneWith(R"(, "hand": {"haptic": true})", R"(, "haptics": [{"body": "left"}])"));
    Simulation other(simulationDef(held));
    const AddedScene handle = addScene(other, held);
    CHECK(other.physics().def(BodyId{handle.bodies[0].value})); // the instrument; its handle is a body of its own
    run(other, 10);
    CHECK(other.physics().latest()->rigidBodies.size() == 4);
}

TEST_CASE("scenes: what is wrong with an instrument in a trocar is refused with its place")
{
    const SceneFolder folder;
    const auto left = [&](const std::string& more, const std::string& others = {}) {
        return failsWith(folder, sceneWith(more, others));
    };
    CHECK_THAT(left(R"(, "keys": [{"time": 1, "pose": [0, 0, 0]}])"),
               Contains("scene.json:3:") && Contains("instruments[0].keys must be empty"));
    CHECK_THAT(left(R"(, "trocarKeys": [{"time": 1, "pose": {"insertion": "300 mm"}}])"),
               Contains("instruments[0].trocarKeys[0].pose: insertion must be in [0, 0.25] m, got 0.3"));
    CHECK_THAT(left(R"(, "trocarKeys": [{"time": 1, "pose": {}}], "hand": {"haptic": true})"),
               Contains("a haptic device moves it"));
    CHECK_THAT(left("", R"(, "haptics": [{"body": "left"}])"),
               Contains("haptics[0]") && Contains("must be an instrument whose hand is haptic"));
    CHECK_THAT(failsWith(folder, R"({"instruments": [{"name": "s", "trocarKeys": [{"time": 1, "pose": {}}]}]})"),
               Contains("instruments[0].trocarKeys must be empty: it is in no trocar"));
    CHECK_THAT(left(R"(, "trocarKeys": [{"time": 1, "pose": {"yaw": "2 mm"}}])"), Contains("yaw"));
}

} // namespace trocars_test
