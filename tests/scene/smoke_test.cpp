#include "adding_fails.h"
#include "filasofia/filasofia.h"
#include "filasofia/scene/scene_file.h"
#include "scene_folder.h"

#include <catch2/catch.hpp>

namespace smoke_test {

using namespace filasofia;
using namespace filasofia::scene;
using Catch::Matchers::Contains;

namespace {

/// A block that is heated, in a room, and what follows.
std::string theatre(const std::string& smoke, const std::string& commands)
{
    return R"({
"physics": {"rate": 500, "threads": 1},
"smoke": )" +
           smoke + R"(,
"bodies": [
{"name": "tissue", "mesh": {"type": "block", "size": "40 12 30 mm", "cells": [16, 4, 12]},
 "attachments": [{"box": ["-1 -1 -1 m", "1 1 1 m"]}], "burning": {"depth": "0.5 mm"}},
{"type": "RigidBodyDef", "name": "tube", "elements": ["0 30 0 mm"]}],
"commands": [
{"time": 0, "type": "Treat", "id": "tissue", "treatment": {"type": "Heat", "place": "0 6 0 mm", "radius": "3 mm", "power": 60}})" +
           commands + "]}";
}

const std::string kRoom = R"({"room": {"low": "-60 -20 -60 mm", "high": "60 80 60 mm"}, "inflow": "3 l/min"})";
const std::string kOpened =
    R"(, {"time": "0.2 s", "type": "Extract", "place": "0 -10 0 mm", "body": "tube", "flow": "6 l/min"})";

RunReport ran(const SceneDef& scene)
{
    Simulation sim(simulationDef(scene));
    static_cast<void>(addScene(sim, scene));
    return sim.run({.headless = true, .steps = 400});
}

} // namespace

TEST_CASE("scenes: a pedal opens suction while its key is held")
{
    const SceneFolder folder;
    std::string file = theatre(kRoom, "");
    file.insert(file.size() - 1,
                R"(, "pedals": [{"key": "3", "extract": {"place": "0 -10 0 mm", "body": "tube", "flow": "6 l/min"}}])");
    saveScene(folder.load(file), folder.file("again.json"));
    const SceneDef scene = loadScene(folder.file("again.json"));
    const auto extracted = [&](bool pressed) { // between 0.2 and 0.4 s
        Simulation sim(simulationDef(scene));
        static_cast<void>(addScene(sim, scene));
        double atRelease = 0.0;
        sim.everyStep([&](double time) {
            const auto step = std::lround(time * 500);
            if (step == 210) atRelease = sim.smoke().smoke.extracted;
            if (!pressed || (step != 100 && step != 200)) return;
            event::KeyEvent event;
            event.key = event::KeyCode::Digit3;
            event.pressed = step == 100;
            sim.post(event);
        });
        const double all = sim.run({.headless = true, .steps = 400}).smoke.value().smoke.extracted;
        CHECK(all == atRelease); // nothing more once it is released
        return all;
    };
    CHECK(extracted(true) > 0.0);
    CHECK(extracted(false) == 0.0);
}

TEST_CASE("scenes: wrong pedals of suction are refused with their place")
{
    const SceneFolder folder;
    const auto pedal = [&](const std::string& smoke, const std::string& each) {
        std::string file = theatre(kRoom, "");
        if (smoke.empty()) file.erase(file.find("\"smoke\""), file.find("\"bodies\"") - file.find("\"smoke\""));
        file.insert(file.size() - 1, ", \"pedals\": [" + each + "]");
        return addingFails(folder, file);
    };
    CHECK_THAT(pedal("room", R"({"key": "3", "extract": {"place": "0 0 0 mm", "flow": 0}})"),
               Contains("pedals[0].extract.flow must be > 0 m^3/s, got 0"));
    CHECK_THAT(pedal("room", R"({"key": "3", "extract": {"place": "1 0 0 m", "flow": "6 l/min"}})"),
               Contains("pedals[0]: extract: place must be in the room of the smoke"));
    CHECK_THAT(pedal("room", R"({"extract": {"place": "0 0 0 mm", "flow": "6 l/min"}})"),
               Contains("pedals[0]: needs a key or a button"));
    CHECK_THAT(pedal("", R"({"key": "3", "extract": {"place": "0 0 0 mm", "flow": "6 l/min"}})"),
               Contains("pedals[0]: smoke: there is no room for it"));
    CHECK_THAT(pedal("room", R"({"key": "3"})"), Contains("pedals[0]: needs a body"));
}

TEST_CASE(
    "scenes: what burns smokes in the scene's room, a tube takes the smoke, and both survive saving and recording")
{
    const SceneFolder folder;
    const SceneDef scene = folder.load(theatre(kRoom, kOpened));
    CHECK(scene.smoke.value().inflow == Approx(5e-5));
    const surface::SmokeBalance all = ran(scene).smoke.value(),
                                none = ran(folder.load(theatre(kRoom, ""))).smoke.value();
    CHECK(all.smoke.emitted > 1e-8);
    CHECK(all.smoke.emitted == none.smoke.emitted);
    CHECK(all.smoke.extracted > 0.3 * all.smoke.emitted);
    CHECK(none.smoke.extracted == 0.0);
    CHECK(none.smoke.vented > 0.0);
    saveScene(scene, folder.file("again.json"));
    CHECK(ran(loadScene(folder.file("again.json"))).smoke.value() == all);

    Simulation sim(simulationDef(scene));
    static_cast<void>(addScene(sim, scene));
    sim.run({.headless = true, .steps = 200, .record = folder.file("run.rec")});
    const RecordedScene recorded = sceneOf(folder.file("run.rec"));
    CHECK(recorded.scene.smoke.value().room == scene.smoke->room);
    const auto opens = [](const TimedCommand& each) {
        const auto* extract = std::get_if<surface::Extract>(&each.command);
        return extract && extract->body == BodyId{2} && extract->flow == 1e-4 && std::abs(each.time - 0.2) < 0.003;
    };
    CHECK(std::ranges::count_if(recorded.scene.commands, opens) == 1);
}

TEST_CASE("scenes: wrong smoke is an Error with its place")
{
    const SceneFolder folder;
    const auto problem = [&](const std::string& smoke, const std::string& commands) {
        try {
            static_cast<void>(ran(folder.load(theatre(smoke, commands))));
            return std::string();
        } catch (const Error& error) {
            return std::string(error.what());
        }
    };
    CHECK_THAT(problem("{}", ""), Contains("smoke") && Contains("room"));
    CHECK_THAT(problem(R"({"room": {"low": "0 0 0 mm", "high": "1 0 1 mm"}})", ""),
               Contains(":3:10: smoke: room.high must be > room.low"));
    CHECK_THAT(problem(R"({"room": {"low": "0 0 0 mm", "high": "1 1 1 mm"}, "albedo": 2})", ""),
               Contains("albedo") && Contains("got 2"));
    CHECK_THAT(problem(kRoom, R"(, {"time": 1, "type": "Extract", "body": "tissue", "flow": "6 l/min"})"),
               Contains("needs a rigid body"));
    CHECK_THAT(problem(kRoom, R"(, {"time": 1, "type": "Extract", "place": "0 0 0 mm"})"), Contains("flow"));
}

TEST_CASE("scenes: an Extract that the run would refuse is refused before it")
{
    const SceneFolder folder;
    const auto problem = [&](const std::string& smoke, const std::string& command) {
        const SceneDef scene = folder.load(theatre(smoke, R"(, {"time": 1, "type": "Extract", )" + command + "}"));
        Simulation sim(simulationDef(scene));
        try {
            static_cast<void>(addScene(sim, scene));
            return std::string();
        } catch (const Error& error) {
            return std::string(error.what());
        }
    };
    CHECK_THAT(problem(kRoom, R"("body": "tube", "element": 1, "flow": "6 l/min")"),
               Contains(":9:") && Contains("extract: element must be in [0, 1), got 1"));
    CHECK_THAT(problem(kRoom, R"("place": "0 1 0 m", "flow": "6 l/min")"),
               Contains("extract: place must be in the room of the smoke"));
    SceneDef scene = folder.load(theatre(kRoom, kOpened));
    scene.smoke.reset();
    Simulation sim(simulationDef(scene));
    CHECK_THROWS_WITH(addScene(sim, scene), Contains("there is no room for it"));
}

} // namespace smoke_test
