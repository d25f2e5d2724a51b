#include "adding_fails.h"
#include "filasofia/filasofia.h"
#include "filasofia/physics/command_trial.h"
#include "filasofia/scene/scene_file.h"
#include "scene_folder.h"

#include <catch2/catch.hpp>

namespace commands_test {

using namespace filasofia;
using namespace filasofia::scene;
using Catch::Contains;

namespace {

/// An organ, a kinematic tool that moves, a ball that is free, and commands.
std::string theatre(const std::string& commands, const std::string& more = "")
{
    return R"({"physics": {"gravity": [0, 0, 0], "threads": 1}, "bodies": [
{"name": "organ", "mesh": {"type": "block", "size": "2 2 2 cm", "cells": [2, 2, 2]}, "collision": [{}], "attachments": [{"box": ["-1 -1 -1 m", [1, -0.009, 1]]}]},
{"type": "RigidBodyDef", "name": "tool", "elements": ["0 3 0 cm"], "mesh": {"type": "sphere", "radius": "4 mm"}, "collision": [{}],
 "motions": [{"keys": [{"time": 0, "pose": "0 3 0 cm"}, {"time": 1, "pose": "0 4 0 cm"}]}]},
{"type": "RigidBodyDef", "name": "ball", "elements": ["5 3 0 cm"], "mesh": {"type": "sphere", "radius": "4 mm"}, "dynamic": true,
 "mass": {"type": "TotalMass", "value": "1 g"}})" +
           more + "],\n\"commands\": [" + commands + "]}";
}

std::string refused(const std::string& commands, const std::string& more = "")
{
    return addingFails(SceneFolder(), theatre(commands, more));
}

RunReport ran(const std::string& commands, int steps, const std::string& more = "")
{
    const SceneFolder folder;
    const SceneDef scene = folder.load(theatre(commands, more));
    Simulation sim(simulationDef(scene));
    static_cast<void>(addScene(sim, scene));
    return sim.run({.headless = true, .steps = steps});
}

} // namespace

TEST_CASE("scenes: the motions of a body end when it is removed")
{
    const RunReport report = ran(R"({"time": "20 ms", "type": "RemoveBody", "id": "tool"})", 40);
    CHECK(report.complete());
    CHECK(report.steps == 40);
    const RunReport jointed = ran(R"({"time": "20 ms", "type": "RemoveBody", "id": "arm"})", 40, R"(,
{"type": "RigidBodyDef", "name": "arm", "elements": ["0 9 0 cm", "0 9 0 cm"], "articulation": {"joints": [{"parent": 0, "child": 1, "kind": "revolute"}]},
 "jointMotions": [{"joint": 0, "keys": [{"time": 0, "command": {"type": "JointPosition", "value": 0}}, {"time": "30 ms", "command": {"type": "JointPosition", "value": 1}}]}]})");
    CHECK(jointed.complete());
}

TEST_CASE("scenes: what a command cannot do is refused before the run, with its place")
{
    CHECK_THAT(
        refused(R"({"time": 5, "type": "ApplyClip", "id": "c", "rigid": "tool", "target": "organ"})"),
        Contains("scene.json:7:14: commands[0]: rigid body 'tool': clip must be a dynamic body; it is kinematic"));
    CHECK_THAT(refused(R"({"time": 5, "type": "RemovePiece", "id": "organ", "piece": 3})"),
               Contains("scene.json:7:14: commands[0]: soft body 'organ': piece 3 cannot be removed"));
    CHECK_THAT(refused(R"({"time": 0, "type": "SetFibreStress", "id": "organ"})"),
               Contains("commands[0]: soft body 'organ': family must be in [0, 0)"));
    CHECK_THAT(
        refused(R"({"time": 0, "type": "SetMaterial", "id": "organ", "material": {"type": "MassSpringMaterial"}})"),
        Contains("commands[0]: soft body 'organ': material must be of the kind"));
    CHECK_THAT(refused(R"({"time": 0, "type": "Grasp", "id": "g", "rigid": "tool", "target": "tool"})"),
               Contains("commands[0]: rigid body 'tool': grasp: target must be another body"));
    // Commands are tried in the order of their times, which is not that of the file.
    const std::string press = R"({"time": 2, "type": "SetPressure", "id": "organ", "pressure": 1})";
    const std::string away = R"({"time": 1, "type": "RemoveBody", "id": "organ"})";
    for (const std::string& commands : {press + "," + away, away + "," + press})
        CHECK_THAT(refused(commands), Contains("soft body 'organ' (body 1): no such body any more: it was removed"));
    CHECK_THAT(refused(away + R"(, {"time": 3, "type": "Grasp", "id": "g", "rigid": "tool", "target": "organ"})"),
               Contains("commands[1]: soft body 'organ' (body 1): no such body any more"));
    CHECK_THAT(refused(away + R"(, {"time": 3, "type": "Attach", "id": "g", "body": "organ", "def": {"nodes": [0]}})"),
               Contains("commands[1]: soft body 'organ' (body 1)"));
    CHECK_THAT(
        refused(
            away +
                R"(, {"time": 3, "type": "Attach", "id": "g", "body": "other", "def": {"nodes": [0], "to": "organ"}})",
            R"(,
{"name": "other", "mesh": {"type": "block", "size": "2 2 2 cm", "cells": [1, 1, 1]}})"),
        Contains("commands[1]: soft body 'other': attachment.to: soft body 'organ' (body 1): no such body any more"));
    CHECK_THAT(refused(away + R"(, {"time": 3, "type": "Treat", "id": "organ", "treatment": {"type": "Rinse"}})"),
               Contains("commands[1]: soft body 'organ' (body 1)"));
    CHECK(refused(press) == "no error");
    CHECK(refused(R"({"time": 3, "type": "RemoveBody", "id": "organ"}, )" + press) == "no error");
    CHECK(refused(R"({"time": 0, "type": "Attach", "id": "g", "body": "organ", "def": {"nodes": [0], "to": "ball"}},
                     {"time": 1, "type": "RemoveBody", "id": "ball"}, {"time": 2, "type": "Release", "id": "g"})") ==
          "no error");
}

TEST_CASE("a trial tells the ids that commands would make, and gives the server nothing")
{
    Simulation sim;
    const BodyId organ = sim.add(SoftBodyDef{.name = "organ", .mesh = shapes::block({1_cm, 1_cm, 1_cm}, {1, 1, 1})});
    const BodyId tool =
        sim.add(RigidBodyDef{.name = "tool", .mesh = shapes::box({1_cm, 1_cm, 1_cm}), .collision = {{}}});
    physics::PhysicsServer& server = sim.physics();
    physics::CommandTrial trial(server);
    CHECK(trial.give(physics::Grasp{{}, tool, organ, {}}) == AttachmentId{1});
    CHECK(trial.give(physics::Attach{{}, organ, {.nodes = {0}}}) == AttachmentId{2});
    CHECK_FALSE(trial.give(physics::Release{{2}}));
    CHECK_THROWS_WITH(trial.give(physics::Release{{3}}), Contains("attachment 3: no such attachment"));
    CHECK_FALSE(trial.give(physics::RemoveBody{organ}));
    CHECK_THROWS_WITH(trial.mustBeThere(organ), "soft body 'organ' (body 1): no such body any more: it was removed");
    CHECK_THROWS_WITH(trial.give(physics::SetPressure{organ, 1.0}), Contains("it was removed"));
    trial.mustBeThere(tool);
    CHECK(server.has(organ));
    server.setPressure(organ, 1.0);
    CHECK(server.attach(organ, {.nodes = {0}}) == AttachmentId{1});
}

TEST_CASE("scenes: what holds nothing has a line in the summary, with names and places")
{
    const RunReport report = ran(R"(
{"time": "5 ms", "type": "Grasp", "id": "g", "rigid": "tool", "target": "organ"},
{"time": "6 ms", "type": "Attach", "id": "a", "body": "far", "def": {"within": "1 mm", "to": "ball"}},
{"time": "9 ms", "type": "RemoveBody", "id": "tool"})",
                                 12, R"(,
{"name": "far", "mesh": {"type": "block", "size": "1 1 1 cm", "cells": [1, 1, 1]}, "pose": "0 20 0 cm",
 "attachments": [{"nodes": [0]}, {"within": "1 mm", "to": "organ"}]})");
    REQUIRE(report.nothingHeld.size() == 3);
    CHECK(report.nothingHeld[0] == "'far': attachments[1] to 'organ' holds nothing: no node was there");
    CHECK(report.nothingHeld[1] == "'tool (removed)': grasp of 'organ' holds nothing: they did not touch");
    CHECK(report.nothingHeld[2] == "'far': attachment 5 to 'ball' holds nothing: no node was there");
    for (const std::string& line : report.nothingHeld) CHECK_THAT(summary(report), Contains(line));
    std::string many;
    for (int i = 0; i < 15; ++i)
        many += text(i > 0 ? "," : "", R"({"time": "5 ms", "type": "Grasp", "id": "g)", i,
                     R"(", "rigid": "tool", "target": "organ"})");
    const RunReport grasps = ran(many, 12);
    REQUIRE(grasps.nothingHeld.size() == 13);
    CHECK(grasps.nothingHeld.back() == "and 3 more that hold nothing");
    CHECK(ran("", 12).nothingHeld.empty());
}

TEST_CASE("scenes: what breaks has a line in the summary, with the time and the force")
{
    const RunReport report = ran("", 200, R"(,
{"name": "flag", "mesh": {"type": "block", "size": "1 1 1 cm", "cells": [1, 1, 1]}, "pose": "0 3.9 0 cm",
 "attachments": [{"box": ["-1 0.043 -1 m", [1, 1, 1]]}, {"within": "5 mm", "to": "tool", "breakForce": "50 mN"}]})");
    REQUIRE(report.broke.size() == 1);
    CHECK_THAT(report.broke[0],
               Catch::Matches("'flag': attachments\\[1\\] to 'tool' broke at 0[.][0-9]+ s \\(0[.]0[0-9]+ N\\)"));
    CHECK_THAT(summary(report), Contains(report.broke[0]));
    CHECK(ran("", 12).broke.empty());
}

TEST_CASE("scenes: a body that is removed keeps its name in the report of what touched")
{
    const SceneFolder folder;
    const SceneDef scene = folder.load(R"({"physics": {"threads": 1}, "bodies": [
{"name": "organ", "mesh": {"type": "block", "size": "2 2 2 cm", "cells": [2, 2, 2]}, "collision": [{}]},
{"type": "RigidBodyDef", "name": "table", "elements": ["0 -16 0 mm"], "mesh": {"type": "box", "size": "5 1 5 cm"}, "collision": [{}]}],
"commands": [{"time": "80 ms", "type": "RemoveBody", "id": "table"}]})");
    Simulation sim(simulationDef(scene));
    static_cast<void>(addScene(sim, scene));
    const RunReport report = sim.run({.headless = true, .steps = 100});
    REQUIRE(report.contacts.size() == 1);
    CHECK(report.contacts[0].second == "table (removed)");
}

TEST_CASE("scenes: doubled nodes are joined where the mesh is read")
{
    const SceneFolder folder;
    folder.write("two.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n"
                            "5 1 0 0\n6 0 1 0\n7 0 0 1\n8 1 1 1\n$EndNodes\n$Elements\n2\n1 4 2 0 0 1 2 3 4\n"
                            "2 4 2 0 0 5 6 7 8\n$EndElements\n");
    const auto nodes = [&](const std::string& join) {
        const SceneDef scene =
            folder.load(R"({"bodies": [{"name": "a", "mesh": {"type": "tetrahedra", "file": "two.msh", "scale": 0.01)" +
                        join + "}}]}");
        return std::get<std::shared_ptr<const geometry::TetMesh>>(std::get<SoftBodyDef>(scene.bodies[0].def).mesh)
            ->nodes.size();
    };
    CHECK(nodes("") == 8);
    CHECK(nodes(R"(, "join": true)") == 5);
}

TEST_CASE("scenes: a list of a VTK file is chosen by its name")
{
    const SceneFolder folder;
    folder.write("two.vtk",
                 "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n0 0 0 1 0 0 0 1 0\n"
                 "0 0 1 1 1 1\nCELLS 2 10\n4 0 1 2 3\n4 1 2 3 4\nCELL_TYPES 2\n10 10\nCELL_DATA 2\n"
                 "SCALARS id int\nLOOKUP_TABLE default\n0 1\nSCALARS part int\nLOOKUP_TABLE default\n7 7\n");
    const auto load = [&](const std::string& labels) {
        return folder.load(R"({"bodies": [{"name": "a", "mesh": {"type": "tetrahedra", "file": "two.vtk")" + labels +
                           "}}]}");
    };
    const auto labelsOf = [&](const std::string& labels) {
        const SceneDef scene = load(labels);
        return std::get<std::shared_ptr<const geometry::TetMesh>>(std::get<SoftBodyDef>(scene.bodies[0].def).mesh)
            ->labels;
    };
    CHECK(labelsOf("") == std::vector{0, 1});
    CHECK(labelsOf(R"(, "labels": "part")") == std::vector{7, 7});
    CHECK_THROWS_WITH(load(R"(, "labels": "organ")"), Catch::Contains("its lists: 'id', 'part'"));
}

TEST_CASE("scenes: wrong shapes and labels say what they have and where it belongs")
{
    const auto with = [](const std::string& body) {
        return addingFails(SceneFolder(), "{\"bodies\": [{\"name\": \"a\",\n" + body + "}]}");
    };
    CHECK_THAT(
        with(R"("mesh": {"type": "block", "size": "1 1 1 cm"}, "attachments": [{"box": ["1 1 1 mm", "-1 2 2 mm"]}])"),
        Contains("box must have a lower corner that is <= the upper one in every axis, got "
                 "[\"1 1 1 mm\",\"-1 2 2 mm\"]"));
    CHECK_THAT(
        with(
            R"("mesh": {"type": "block", "size": "1 1 1 cm"}, "material": {"regions": [{"where": {"type": "Labelled", "label": "tumour"}}]})"),
        Contains("label must be a whole number, got \"tumour\" (the name of a label goes into the field 'name')"));
    const SceneFolder folder;
    folder.write("a.msh", "x");
    CHECK_THAT(
        addingFails(
            folder,
            "{\"bodies\": [{\"name\": \"a\",\n \"mesh\": \"a.msh\",\n \"material\": {\"type\": \"ShellMaterial\"}}]}"),
        Contains("scene.json:2:") && Contains("soft body 'a': mesh must have triangles, for its ShellMaterial: "));
    CHECK_THAT(
        addingFails(SceneFolder(), R"({"bodies": [{"name": " ", "mesh": {"type": "block", "size": "1 1 1 cm"}}]})"),
        Contains("scene.json:1:") && Contains("soft body: name must have a visible letter"));
}

} // namespace commands_test
