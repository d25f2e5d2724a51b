#include "filasofia/filasofia.h"
#include "scene_folder.h"

#include <catch2/catch.hpp>

namespace sensors_test {

using namespace filasofia;
using namespace filasofia::scene;

namespace {

using Catch::Matchers::Contains;

const std::string kScene = R"({
  "physics": {"rate": "500 Hz"},
  "bodies": [
    {"type": "RigidBodyDef", "name": "floor", "elements": ["0 -50 0 mm"],
     "mesh": {"type": "box", "size": "1 0.1 1"}, "collision": [{}]},
    {"type": "RigidBodyDef", "name": "ball", "elements": ["0 20.5 0 mm"], "dynamic": true,
     "mass": {"type": "TotalMass", "value": "200 g"}, "mesh": {"type": "sphere", "radius": "20 mm"}, "collision": [{}]}
  ],
  "sensorRate": "100 Hz",
  "sensors": [
    {"name": "ball", "body": "ball"},
    {"name": "weight", "type": "ContactForceSensor", "body": "ball", "with": "floor"}
  ]
})";

/// What a scene's sensors read after some steps.
std::vector<SensorReading> readAfter(SceneDef scene, std::vector<SensorDef> sensors, int steps)
{
    scene.sensors = std::move(sensors);
    Simulation sim(simulationDef(scene));
    const AddedScene added = addScene(sim, scene);
    static_cast<void>(sim.run({.headless = true, .steps = steps}));
    return added.sensors->read();
}

SceneDef example(const std::string& name)
{
    return loadScene(text(FILASOFIA_SOURCE_DIR, "/examples/scenes/", name, ".json"));
}

/// The number in the scene, from 1.
BodyId numberOf(const SceneDef& scene, const std::string& name)
{
    for (std::size_t i = 0; i < scene.bodies.size(); ++i)
        if (std::visit([](const auto& def) { return def.name; }, scene.bodies[i].def) == name)
            return BodyId{static_cast<std::uint32_t>(i + 1)};
    FAIL("no body " << name);
    return {};
}

} // namespace

TEST_CASE("scenes: sensors are read, written and saved", "[sensors]")
{
    const SceneFolder folder;
    const SceneDef scene = folder.load(kScene);
    const std::string file = folder.file("ball.csv");
    {
        Simulation sim(simulationDef(scene));
        const AddedScene added = addScene(sim, scene, {}, file);
        static_cast<void>(sim.run({.headless = true, .steps = 500}));
        const std::vector<SensorReading> now = added.sensors->read();
        CHECK(now[0].name == "ball");
        CHECK(now[0].values[1] == Approx(0.02).margin(1e-3));
        CHECK(now[1].values[1] == Approx(0.2 * 9.81).epsilon(1e-3));
    }
    std::ifstream in(file);
    std::string line;
    std::getline(in, line);
    CHECK(line == "time [s],\"ball x [m]\",\"ball y [m]\",\"ball z [m]\",\"weight x [N]\",\"weight y [N]\",\"weight z "
                  "[N]\",\"weight normal [N]\"");
    int lines = 0;
    while (std::getline(in, line)) ++lines;
    CHECK(lines == 101); // the first state, and 100 in a second

    saveScene(scene, folder.file("saved.json"));
    const SceneDef again = loadScene(folder.file("saved.json"));
    REQUIRE(again.sensors.size() == 2);
    CHECK(again.sensorRate == 100.0);
    CHECK(std::get<ContactForceSensor>(again.sensors[1].kind).with == BodyId{1});
}

TEST_CASE("scenes: a wrong sensor is refused where it stands", "[sensors]")
{
    const SceneFolder folder;
    const auto added = [&](std::string_view from, std::string_view to) {
        std::string text = kScene;
        text.replace(text.find(from), from.size(), to);
        const SceneDef scene = folder.load(text);
        Simulation sim(simulationDef(scene));
        static_cast<void>(addScene(sim, scene));
    };
    CHECK_THROWS_WITH(added(R"("body": "ball"})", R"("body": "ball", "node": 3})"),
                      Contains("scene.json:11:") && Contains(": sensors[0].node must not be given for a rigid body"));
    CHECK_THROWS_WITH(added(R"("weight", "type")", R"("ball", "type")"),
                      Contains("scene.json:12:14: sensors[1].name must differ from those before it, got 'ball'"));
    std::string none = kScene;
    none.replace(none.find(R"("with": "floor")"), 15, R"("with": "flour")");
    CHECK_THAT(folder.errorOf(none), Contains("scene.json:12:") && Contains("flour"));
    none = kScene;
    none.replace(none.find(R"(, "body": "ball"})"), 16, "");
    CHECK_THAT(folder.errorOf(none),
               Contains("scene.json:11:5: sensors[0] must have the member 'body' (PositionSensor)"));
    none = kScene;
    none.replace(none.find("100 Hz"), 6, "0 Hz");
    CHECK_THAT(folder.errorOf(none), Contains("scene.json:9:17: sensorRate must be in [0.001, 100000]"));
    Simulation sim;
    CHECK_THROWS_WITH(addScene(sim, SceneDef{}, {}, folder.file("a.csv")),
                      "sensors: there must be a sensor: without one there is nothing to write");
}

TEST_CASE("scenes: sensors read cavities and fluids", "[sensors]")
{
    const SceneDef bladder = example("bladder");
    const auto cavity = readAfter(bladder, {{"urine", CavitySensor{numberOf(bladder, "bladder")}}}, 300);
    CHECK(cavity[0].columns ==
          std::vector<std::string>{"volume [m^3]", "pressure [Pa]", "outflow [m^3/s]", "lost [m^3]"});
    CHECK(cavity[0].values[0] > 1e-6);
    CHECK(cavity[0].values[1] > 0.0);

    const SceneFolder folder;
    const SceneDef scene = folder.load(R"({
      "distension": {"room": {"low": "-20 -20 -20 mm", "high": "20 20 20 mm"}, "pressure": "75 mmHg", "outflow": 0.5},
      "bodies": [{"type": "RigidBodyDef", "name": "wall", "elements": ["0 30 0 mm"]}],
      "sensors": [{"name": "fluid", "type": "FluidSensor"}]
    })");
    const auto fluid = readAfter(scene, scene.sensors, 400);
    CHECK(fluid[0].values[0] > 1e3);
    CHECK(fluid[0].values[1] > 1e-6);
}

TEST_CASE("scenes: a duct's sensor reads its flow", "[sensors]")
{
    std::string points;
    for (int x = -15; x <= 15; ++x) points += text(points.empty() ? "" : ", ", "\"", x, " 0 0 mm\"");
    const SceneFolder folder;
    const SceneDef scene = folder.load(R"({
      "physics": {"gravity": "0 0 0"},
      "bodies": [{
        "name": "artery",
        "mesh": {"type": "vessel", "points": [)" +
                                       points + R"(], "radius": "1 mm", "wall": "0.8 mm", "cells": [8, 1]},
        "ducts": [{"path": ["-15 0 0 mm", "15 0 0 mm"], "viscosity": 3.5e-3, "inletPressure": "12 kPa"}]
      }],
      "sensors": [{"name": "flow", "type": "DuctSensor", "body": "artery"}]
    })");
    const auto flow = readAfter(scene, scene.sensors, 100);
    // Poiseuille's law.
    const double expected = std::numbers::pi * std::pow(1e-3, 4) * 12e3 / (8.0 * 3.5e-3 * 30e-3);
    CHECK(flow[0].values[0] == Approx(expected).epsilon(0.1));
    CHECK(flow[0].values[1] == 0.0);
    CHECK(flow[0].values[3] == Approx(1.0).epsilon(0.1));
}

} // namespace sensors_test
