#include "adding_fails.h"
#include "filasofia/filasofia.h"
#include "filasofia/scene/scene_file.h"
#include "scene_folder.h"

#include <catch2/catch.hpp>

namespace clips_test {

using namespace filasofia;
using namespace filasofia::scene;

namespace {

/// A vessel with a duct, a clip, and what follows.
std::string theatre(const std::string& duct, const std::string& rest)
{
    return R"({
"physics": {"rate": 500, "threads": 1, "gravity": [0, 0, 0]},
"bodies": [
{"name": "vessel", "mesh": {"type": "vessel", "points": ["-10 0 0 mm", "-6 0 0 mm", "-3 0 0 mm", "-1 0 0 mm", "1 0 0 mm", "3 0 0 mm", "6 0 0 mm", "10 0 0 mm"],
 "radius": "1 mm", "wall": "0.7 mm", "cells": [8, 1]},
 "attachments": [{"box": ["-1 -1 -1 m", [-0.009, 1, 1]]}, {"box": [[0.009, -1, -1], "1 1 1 m"]}],
 "ducts": [)" +
           duct +
           R"(]},
{"type": "RigidBodyDef", "name": "clip", "elements": ["0 0 0 mm"], "mesh": {"type": "box", "size": "1 1 8 mm"}, "dynamic": true,
 "mass": {"type": "TotalMass", "value": "0.1 g"}}])" +
           rest + "}";
}

const std::string kDuct =
    R"({"name": "bile", "path": ["-10 0 0 mm", "10 0 0 mm"], "radius": "1 mm", "inletPressure": "1 kPa"})";

} // namespace

TEST_CASE("scenes: a command closes a clip, another opens it, and ducts survive saving")
{
    const SceneFolder folder;
    const SceneDef scene = folder.load(theatre(kDuct, R"(, "commands": [
{"time": "0.1 s", "type": "ApplyClip", "id": "first", "rigid": "clip", "target": "vessel", "def": {"closingTime": "0.1 s", "closingForce": "4 N"}},
{"time": "1 s", "type": "Release", "id": "first"}])"));
    saveScene(scene, folder.file("again.json"));
    for (const SceneDef& each : {scene, loadScene(folder.file("again.json"))}) {
        Simulation sim(simulationDef(each));
        const AddedScene added = addScene(sim, each);
        RunReport report = sim.run({.headless = true, .steps = 300});
        CHECK(report.clips.applied == 1);
        REQUIRE(report.ducts.size() == 1);
        CHECK(report.ducts[0].duct == "bile");
        CHECK(report.ducts[0].balance.state == DuctState::Clipped);
        CHECK(sim.duct(added.bodies[0]).clipsBefore == 1);
        report = sim.run({.headless = true, .steps = 700});
        CHECK(report.ducts[0].balance.state == DuctState::Open);
    }
}

TEST_CASE("scenes: an instrument closes the clips that it has")
{
    const SceneFolder folder;
    const SceneDef scene = folder.load(theatre(kDuct, R"(, "instruments": [{"name": "applier", "kind": "clipApplier",
"pose": "0 0 9 mm", "opening": 1, "groups": [], "clips": {"targets": ["vessel"], "clips": 2}, "grip": [{"time": "0.1 s"}]}])"));
    saveScene(scene, folder.file("again.json"));
    for (const SceneDef& each : {scene, loadScene(folder.file("again.json"))}) {
        Simulation sim(simulationDef(each));
        static_cast<void>(addScene(sim, each));
        CHECK(sim.run({.headless = true, .steps = 400}).clips.applied == 1);
        CHECK(sim.physics().latest()->clips.size() == 1);
    }
}

TEST_CASE("scenes: the cholecystectomy of the examples begins: all keys, clips and ducts are right")
{
    const SceneDef scene = loadScene(text(FILASOFIA_SOURCE_DIR, "/examples/scenes/cholecystectomy.json"));
    Simulation sim(simulationDef(scene));
    static_cast<void>(addScene(sim, scene));
    const RunReport report = sim.run({.headless = true, .steps = 30});
    CHECK(report.undone == 0);
    CHECK(report.callbackProblems.empty());
    REQUIRE(report.ducts.size() == 2);
    for (const auto& each : report.ducts) {
        CHECK(each.balance.state == DuctState::Open);
        CHECK(each.balance.flow > 0.0);
    }
}

TEST_CASE("scenes: after a reset an instrument has its clips again")
{
    const SceneFolder folder;
    const SceneDef scene = folder.load(theatre(kDuct, R"(, "instruments": [{"name": "applier", "kind": "clipApplier",
"pose": "0 0 9 mm", "opening": 1, "groups": [], "clips": {"targets": ["vessel"], "clips": 1},
"grip": [{"time": "0.1 s"}, {"time": "0.6 s", "opening": 1}, {"time": "0.9 s"}]}], "commands": [{"time": "0.5 s", "type": "Reset"}])"));
    Simulation sim(simulationDef(scene));
    static_cast<void>(addScene(sim, scene));
    const RunReport report = sim.run({.headless = true, .steps = 700});
    CHECK(report.callbackProblems.empty());
    CHECK(report.clips.applied == 2);
    CHECK(report.ducts[0].balance.clipsBefore == 1);
}

TEST_CASE("scenes: wrong clips and ducts are one line with their place")
{
    const SceneFolder folder;
    CHECK(addingFails(folder, theatre(R"({"name": "bile"})", "")).find("path") != std::string::npos);
    CHECK(addingFails(folder, theatre(R"({"path": ["-10 0 0 mm", "90 0 0 mm"]})", ""))
              .find("path must run through the body") != std::string::npos);
    CHECK(addingFails(
              folder,
              theatre(kDuct,
                      R"(, "commands": [{"time": 1, "type": "ApplyClip", "rigid": "vessel", "target": "vessel"}])"))
              .find("needs a rigid body, got soft body 'vessel'") != std::string::npos);
    CHECK(addingFails(
              folder,
              theatre(
                  kDuct,
                  R"(, "instruments": [{"type": "EndoscopeDef", "name": "scope", "clips": {"targets": ["vessel"]}}])"))
              .find("clips need an instrument of kind clipApplier") != std::string::npos);
    for (const char* kind : {"dissector", "laparoscopicGrasper"})
        CHECK(addingFails(folder, theatre(kDuct, text(R"(, "instruments": [{"name": "i", "kind": ")", kind,
                                                      R"(", "clips": {"targets": ["vessel"]}}])")))
                  .find("clips need an instrument of kind clipApplier") != std::string::npos);
}

} // namespace clips_test
