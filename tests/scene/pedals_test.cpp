#include "adding_fails.h"
#include "filasofia/filasofia.h"
#include "filasofia/scene/scene_file.h"
#include "scene_folder.h"

#include <catch2/catch.hpp>

namespace pedals_test {

using namespace filasofia;
using namespace filasofia::scene;
using Catch::Matchers::Contains;

namespace {

/// A block, a hook that touches it, and what follows.
std::string theatre(const std::string& electrodes, const std::string& rest)
{
    return R"({
"physics": {"rate": 500, "threads": 1},
"bodies": [
{"name": "tissue", "mesh": {"type": "block", "size": "40 12 30 mm", "cells": [8, 2, 6]},
 "attachments": [{"box": ["-1 -1 -1 m", "1 1 1 m"]}], "burning": {"rate": 50}},
{"type": "RigidBodyDef", "name": "jaw", "elements": ["0 6 5 mm"]},
{"type": "RigidBodyDef", "name": "stick", "elements": ["0 6 0 mm"], "electrodes": [)" +
           electrodes + "]}]" + rest + "}";
}

const std::string kWeak = R"({"mode": "coagulate", "power": "2 W", "radius": "3 mm"})";

void post(Simulation& sim, event::KeyCode key, bool pressed)
{
    event::KeyEvent event;
    event.key = key;
    event.pressed = pressed;
    sim.post(event);
}

} // namespace

TEST_CASE("scenes: commands press pedals, and the electrodes of a file survive saving")
{
    const SceneFolder folder;
    const SceneDef scene = folder.load(theatre(kWeak + R"(,
{"mode": "bipolar", "power": "4 W", "tip": {"from": "-1 0 0 mm", "to": "1 0 0 mm"}, "other": {"body": "jaw"}})",
                                               R"(, "commands": [
{"time": "0.1 s", "type": "Activate", "id": "stick"},
{"time": "0.5 s", "type": "Activate", "id": "stick", "on": false},
{"time": "0.6 s", "type": "Activate", "id": "stick", "electrode": 1}])"));
    saveScene(scene, folder.file("again.json"));
    std::vector<EnergyBalance> seen;
    for (const SceneDef& each : {scene, loadScene(folder.file("again.json"))}) {
        Simulation sim(simulationDef(each));
        static_cast<void>(addScene(sim, each));
        const RunReport report = sim.run({.headless = true, .steps = 500});
        REQUIRE(report.energy.size() == 2);
        CHECK(report.energy[0].balance.active == Approx(0.4));
        CHECK(report.energy[0].balance.delivered == Approx(0.8).epsilon(1e-9));
        CHECK(report.energy[1].balance.active == Approx(0.4).margin(0.0021));
        CHECK(report.energy[1].balance.inAir == 0.0); // the tip is on the tissue, and so is the jaw
        CHECK(report.energy[1].balance.delivered > 1.4);
        seen.push_back(report.energy[1].balance);
    }
    CHECK(seen[0] == seen[1]);
}

TEST_CASE("scenes: a key is a pedal while it is held, and is released with the window's focus")
{
    const SceneFolder folder;
    saveScene(folder.load(theatre(kWeak, R"(, "pedals": [{"body": "stick", "key": "1"}])")), folder.file("again.json"));
    const SceneDef scene = loadScene(folder.file("again.json"));
    Simulation sim(simulationDef(scene));
    const AddedScene added = addScene(sim, scene);
    sim.everyStep([&](double time) {
        const auto step = std::lround(time * 500);
        if (step == 10) post(sim, event::KeyCode::Digit1, true);
        if (step == 60) post(sim, event::KeyCode::Digit2, false);
        if (step == 110) post(sim, event::KeyCode::Digit1, false);
        if (step == 210) post(sim, event::KeyCode::Digit1, true);
        if (step != 260) return;
        event::WindowEvent away;
        away.kind = event::WindowEvent::Kind::FocusLost;
        sim.post(away);
    });
    const EnergyBalance energy = sim.run({.headless = true, .steps = 500}).energy.at(0).balance;
    CHECK(energy.active == Approx(0.3).margin(1e-9));
    CHECK(energy.delivered == Approx(0.6).epsilon(1e-9));
}

TEST_CASE("scenes: a button of the device that holds a body is a pedal")
{
    const SceneFolder folder;
    const SceneDef scene = folder.load(theatre(kWeak, R"(, "haptics": [{"body": "stick"}],
"pedals": [{"body": "stick", "button": 1}])"));
    Simulation sim(simulationDef(scene));
    const AddedScene added = addScene(sim, scene);
    sim.everyStep([&](double time) {
        const auto step = std::lround(time * 500);
        if (step != 10 && step != 60 && step != 110) return;
        DeviceEvent event;
        event.interface = HapticId{1};
        event.notice = {
            .kind = device::DeviceNotice::Kind::Button, .button = step == 60 ? 0 : 1, .pressed = step == 10};
        sim.post(event);
    });
    CHECK(sim.run({.headless = true, .steps = 200}).energy.at(0).balance.active == Approx(0.2).margin(1e-9));
}

TEST_CASE("scenes: the hook of the example cuts a layer, burns it, and hurts the bed a little")
{
    const SceneDef scene = loadScene(text(FILASOFIA_SOURCE_DIR, "/examples/scenes/hook.json"));
    Simulation sim(simulationDef(scene));
    static_cast<void>(addScene(sim, scene));
    const RunReport report = sim.run({.headless = true, .backend = visual::Backend::Null, .steps = 1000});
    CHECK(report.cutArea() > 10e-6);
    CHECK(report.heat.at(0).balance.burnt > 10e-6);
    CHECK(report.energy.at(0).balance.delivered > 5.0);
    CHECK(report.energy.at(1).balance.active == 0.0);
    CHECK(report.smoke.value().smoke.emitted > 1e-7); // 0.1 mg
}

TEST_CASE("scenes: the jaws of an instrument seal what they hold, and its first button stays the jaws'")
{
    const SceneFolder folder;
    const std::string forceps = R"(, "instruments": [{"name": "forceps", "pose": "0 8 0 mm", "electrodes": [
{"mode": "bipolar", "power": "5 W", "radius": "3 mm", "limit": 373.15, "tip": {"element": 1, "to": "0 0 -3 mm"},
 "other": {"element": 2, "to": "0 0 -3 mm"}}]}])";
    const SceneDef scene = folder.load(theatre(kWeak, forceps + R"(, "commands": [
{"time": "0.1 s", "type": "Activate", "id": "forceps"}])"));
    Simulation sim(simulationDef(scene));
    const AddedScene added = addScene(sim, scene);
    const RunReport report = sim.run({.headless = true, .steps = 300});
    REQUIRE(report.energy.size() == 2);
    CHECK(report.energy[1].body == "forceps");
    CHECK(report.energy[1].mode == EnergyMode::Bipolar);
    CHECK(report.energy[1].balance.inAir == 0.0);
    CHECK(report.energy[1].balance.delivered == Approx(2.5).epsilon(0.05));
    CHECK_THAT(addingFails(folder, theatre(kWeak, forceps + R"(, "haptics": [{"body": "forceps"}],
"pedals": [{"body": "forceps", "button": 0}])")),
               Contains("pedals[0].button must not be 0: it closes the jaws"));
    CHECK(addingFails(folder, theatre(kWeak, forceps + R"(, "haptics": [{"body": "forceps"}],
"pedals": [{"body": "forceps", "button": 1}])")) == "no error");
}

TEST_CASE("scenes: wrong electrodes and pedals are refused with their place")
{
    const SceneFolder folder;
    const auto electrode = [&](const std::string& each) { return addingFails(folder, theatre(each, "")); };
    const auto pedal = [&](const std::string& each) {
        return addingFails(folder, theatre(kWeak, R"(, "pedals": [)" + each + "]"));
    };
    CHECK_THAT(electrode(R"({"mode": "burn"})"), Contains("bodies[2].electrodes[0].mode must be"));
    CHECK_THAT(electrode(R"({"power": "-1 W"})"),
               Contains("bodies[2].electrodes[0].power must be in (0, 1000000] W, got \"-1 W\""));
    CHECK_THAT(electrode(R"({"mode": "cut"})"), Contains("scene.json:7:1: electrode of rigid body 'stick': mode cut "
                                                         "needs a blade"));
    CHECK_THAT(electrode(R"({"mode": "bipolar", "other": {"body": "tissue"}})"),
               Contains("other.body: needs a rigid body, got soft body 'tissue'"));
    CHECK_THAT(electrode(R"({"mode": "bipolar", "other": {"body": "stick"}})"),
               Contains("must be the name of a body before this one"));
    CHECK_THAT(pedal(R"({"body": "jaw", "key": "1"})"),
               Contains("pedals[0].electrode must be in [0, 0), the electrodes of the body, got 0"));
    CHECK_THAT(pedal(R"({"body": "stick"})"), Contains("pedals[0]: needs a key or a button"));
    CHECK_THAT(pedal(R"({"body": "stick", "key": "n"})"), Contains("pedals[0].key must be a letter or a digit, and "
                                                                   "none of FHNPR, which the run needs, got 'n'"));
    CHECK_THAT(pedal(R"({"body": "stick", "key": "F1"})"), Contains("got 'F1'"));
    CHECK_THAT(pedal(R"({"body": "stick", "button": 1})"),
               Contains("pedals[0].button needs a haptic interface that holds the body"));
    CHECK_THAT(addingFails(folder, theatre(kWeak, R"(, "commands": [
{"time": 0, "type": "Activate", "id": "stick", "electrode": 1}])")),
               Contains(".electrode must be in [0, 1), the electrodes of the body, got 1"));
    CHECK_THAT(addingFails(folder, theatre(kWeak, R"(, "commands": [
{"time": 0, "type": "Activate", "id": "tissue"}])")),
               Contains("needs a rigid body, got soft body 'tissue'"));
}

} // namespace pedals_test
