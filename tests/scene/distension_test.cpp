#include "filasofia/filasofia.h"
#include "filasofia/scene/scene_file.h"
#include "scene_folder.h"

#include <catch2/catch.hpp>

namespace distension_test {

using namespace filasofia;
using namespace filasofia::scene;
using Catch::Matchers::Contains;

namespace {

std::string theatre(const std::string& distension, const std::string& commands)
{
    return R"({
"physics": {"rate": 500, "threads": 1},
"distension": )" +
           distension + R"(,
"bodies": [{"type": "RigidBodyDef", "name": "wall", "elements": ["0 30 0 mm"]}],
"commands": [)" +
           commands + "]}";
}

const std::string kFluid =
    R"({"room": {"low": "-20 -20 -20 mm", "high": "20 20 20 mm"}, "pressure": "75 mmHg", "outflow": 0.5})";
const std::string kClosed = R"({"time": "0.2 s", "type": "Distend", "outflow": 0})";

RunReport ran(const SceneDef& scene)
{
    Simulation sim(simulationDef(scene));
    static_cast<void>(addScene(sim, scene));
    return sim.run({.headless = true, .steps = 400});
}

} // namespace

TEST_CASE("scenes: a fluid distends a cavity, a command turns its tap, and both survive saving")
{
    const SceneFolder folder;
    saveScene(folder.load(theatre(kFluid, kClosed)), folder.file("again.json"));
    const SceneDef scene = loadScene(folder.file("again.json"));
    CHECK(scene.distension.value().pressure == Approx(75 * 133.322387415));
    const surface::DistensionBalance closed = ran(scene).distension.value(),
                                     open = ran(folder.load(theatre(kFluid, ""))).distension.value();
    CHECK(closed.outflow == 0.0);
    CHECK(open.outflow > 0.0);
    CHECK(closed.out > 0.0);
    CHECK(closed.out < 0.5 * open.out);
}

TEST_CASE("scenes: a wrong distension is told with its place")
{
    const SceneFolder folder;
    CHECK_THROWS_WITH(folder.load(theatre(R"({"pressure": 1})", "")), Contains("room"));
    const auto added = [&](const std::string& fluid, const std::string& commands) {
        const SceneDef scene = folder.load(theatre(fluid, commands));
        Simulation sim(simulationDef(scene));
        static_cast<void>(addScene(sim, scene));
    };
    CHECK_THROWS_WITH(added(R"({"room": {"low": "0 0 0 m", "high": "1 0 1 m"}})", ""),
                      Contains("distension") && Contains("room.high must be > room.low"));
    std::string dry = theatre(kFluid, kClosed);
    dry.erase(dry.find("\"distension\""), dry.find("\"bodies\"") - dry.find("\"distension\""));
    CHECK_THROWS_WITH(
        [&] {
            const SceneDef scene = folder.load(dry);
            Simulation sim(simulationDef(scene));
            static_cast<void>(addScene(sim, scene));
        }(),
        Contains("commands[0]") && Contains("there is none; addDistension() makes one"));
}

} // namespace distension_test
