#include "adding_fails.h"
#include "filasofia/filasofia.h"
#include "filasofia/scene/scene_file.h"
#include "scene_folder.h"

#include <catch2/catch.hpp>

namespace instrument_functions_test {

using namespace filasofia;
using namespace filasofia::scene;
using Catch::Matchers::Contains;

TEST_CASE("scenes: shears seal and part a band, and a tube sucks blood away, also after saving")
{
    const SceneFolder folder;
    const SceneDef scene = loadScene(text(FILASOFIA_SOURCE_DIR, "/examples/scenes/sealing.json"));
    saveScene(scene, folder.file("again.json"));
    std::vector<std::uint64_t> hashes;
    for (const SceneDef& each : {scene, loadScene(folder.file("again.json"))}) {
        Simulation sim(simulationDef(each));
        static_cast<void>(addScene(sim, each));
        const RunReport report = sim.run({.headless = true, .backend = visual::Backend::Null, .steps = 3600});
        CHECK(report.callbackProblems.empty());
        CHECK(report.cutArea() > 6e-6); // the band's cross-section is 8.4 mm^2
        CHECK(report.energy.at(0).balance.delivered > 5.0);
        CHECK(report.blood.at(0).balance.welled < 1e-9); // sealed
        CHECK(report.blood.at(1).balance.sucked > 5e-8);
        hashes.push_back(report.hash);
    }
    CHECK(hashes[0] == hashes[1]);
}

TEST_CASE("scenes: a wire loop shaves chips off while its pedal is pressed, also after saving")
{
    const SceneFolder folder;
    const SceneDef scene = loadScene(text(FILASOFIA_SOURCE_DIR, "/examples/scenes/loop.json"));
    saveScene(scene, folder.file("again.json"));
    std::vector<std::uint64_t> hashes;
    for (const SceneDef& each : {scene, loadScene(folder.file("again.json"))}) {
        Simulation sim(simulationDef(each));
        static_cast<void>(addScene(sim, each));
        double removed = 0.0; // [kg], at 1000 kg/m^3
        sim.on<CutEvent>([&](const CutEvent& cut) {
            for (const auto& chip : cut.rupture.detached) removed += chip.mass;
        });
        const RunReport report = sim.run({.headless = true, .backend = visual::Backend::Null, .steps = 950});
        CHECK(report.callbackProblems.empty());
        CHECK(removed > 150e-6);
        CHECK(removed < 260e-6); // 16.5 mm^2 below the surface, 14 mm long
        CHECK(report.energy.at(0).balance.delivered > 5.0);
        hashes.push_back(report.hash);
    }
    CHECK(hashes[0] == hashes[1]);
}

TEST_CASE("scenes: a key lets an instrument rinse while it is held")
{
    const SceneFolder folder;
    const SceneDef scene = folder.load(R"({"physics": {"rate": 500},
"bodies": [{"name": "tissue", "mesh": {"type": "block", "size": "40 12 30 mm", "cells": [8, 2, 6]},
 "attachments": [{"box": ["-1 -1 -1 m", "1 1 1 m"]}], "bleeding": {"flux": 1e-3}}],
"instruments": [{"name": "tube", "kind": "suctionIrrigator", "groups": [],
 "pose": {"position": "0 37 0 mm", "orientation": {"axis": [1, 0, 0], "angle": "-90 deg"}}, "suction": {"reach": "9 mm"}}],
"commands": [{"time": 0, "type": "Treat", "id": "tissue", "treatment": {"type": "Injure", "place": "0 6 0 mm", "radius": "8 mm"}}],
"pedals": [{"body": "tube", "rinse": true, "key": "3"}]})");
    Simulation sim(simulationDef(scene));
    static_cast<void>(addScene(sim, scene));
    sim.everyStep([&, step = 0](double) mutable {
        if (++step != 100 && step != 200) return;
        event::KeyEvent event;
        event.key = event::KeyCode::Digit3;
        event.pressed = step == 100;
        sim.post(event);
    });
    std::vector<double> rinsed;
    sim.everyStep([&](double) { rinsed.push_back(sim.blood(BodyId{1}).rinsed); });
    sim.run({.headless = true, .steps = 500});
    CHECK(rinsed[90] == 0.0);
    CHECK(rinsed[210] > 0.0);
    CHECK(rinsed[499] == rinsed[240]);
}

TEST_CASE("scenes: blood is sucked and rinsed where a body carries the opening")
{
    const SceneFolder folder;
    const auto sucked = [&](const std::string& pose) {
        const SceneDef scene = folder.load(R"({"physics": {"rate": 500},
"bodies": [{"name": "tissue", "mesh": {"type": "block", "size": "40 12 30 mm", "cells": [8, 2, 6]},
 "attachments": [{"box": ["-1 -1 -1 m", "1 1 1 m"]}], "bleeding": {"flux": 1e-3}},
 {"type": "RigidBodyDef", "name": "tube", "elements": [")" +
                                           pose +
                                           R"("]}],
"commands": [
 {"time": 0, "type": "Treat", "id": "tissue", "treatment": {"type": "Injure", "place": "0 6 0 mm", "radius": "8 mm"}},
 {"time": 0, "type": "Treat", "id": "tissue", "treatment": {"type": "Suck", "place": "0 0 0 mm", "radius": "5 mm", "rate": 1e-6, "body": "tube"}},
 {"time": 0.5, "type": "RemoveBody", "id": "tube"}]})");
        Simulation sim(simulationDef(scene));
        static_cast<void>(addScene(sim, scene));
        std::vector<double> each;
        sim.everyStep([&](double) { each.push_back(sim.blood(BodyId{1}).sucked); });
        sim.run({.headless = true, .steps = 500});
        CHECK(each[499] == each[300]); // it is gone
        return each[499];
    };
    CHECK(sucked("0 6 0 mm") > 1e-9);
    CHECK(sucked("60 6 0 mm") == 0.0);
}

TEST_CASE("scenes: what an instrument cannot do is refused with its place")
{
    const SceneFolder folder;
    const auto says = [&](const std::string& members, const std::string& rest = "") {
        return addingFails(folder, R"({"bodies": [{"name": "tissue", "mesh": {"type": "block", "size": "40 12 30 mm"},
 "bleeding": {}}], "instruments": [{"name": "tool", )" +
                                       members + "}]" + rest + "}");
    };
    CHECK_THAT(says(R"("kind": "grasper", "shears": {})"),
               Contains("shears need an instrument of kind ultrasonicShears"));
    CHECK_THAT(says(R"("type": "EndoscopeDef", "suction": {})"), Contains("suction needs an instrument with a shaft"));
    CHECK_THAT(says(R"("type": "WireLoopDef", "suction": {})"), Contains("suction needs an instrument with a shaft"));
    CHECK_THAT(says(R"("type": "WireLoopDef", "grip": [{"time": 0}])"), Contains("a loop has no jaws"));
    CHECK_THAT(says(R"("type": "WireLoopDef", "depth": "1 mm")"), Contains("depth must be >= width / 2"));
    CHECK_THAT(says(R"("kind": "ultrasonicShears", "shears": {"to": "1 mm"})"), Contains("to must be > from"));
    CHECK_THAT(says(R"("kind": "suctionIrrigator")", R"(, "pedals": [{"body": "tool", "rinse": true, "key": "3"}])"),
               Contains("pedals[0].body must be an instrument with suction, if it rinses"));
    CHECK_THAT(says(R"("kind": "suctionIrrigator", "suction": {"reach": "-1 mm"})"), Contains("reach must be > 0 m"));
    CHECK_THAT(says(R"("kind": "grasper")", R"(, "commands": [{"time": 0, "type": "Treat", "id": "tissue",
"treatment": {"type": "Suck", "place": "0 0 0 mm", "rate": 1, "body": "tissue"}}])"),
               Contains("blood of 'tissue': body must be a rigid one, got soft body 'tissue'"));
    CHECK_THAT(says(R"("kind": "grasper")", R"(, "commands": [{"time": 0, "type": "Treat", "id": "tissue",
"treatment": {"type": "Suck", "place": "0 0 0 mm", "rate": 1, "body": "tool", "element": 9}}])"),
               Contains("element must be in [0, 3), got 9"));
    CHECK_THAT(says(R"("kind": "grasper")", R"(, "commands": [{"time": 0, "type": "Treat", "id": "tissue",
"treatment": {"type": "Heat", "place": "0 0 0 mm"}}])"),
               Contains("does not burn"));
}

} // namespace instrument_functions_test
