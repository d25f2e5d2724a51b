#include "adding_fails.h"
#include "filasofia/filasofia.h"
#include "filasofia/runtime/stepped_run.h"
#include "filasofia/scene/scene_file.h"
#include "scene_folder.h"

#include <catch2/catch.hpp>

#include <array>

namespace instruments_test {

using namespace filasofia;
using namespace filasofia::scene;
using Catch::Matchers::Contains;

namespace {

const std::string kBiopsy = text(FILASOFIA_SOURCE_DIR, "/examples/scenes/biopsy.json");

} // namespace

TEST_CASE("scenes: instruments of a file take a polyp, step by step, and the session says so")
{
    const SceneFolder folder;
    const SceneDef scene = loadScene(kBiopsy);
    saveScene(scene, folder.file("again.json"));
    std::vector<std::uint64_t> hashes;
    for (const SceneDef& each : {scene, loadScene(folder.file("again.json"))}) {
        Simulation sim(simulationDef(each));
        AddedScene added = addScene(sim, each, {.keep = true, .session = {.trainee = "A. B."}});
        REQUIRE(added.bodies.size() == 4);
        const RunReport report = sim.run({.headless = true, .backend = visual::Backend::Null, .steps = 2600});
        CHECK(report.finished == "task 'biopsy' is done");
        CHECK(report.steps < 2000);
        hashes.push_back(report.hash);
        const prefab::TaskProgress progress = added.task->progress();
        CHECK(progress.state == prefab::TaskProgress::State::Done);
        REQUIRE(progress.doneAt.size() == 3);
        CHECK(progress.doneAt[0] == Approx(0.6).margin(0.3)); // on the way in
        CHECK(progress.doneAt[1] > 1.0);                      // the jaws close at 1 s
        CHECK(progress.doneAt[2] > 1.3);                      // the pull begins
        added.tracker->close();
        const metric::Session& session = added.tracker->session();
        CHECK(session.trainee == "A. B.");
        CHECK(session.task == "biopsy");
        CHECK(session.targets == std::vector<std::string>{"polyp"});
        CHECK(session.tracks.at(1).role == metric::Role::Scope);
        std::string steps;
        for (const metric::Event& event : session.events)
            if (event.kind == metric::EventKind::Step) steps += event.what + ' ';
        CHECK(steps == "approach grasp take ");
    }
    CHECK(hashes[0] == hashes[1]);
}

TEST_CASE("scenes: a state saved after a tear goes on with the same bits")
{
    const SceneDef scene = loadScene(kBiopsy);
    Simulation sim(simulationDef(scene));
    static_cast<void>(addScene(sim, scene));
    runtime::SteppedRun run(sim);
    for (int i = 0; i < 1500; ++i) run.step(); // tissue tears, and the jaws still hold it
    const auto state = run.save();
    const auto go = [&] {
        for (int i = 0; i < 120; ++i) run.step();
        return sim.physics().hash();
    };
    const std::uint64_t hash = go();
    run.restore(*state);
    CHECK(go() == hash);
}

TEST_CASE(
    "scenes: a state saved while jaws press, ask or hold is restored with its task and measures, here and elsewhere")
{
    const SceneDef scene = loadScene(kBiopsy);
    struct Run {
        explicit Run(const SceneDef& of)
            : sim(simulationDef(of)), added(addScene(sim, of, {.keep = true})), stepped(sim)
        {
        }
        std::vector<std::uint64_t> hashes(int steps)
        {
            std::vector<std::uint64_t> out;
            for (int i = 0; i < steps; ++i) {
                stepped.step();
                if (i % 20 == 0) out.push_back(sim.physics().hash());
            }
            out.push_back(sim.physics().hash());
            return out;
        }
        Simulation sim;
        AddedScene added;
        runtime::SteppedRun stepped;
    };
    const auto session = [](Run& run) {
        run.added.tracker->close();
        const metric::Session& found = run.added.tracker->session();
        std::string out = text(found.tracks[0].samples.size(), " samples");
        for (const metric::Event& each : found.events) out += text("; ", each.what, " at ", each.time);
        return out;
    };
    Run run(scene);
    std::vector<std::shared_ptr<const runtime::RunState>> states; // open, closing, holding, and when it is done
    std::vector<std::vector<std::uint64_t>> expected(4);
    for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t steps = std::array{950, 70, 200, 500}[i];
        for (const std::uint64_t hash : run.hashes(static_cast<int>(steps))) expected[i].push_back(hash);
        states.push_back(run.stepped.save());
    }
    CHECK(run.stepped.report().finished == "task 'biopsy' is done");
    const std::vector<double> doneAt = run.added.task->progress().doneAt;
    REQUIRE(doneAt.size() == 3);
    for (const std::size_t i : {2, 1, 0}) {
        run.stepped.restore(*states[i]);
        CHECK(run.added.task->progress().state == prefab::TaskProgress::State::Running);
        CHECK(run.stepped.report().finished == "not yet");
        for (std::size_t next = i; next < 3; ++next)
            CHECK(run.hashes(std::array{70, 200, 500}[next]) == expected[next + 1]);
    }
    CHECK(run.added.task->progress().doneAt == doneAt);
    CHECK(run.stepped.report().finished == "task 'biopsy' is done");

    // In another simulation the commands that led to the state are not given again.
    Run other(scene), without(scene);
    other.stepped.step();
    other.stepped.restore(*states[2]);
    CHECK(other.hashes(500) == expected[3]);
    CHECK(other.added.task->progress().doneAt == doneAt);

    // The session is that of a run without detours; that of the other one begins with the state.
    without.hashes(1720);
    CHECK(session(run) == session(without));
    CHECK(other.added.tracker->taken() > 0);
    other.added.tracker->close();
    CHECK(other.added.tracker->session().tracks[0].samples.front().time == Approx(1.22));

    // What does not know the jaws is refused, and nothing has happened.
    Simulation plain(simulationDef(scene));
    static_cast<void>(addScene(plain, scene));
    auto strange = *states[0];
    strange.memories.erase("instrument 'forceps'");
    runtime::SteppedRun plainRun(plain);
    plainRun.step();
    const std::uint64_t before = plain.physics().hash();
    CHECK_THROWS_WITH(plainRun.restore(strange), "restore: the state knows nothing of instrument 'forceps'");
    CHECK(plain.physics().hash() == before);
    plainRun.restore(*states[0]); // a state may know what is not there: a tracker
    CHECK(plain.physics().hash() == expected[0].back());
}

TEST_CASE("scenes: each condition of a task holds when it should")
{
    const SceneFolder folder;
    const auto stepsIn = [&](const std::string& condition) {
        const SceneDef scene = folder.load(text(R"({"physics": {"rate": 500, "gravity": [0, 0, 0]}, "bodies": [
            {"name": "tissue", "mesh": {"type": "block", "size": "20 20 20 mm"}, "collision": [{}],
             "attachments": [{"box": [[-1, -1, -1], [1, "-9.9 mm", 1]]}]},
            {"type": "RigidBodyDef", "name": "ball", "elements": ["0 40 0 mm"], "mesh": {"type": "sphere", "radius": "5 mm"},
             "collision": [{}], "motions": [{"keys": [{"time": 0.4, "pose": "0 13 0 mm"}]}]}],
            "commands": [{"time": 0.5, "type": "Grasp", "rigid": "ball", "target": "tissue", "id": "grip"}],
            "task": {"steps": [{"done": )",
                                                condition, "}]}}"));
        Simulation sim(simulationDef(scene));
        static_cast<void>(addScene(sim, scene));
        return sim.run({.headless = true, .steps = 400}).steps;
    };
    CHECK(stepsIn(R"({"type": "Waited", "seconds": 0.1})") == Approx(51).margin(2));
    CHECK(
        stepsIn(
            R"({"type": "Reached", "body": "ball", "tip": [0, -0.005, 0], "place": [0, 0.01, 0], "within": "10 mm"})") ==
        Approx(200.0 * 15 / 27).margin(3)); // it has come from 40 to 25 mm
    CHECK(stepsIn(R"({"type": "Reached", "body": "ball", "target": "tissue", "within": "20 mm"})") ==
          Approx(149).margin(4));
    const std::string corner = R"("body": "tissue", "place": "-10 -10 -10 mm", "within": "1 mm"})"; // that of node 0
    CHECK(stepsIn(R"({"type": "Reached", "node": 0, )" + corner) < 5);
    CHECK(stepsIn(R"({"type": "Reached", "node": 1, )" + corner) == 400);
    CHECK(stepsIn(R"({"type": "Touched", "first": "tissue", "second": "ball"})") == Approx(185).margin(5)); // at 15 mm
    CHECK(stepsIn(R"({"type": "Touched", "first": "ball", "second": "tissue", "force": 1000})") == 400);
    CHECK(stepsIn(R"({"type": "Held", "body": "tissue"})") == Approx(252).margin(3));
    CHECK(stepsIn(R"({"type": "Held", "body": "ball", "by": "tissue"})") == Approx(252).margin(3));
}

TEST_CASE("scenes: what was cut before a reset does not count: the body is whole again")
{
    const SceneFolder folder;
    const auto doneAt = [&](const std::string& reset) {
        const SceneDef scene =
            folder.load(text(R"({"physics": {"gravity": [0, 0, 0]}, "bodies": [
            {"name": "tissue", "mesh": {"type": "block", "size": "20 20 20 mm", "cells": [4, 4, 4]}, "dynamicTopology": true,
             "collision": [{}], "attachments": [{"box": [[-1, -1, -1], [1, "-9.9 mm", 1]]}]},
            {"type": "RigidBodyDef", "name": "blade", "elements": ["-30 8 0 mm"],
             "mesh": {"type": "box", "size": "4 20 30 mm"}, "collision": [{"cutting": true}],
             "motions": [{"keys": [{"time": 0.1, "pose": "30 8 0 mm"}, {"time": 0.5, "pose": "30 8 0 mm"},
                                   {"time": 0.6, "pose": "-30 8 0 mm"}]}]}],)",
                             reset, R"("task": {"steps": [{"done": {"type": "Waited", "seconds": 0.3}},
                       {"done": {"type": "Parted", "body": "tissue", "area": "0.5 cm^2"}}]}})"));
        Simulation sim(simulationDef(scene));
        const AddedScene added = addScene(sim, scene);
        sim.run({.headless = true, .steps = 800});
        return added.task->progress().doneAt;
    };
    const std::vector<double> counted = doneAt("");
    REQUIRE(counted.size() == 2);
    CHECK(counted[1] == Approx(0.301).margin(0.002)); // it was cut at 0.1 s
    const std::vector<double> again = doneAt(R"("commands": [{"time": 0.2, "type": "Reset"}], )");
    REQUIRE(again.size() == 2);
    CHECK(again[1] > 0.5); // by the way back
}

TEST_CASE("scenes: a time has come in the step that ends at it, also where the sum of the steps is a little short")
{
    const SceneFolder folder;
    const SceneDef scene = folder.load(R"({"bodies": [{"type": "RigidBodyDef", "name": "a"}],
        "commands": [{"time": "2 s", "type": "SetPose", "id": "a", "pose": "10 0 0 mm"}],
        "task": {"steps": [{"done": {"type": "Waited", "seconds": 3}}]}})");
    Simulation sim(simulationDef(scene));
    const AddedScene added = addScene(sim, scene);
    std::optional<std::uint64_t> moved;
    sim.on<event::PhysicsUpdateEvent>([&](const event::PhysicsUpdateEvent& done) {
        if (!moved && sim.physics().latest()->rigidBodies.front().poses.front().position.x > 0.005) moved = done.step;
    });
    sim.run({.headless = true, .steps = 3500});
    CHECK(moved == 2000);
    REQUIRE(added.task->progress().doneAt.size() == 1);
    CHECK(added.task->progress().doneAt[0] == Approx(3.0).margin(1e-6));
}

TEST_CASE("scenes: an instrument begins at its pose or at its key at 0 s, and cannot have both")
{
    const SceneFolder folder;
    const std::string key = R"("keys": [{"time": 0, "pose": "0 50 0 mm"}, {"time": 1, "pose": "0 20 0 mm"}])";
    for (const std::string type : {"ArticulatedInstrumentDef", "EndoscopeDef"}) {
        const std::string first = "{\"instruments\": [{\"type\": \"" + type + "\", \"name\": \"s\", ";
        const SceneDef scene = folder.load(first + key + "}]}");
        Simulation sim(simulationDef(scene));
        const BodyId body = addScene(sim, scene).bodies.at(0);
        const auto def = std::get<RigidBodyDef>(*sim.physics().def(body));
        CHECK(def.elements.at(0).position == Vec3{0, 0.05, 0}); // and not at the origin, from where it would jump
        for (const std::string pose : {"\"0 10 0 mm\"", "[0, 0, 0]"})
            CHECK_THAT(addingFails(folder, first + "\n\"pose\": " + pose + ", " + key + "}]}"),
                       Contains("scene.json:2:9: instruments[0].pose must not differ from that of keys[0]"));
        CHECK(addingFails(folder, first + "\"pose\": \"0 50 0 mm\", " + key + "}]}") == "no error");
    }
}

TEST_CASE("scenes: a task whose time is over ends the run")
{
    const SceneFolder folder;
    const SceneDef scene = folder.load(R"({"bodies": [{"type": "RigidBodyDef", "name": "a"}],
        "task": {"timeLimit": "0.1 s", "steps": [{"done": {"type": "Waited", "seconds": 1}}]}})");
    Simulation sim(simulationDef(scene));
    static_cast<void>(addScene(sim, scene));
    const RunReport report = sim.run({.headless = true, .steps = 400});
    CHECK(report.finished == "task 'task' is out of time");
    CHECK(report.steps == Approx(101).margin(2));
}

TEST_CASE("scenes: the button of a hand closes the jaws of the instrument that it holds")
{
    const SceneFolder folder;
    folder.write("hand.csv",
                 "time,x,y,z,qw,qx,qy,qz,buttons\n0,0,0,0,1,0,0,0,0\n0.2,0,0,0,1,0,0,0,1\n1,0,0.01,0,1,0,0,0,1\n"
                 "1.01,0,0.01,0,1,0,0,0,0\n2,0,0.01,0,1,0,0,0,0\n");
    const SceneDef scene = folder.load(R"({"instruments": [{"name": "forceps", "opening": 1, "pose": "0 100 0 mm"}],
        "haptics": [{"device": {"type": "ScriptedDevice", "motion": "hand.csv"}, "body": "forceps"}]})");
    Simulation sim(simulationDef(scene));
    const BodyId forceps = addScene(sim, scene).bodies.at(0);
    const auto after = [&](int steps) {
        sim.run({.headless = true, .backend = visual::Backend::Null, .steps = steps});
        return *sim.physics().latest()->rigidBody(forceps);
    };
    const double open = std::abs(after(150).joints.at(0).position);
    CHECK(open > 0.5);
    const frame::RigidBodyFrame closed = after(850);
    CHECK(std::abs(closed.joints.at(0).position) < 0.05);
    CHECK(closed.poses[0].position.y == Approx(0.11).margin(1e-3)); // it follows the hand
    CHECK(std::abs(after(1000).joints.at(0).position) == Approx(open).margin(0.05));
}

TEST_CASE("scenes: a click closes the jaws of an instrument, and the next one opens them")
{
    const SceneFolder folder;
    folder.write("hand.csv",
                 "time,x,y,z,qw,qx,qy,qz,buttons\n0,0,0,0,1,0,0,0,0\n0.2,0,0,0,1,0,0,0,1\n0.3,0,0,0,1,0,0,0,0\n"
                 "1,0,0,0,1,0,0,0,1\n1.5,0,0,0,1,0,0,0,0\n2,0,0,0,1,0,0,0,1\n2.6,0,0,0,1,0,0,0,0\n");
    for (const bool closed : {false, true}) {
        const SceneDef scene = folder.load(text(R"({"instruments": [{"name": "forceps", "opening": )", closed ? 0 : 1,
                                                R"(, "pose": "0 100 0 mm"}],
        "haptics": [{"device": {"type": "ScriptedDevice", "motion": "hand.csv"}, "body": "forceps"}]})"));
        Simulation sim(simulationDef(scene));
        const BodyId forceps = addScene(sim, scene).bodies.at(0);
        const auto openAfter = [&](int steps) {
            sim.run({.headless = true, .backend = visual::Backend::Null, .steps = steps});
            return std::abs(sim.physics().latest()->rigidBody(forceps)->joints.at(0).position) > 0.25;
        };
        CHECK(openAfter(150) != closed);
        CHECK(openAfter(750) == closed); // 0.9 s: a click changes them
        CHECK(openAfter(500) != closed); // 1.4 s: and the next press, while it is down
        CHECK(openAfter(400) == true);   // 1.8 s: what was held closed opens, and what is open stays
        CHECK(openAfter(740) == false);  // 2.54 s: down
        CHECK(openAfter(700) == true);   // 3.24 s: up
    }
}

TEST_CASE("scenes: instruments, tasks and measures that are wrong are refused with their place")
{
    const SceneFolder folder;
    const auto fails = [&](const std::string& content) { return addingFails(folder, content); };
    const std::string ball = R"("bodies": [{"type": "RigidBodyDef", "name": "ball"}])";
    CHECK_THAT(fails("{" + ball + ",\n\"instruments\": [{\"name\": \"ball\"}]}"),
               Contains("scene.json:2:17: instruments[0].name must differ"));
    CHECK_THAT(
        fails(
            "{\"instruments\": [\n{\"keys\": [{\"time\": 2, \"pose\": [0,0,0]}, {\"time\": 1, \"pose\": [0,0,0]}]}]}"),
        Contains("scene.json:2:") && Contains("instruments[0].keys[1].time must be later"));
    CHECK_THAT(fails("{\"instruments\": [\n{\"type\": \"EndoscopeDef\", \"grip\": [{\"time\": 1}]}]}"),
               Contains("scene.json:2:") && Contains("grip must be empty: an endoscope has no jaws"));
    CHECK_THAT(fails("{\"instruments\": [{\"kind\": \"pliers\"}]}"), Contains("forceps, grasper, scissors"));
    CHECK_THAT(fails("{\"instruments\": [{\"opening\": 2}]}"), Contains("opening must be in [0, 1], got 2"));
    CHECK_THAT(
        fails("{\"instruments\": [{\"type\": \"EndoscopeDef\", \"name\": \"s\"}],\n\"haptics\": [{\"body\": \"s\"}]}"),
        Contains("scene.json:2:13: haptics[0]: body must not be an endoscope"));
    CHECK_THAT(fails("{\"instruments\": [{\"name\": \"s\", \"keys\": [{\"pose\": [0,0,0]}]}],\n\"haptics\": "
                     "[{\"body\": \"s\"}]}"),
               Contains("without keys of its own"));
    CHECK_THAT(
        fails("{" + ball + ", \"task\": {\"steps\": [{\"done\": {\"type\": \"Reached\", \"body\": \"ball\"}}]}}"),
        Contains("scene.json:1:") && Contains("task.steps[0].done must have a place or a target"));
    CHECK_THAT(fails("{" + ball + ", \"task\": {\"steps\": [{}]}}"), Contains("done"));
    const auto step = [&](const std::string& done) {
        return fails("{" + ball + ", \"task\": {\"steps\": [{\"done\": " + done + "}]}}");
    };
    CHECK_THAT(step(R"({"type": "Reached", "body": "ball", "element": 3, "place": [0, 0, 0]})"),
               Contains("task.steps[0].done.element must be in [0, 1), got 3"));
    CHECK_THAT(step(R"({"type": "Reached", "body": "ball", "node": 0, "place": [0, 0, 0]})"),
               Contains("task.steps[0].done.node must not be given for a rigid body"));
    const auto rod = [&](int node) {
        return fails(text(R"({"bodies": [{"type": "RodBodyDef", "name": "rod", "points": [[0, 0, 0], [0, 0.01, 0]], )",
                          R"("spacing": 0.001}], "task": {"steps": [{"done": {"type": "Reached", "body": "rod", )",
                          R"("node": )", node, R"(, "place": [0, 0, 0]}}]}})"));
    };
    CHECK_THAT(rod(11), Contains("task.steps[0].done.node must be in [0, 11), got 11"));
    const auto touched = [&](const std::string& other) {
        return fails(
            R"({"bodies": [{"type": "RigidBodyDef", "name": "a", "mesh": {"type": "sphere", "radius": "5 mm"}, )"
            R"("collision": [{}]}, {"type": "RigidBodyDef", "name": "b", "elements": ["20 0 0 mm"], )"
            R"("mesh": {"type": "sphere", "radius": "5 mm"}, "collision": [)" +
            other + R"(]}], "task": {"steps": [{"done": {"type": "Touched", "first": "a", "second": "b"}}]}})");
    };
    CHECK(touched("{}") == "no error");
    for (const std::string other : {"", "{\"group\": 1}"})
        CHECK_THAT(touched(other), Contains("task.steps[0].done must name two bodies whose collision has a group in "
                                            "common: rigid body 'a' and rigid body 'b' never touch"));
    CHECK_THAT(step(R"({"type": "Reached", "body": "ball", "target": "ball"})"),
               Contains("must name two bodies, got rigid body 'ball' twice"));
    CHECK_THAT(step(R"({"type": "Touched", "first": "ball", "second": "ball"})"), Contains("must name two bodies"));
    CHECK_THAT(step(R"({"type": "Held", "body": "ball", "by": "ball"})"), Contains("must name two bodies"));
    CHECK_THAT(step(R"({"type": "Pierced", "body": "ball"})"),
               Contains("must be a soft body with a puncture, got rigid body 'ball'"));
    CHECK_THAT(step(R"({"type": "Parted", "body": "ball"})"),
               Contains("must be a soft body or a rod with dynamicTopology, got rigid body 'ball'"));
    CHECK_THAT(
        fails(
            "{" + ball +
            R"(, "task": {"steps": [{"name": "a", "done": {"type": "Waited"}}, {"name": "a", "done": {"type": "Waited"}}]}})"),
        Contains("task.steps[1].name must differ from those before it, got 'a'"));
    CHECK_THAT(fails("{\"instruments\": [{\"name\": \"s\", \"keys\": [{\"time\": 1, \"pose\": [1e30, 0, 0]}]}]}"),
               Contains("scene.json:1:") && Contains("instruments[0].keys[0].pose"));
    CHECK_THAT(fails("{\"instruments\": [{\"name\": \"s\"}], \"commands\": [{\"time\": 1, \"type\": \"RemoveBody\", "
                     "\"id\": \"s\"}]}"),
               Contains("commands[0].id must not be an instrument"));
    CHECK_THAT(addingFails(folder, "{" + ball + ",\n\"measured\": [{\"body\": \"ball\", \"element\": 9}]}", true),
               Contains("scene.json:2:") && Contains("measured[0].element must be"));
    CHECK_THAT(
        fails("{" + ball + ",\n\"measured\": [{\"body\": \"ball\", \"element\": 9}]}"), // also if nobody measures
        Contains("scene.json:2:") && Contains("measured[0].element must be"));
    CHECK_THAT(fails("{" + ball + ",\n\"measured\": [{\"body\": \"ball\", \"axis\": [0, 0, 0]}]}"),
               Contains("scene.json:2:") && Contains("measured[0].axis must have a length > 0"));
    CHECK_THAT(fails("{\"instruments\": [{\"name\": \"s\"}],\n\"haptics\": [{\"body\": \"s\", \"element\": 1}]}"),
               Contains("scene.json:2:13: haptics[0]") && Contains("element must be in [0, 1), got 1"));
    CHECK_THAT(fails("{" + ball + ", \"task\": {\"steps\": []}}"), Contains("steps must have at least one entry"));
    CHECK_THAT(fails("{" + ball + ", \"task\": {\"steps\": [{\"done\": {\"type\": \"Held\", \"body\": \"bal\"}}]}}"),
               Contains("task.steps[0].done.body must be the name of a body") && Contains("did you mean 'ball'?"));
    CHECK_THAT(addingFails(folder, "{" + ball + "}", true), Contains("measured must name a body"));
    CHECK_THAT(fails("{" + ball + ", \"measured\": [{\"body\": \"ball\", \"role\": \"camera\"}]}"),
               Contains("tool, scope, other"));
}

} // namespace instruments_test
