#include "filasofia/filasofia.h"
#include "filasofia/runtime/stepped_run.h"
#include "filasofia/scene/scene_file.h"
#include "scene_folder.h"
#include "skip.h"

#include <catch2/catch.hpp>

namespace filasofia::scene {
namespace {

std::string example(const std::string& name) { return text(FILASOFIA_SOURCE_DIR, "/examples/scenes/", name, ".json"); }

RunReport runScene(const SceneDef& scene, int steps)
{
    Simulation sim(simulationDef(scene));
    static_cast<void>(addScene(sim, scene));
    return sim.run(RunDef{.headless = true, .steps = steps});
}

} // namespace

TEST_CASE("scenes: the bunny's file has the hash of its program")
{
    Simulation sim({.physics = {.rate = 1_kHz, .slack = 2_ms}});
    const BodyId bunny = sim.add(SoftBodyDef{
        .name = "bunny",
        .mesh = asset("meshes/bunny_3004.msh"),
        .material = FemMaterial{.youngModulus = 10_kPa, .poissonRatio = 0.45},
        .attachments = {{.box = Box{{-1, 0.105, -1}, {1, 1, 1}}}},
    });
    sim.show(bunny, {.surface = asset("meshes/bunny.obj"), .subdivision = 1});
    CHECK(runScene(loadScene(example("bunny")), 60).hash == sim.run({.headless = true, .steps = 60}).hash);
}

TEST_CASE("scenes: a body burns where it is heated, little power blanches and much chars, and an injury is told")
{
    const RunReport report = runScene(loadScene(example("burning")), 700);
    REQUIRE(report.heat.size() == 2);
    const auto& [liver, bowel] = std::tie(report.heat[0], report.heat[1]);
    CHECK(liver.balance.delivered < 1.01 * (6.0 + 60.0) * 2.9);
    CHECK(liver.balance.delivered > 0.9 * (6.0 + 60.0) * 2.9); // what is charred takes no more
    CHECK(liver.balance.burnt > 50e-6);
    CHECK(liver.balance.charred < liver.balance.burnt);
    CHECK(liver.target);
    CHECK(bowel.balance.delivered == Approx(40.0).epsilon(0.02));
    CHECK(bowel.balance.burnt > 5e-6);
    CHECK_FALSE(bowel.target);
}

TEST_CASE("scenes: a body bleeds where it is cut, and its blood is sucked, sealed and rinsed")
{
    const RunReport report = runScene(loadScene(example("bleeding")), 2000);
    REQUIRE(report.blood.size() == 1);
    const BloodBalance& blood = report.blood[0].balance;
    CHECK(blood.welled > 0.3e-6);
    CHECK(blood.sucked > 0.05e-6);
    CHECK(blood.rinsed > 0.03e-6);
    CHECK(blood.rate == 0.0); // sealed
    CHECK(blood.onTissue < 1e-9);
    CHECK(blood.welled == Approx(blood.onTissue + blood.sucked + blood.rinsed + blood.dripped).epsilon(1e-9));
}

TEST_CASE("scenes: a scene that shows no body shows all that have a surface, and one that shows one shows no other")
{
    const RigidBodyDef bare{.name = "bare"}, plate{.name = "plate", .mesh = shapes::box({1, 1, 1})};
    SceneDef scene{.bodies = {{.def = bare}, {.def = plate}, {.def = SoftBodyDef{.name = "soft"}}}};
    std::get<SoftBodyDef>(scene.bodies[2].def).mesh = shapes::block({1, 1, 1}, {1, 1, 1});
    const auto drawn = [&] {
        Simulation sim(simulationDef(scene));
        const AddedScene added = addScene(sim, scene);
        std::vector<std::string> names;
        for (const auto& [body, shown] : added.drawn) names.push_back(sim.physics().nameOf(body));
        const RunReport report = sim.run({.backend = visual::Backend::Null, .steps = 3});
        return std::pair(names, report.visual.bodies);
    };
    CHECK(drawn() == std::pair(std::vector<std::string>{"plate", "soft"}, 2));
    scene.bodies[2].show = {{}};
    CHECK(drawn() == std::pair(std::vector<std::string>{}, 1));
}

TEST_CASE("scenes: friction, a grasp and a poke come out as they do in C++")
{
    const SceneDef friction = loadScene(example("friction"));
    Simulation slope(simulationDef(friction));
    const std::vector<BodyId> boxes = addScene(slope, friction).bodies;
    slope.run({.headless = true, .steps = 500});
    const auto frame = slope.physics().latest();
    const Quat back = axisAngle({0, 0, 1}, 20_deg); // from the world's axes to the slope's
    const auto moved = [&](std::size_t i) {
        return rotate(back, frame->rigidBody(boxes[i])->poses[0].position).x + 80_mm;
    };
    CHECK(std::abs(moved(1)) < 1e-4);
    CHECK(moved(2) == Approx(0.5 * 9.81 * (std::sin(20_deg) - 0.3 * std::cos(20_deg)) * 0.25).epsilon(0.1));

    const SceneDef jaws = loadScene(example("jaws"));
    Simulation gripper(simulationDef(jaws));
    const std::vector<BodyId> ids = addScene(gripper, jaws).bodies;
    gripper.run({.headless = true, .steps = 1500});
    const auto last = gripper.physics().latest();
    const auto lowest = std::ranges::min(last->softBody(ids[0])->positions, {}, &Vec3::y);
    CHECK(lowest.y > 25_mm);
    CHECK(lowest.y < 31_mm);

    const SceneDef poke = loadScene(example("poke"));
    Simulation block(simulationDef(poke));
    const std::vector<BodyId> bodies = addScene(block, poke).bodies;
    double highest = 0.0, deepest = 1.0;
    block.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent&) {
        const double y = block.physics().latest()->rigidBody(bodies[1])->poses[0].position.y;
        highest = std::max(highest, y);
        deepest = std::min(deepest, y);
    });
    block.run({.headless = true, .steps = 1500});
    CHECK(block.physics().latest()->rigidBody(bodies[1])->poses[0].position.y == Approx(12_mm)); // the second poke
    CHECK(highest == Approx(28_mm).margin(1e-4));
    CHECK(deepest == Approx(12_mm).margin(1e-4));
}

TEST_CASE("scenes: a sheet falls over an organ and is lifted by its middle")
{
    SceneDef shell = loadScene(example("shell"));
    shell.physics.rate = 500.0; // half of the steps
    Simulation sim(simulationDef(shell));
    const BodyId sheet = addScene(sim, shell).bodies.at(0);
    const auto heights = [&](int steps) {
        sim.run({.headless = true, .steps = steps});
        const auto frame = sim.physics().latest();
        const auto [low, high] = std::ranges::minmax(frame->softBody(sheet)->positions, {}, &Vec3::y);
        return std::pair(low.y, high.y);
    };
    const auto [lying, top] = heights(500);
    CHECK(lying > -0.1_mm);
    CHECK(top == Approx(20_mm).margin(2_mm)); // on the organ
    const auto [rim, tip] = heights(250);
    CHECK(rim > -0.1_mm);
    CHECK(rim < 15_mm);
    CHECK(tip == Approx(top + 15_mm).margin(2_mm)); // half of the way
}

TEST_CASE("scenes: a thread falls over a bar and holds")
{
    const SceneDef scene = loadScene(example("thread"));
    Simulation sim(simulationDef(scene));
    const BodyId thread = addScene(sim, scene).bodies.at(0);
    sim.run({.headless = true, .steps = 1000});
    const auto frame = sim.physics().latest();
    const std::vector<Vec3>& nodes = frame->softBody(thread)->positions;
    CHECK(nodes.size() == 121);
    CHECK(std::ranges::max(nodes, {}, &Vec3::y).y == Approx(8.5_mm).margin(0.1_mm)); // a radius above the bar
    CHECK(nodes.front().y < -25_mm);
    CHECK(nodes.back().y < nodes.front().y - 5_mm);
}

TEST_CASE("scenes: a curved needle goes through both edges of a wound, with the forces of the file")
{
    const SceneDef scene = loadScene(example("suture"));
    Simulation sim(simulationDef(scene));
    const std::vector<BodyId> bodies = addScene(sim, scene).bodies;
    sim.run({.headless = true, .steps = 2300}); // the needle is in both, its tail is not
    const auto frame = sim.physics().latest();
    REQUIRE(frame->channels.size() == 2);
    for (std::size_t i : {0, 1}) {
        const frame::Channel& channel = frame->channels[i];
        CHECK(channel.tissue == bodies.at(i));
        CHECK(channel.needle == bodies.at(2));
        CHECK(channel.inside == bodies.at(2));
        CHECK(channel.through);
        CHECK(channel.length > 6_mm);
        CHECK(channel.length < 10_mm);
        CHECK(channel.friction > 0.8 * 6.0 * channel.length); // the tissue is dragged towards the tip
    }
    CHECK(frame->channels[0].entry.x < -6_mm);
    CHECK(frame->channels[1].end.x > 6_mm);
}

TEST_CASE("scenes: commands of joints are given when their time comes, again in every round")
{
    SceneDef scene{.physics = {.rate = 100.0}};
    RigidBodyDef arm{.name = "arm"};
    arm.articulation.joints = {{.start = 0.0, .speed = 100.0}};
    scene.bodies = {{.def = arm,
                     .jointMotions = {{.keys = {{0.1, physics::JointPosition{0.5}}, {0.2, physics::JointPosition{0.2}}},
                                       .repeat = true}}}};
    Simulation sim(simulationDef(scene));
    const BodyId id = addScene(sim, scene).bodies.at(0);
    const auto positionAfter = [&](int steps) {
        sim.run({.headless = true, .steps = steps});
        return sim.physics().latest()->rigidBody(id)->joints.at(0).position;
    };
    CHECK(positionAfter(8) == 0.0);
    CHECK(positionAfter(8) == Approx(0.5)); // 0.16 s
    CHECK(positionAfter(8) == Approx(0.2)); // 0.24 s
    CHECK(positionAfter(8) == Approx(0.5)); // 0.32 s
}

namespace {

const char* const kPressed = R"({
    "physics": {"rate": 1000},
    "bodies": [
        {"name": "table", "type": "RigidBodyDef", "mesh": {"type": "box", "size": "9 2 9 cm"}, "elements": ["0 -2 0 cm"]},
        {"name": "tissue", "mesh": {"type": "block", "size": "4 2 4 cm", "cells": [3, 2, 3]},
         "attachments": [{"box": [[-1, -1, -1], [1, "-9.9 mm", 1]]}, {"nodes": [0], "to": "table"}]}
    ],
    "commands": [
        {"time": "30 ms", "type": "Release", "id": "held"},
        {"time": "10 ms", "type": "SetPressure", "id": "tissue", "pressure": "300 Pa"},
        {"time": "20 ms", "type": "Attach", "id": "held", "body": "tissue", "def": {"box": [[-1, 0, -1], [1, 1, 1]], "to": "table"}},
        {"time": "30 ms", "type": "SetGravity", "gravity": [1, 0, 0]},
        {"time": "35 ms", "type": "Release", "id": "tissue.attachments[1]"},
        {"time": "30 ms", "type": "Release", "id": "held"}
    ]
})";

/// The same in C++.
std::uint64_t pressedInCpp(int steps)
{
    Simulation sim({.physics = {.rate = 1000}});
    const BodyId table = sim.add(RigidBodyDef{
        .name = "table", .elements = {{{0, -0.02, 0}, {}}}, .mesh = geometry::shapes::box({0.09, 0.02, 0.09})});
    const BodyId tissue =
        sim.add(SoftBodyDef{.name = "tissue",
                            .mesh = geometry::shapes::block({0.04, 0.02, 0.04}, {3, 2, 3}),
                            .attachments = {{.box = Box{{-1, -1, -1}, {1, -0.0099, 1}}}, {.nodes = {0}, .to = table}}});
    AttachmentId held;
    sim.everyStep([&](double time) {
        const int step = static_cast<int>(std::lround(time * 1000));
        auto& physics = sim.physics();
        if (step == 10) physics.setPressure(tissue, 300);
        if (step == 20) held = physics.attach(tissue, {.box = Box{{-1, 0, -1}, {1, 1, 1}}, .to = table});
        if (step == 30) {
            physics.release(held);
            physics.setGravity({1, 0, 0});
            physics.release(held);
        }
        if (step == 35) physics.release(physics.attachments(tissue).at(1));
    });
    return sim.run({.headless = true, .steps = steps}).hash;
}

} // namespace

TEST_CASE("scenes: commands are given at their times, with the hash of a program that gives them")
{
    std::string content = kPressed;
    const std::string early = R"({"time": "30 ms", "type": "Release", "id": "held"},
        {"time": "10 ms")";
    CHECK_THROWS_WITH(SceneFolder().load(content),
                      Catch::Contains("commands[0].id must be the id of a command before"));
    content.replace(content.find(early), early.size(), R"({"time": "10 ms")");
    const SceneDef scene = SceneFolder().load(content);
    REQUIRE(scene.commands.size() == 5);
    for (const int steps : {15, 25, 32, 40}) CHECK(runScene(scene, steps).hash == pressedInCpp(steps));

    // A restored state gets the later commands again.
    Simulation sim(simulationDef(scene));
    static_cast<void>(addScene(sim, scene));
    runtime::SteppedRun run(sim);
    std::shared_ptr<const runtime::RunState> state;
    for (int i = 1; i <= 40; ++i) {
        run.step();
        if (i == 19) state = run.save();
    }
    for (int round = 0; round < 2; ++round) {
        run.restore(*state);
        for (int i = 20; i <= 40; ++i) run.step();
        CHECK(sim.physics().hash() == pressedInCpp(40));
    }

    // In another simulation those that led to the state are not given again, and ids mean what they meant.
    for (const int saved : {19, 25}) {
        Simulation other(simulationDef(scene));
        static_cast<void>(addScene(other, scene));
        runtime::SteppedRun there(other);
        there.step();
        run.restore(*state);
        for (int i = 20; i <= saved; ++i) run.step();
        there.restore(*run.save());
        for (int i = saved; i < 40; ++i) there.step();
        CHECK(other.physics().hash() == pressedInCpp(40));
    }
}

TEST_CASE("scenes: a rod is commanded to bend, and stays bent after a reset")
{
    const auto with = [](const std::string& commands) {
        return SceneFolder().load(
            text(R"({"bodies": [{"name": "scope", "type": "RodBodyDef", "radius": "1 mm", "gravity": false,
            "points": ["0 0 0 mm", "100 0 0 mm"], "spacing": "2 mm", "attachments": [{"nodes": [0, 1]}],
            "rayleigh": {"mass": 20}}], "commands": [)",
                 commands, "]}"));
    };
    const auto tip = [&](const SceneDef& scene) {
        Simulation sim(simulationDef(scene));
        const BodyId rod = addScene(sim, scene).bodies.at(0);
        CHECK(sim.run({.headless = true, .steps = 600}).complete());
        return sim.physics().latest()->softBody(rod)->positions.back();
    };
    const std::string bend = R"({"time": "10 ms", "type": "SetCurvature", "id": "scope", "rate": 100,
                                 "sections": [{"begin": "70 mm", "curvature": [0, 20]}]})";
    const Vec3 straight = tip(with("")), bent = tip(with(bend));
    CHECK(std::abs(straight.z) < 1e-9);
    CHECK(bent.z > 0.005);
    CHECK(distance(tip(with(bend + R"(, {"time": "0.1 s", "type": "Reset"})")), bent) < 1e-3);
    CHECK_THROWS_WITH(with(R"({"time": 0, "type": "SetCurvature", "id": "scope", "sections": [{"begin": 0}]})"),
                      Catch::Contains("must have the member 'curvature'"));
    CHECK_THROWS_WITH(
        tip(with(
            R"({"time": 0, "type": "SetCurvature", "id": "scope", "sections": [{"begin": 1, "curvature": [0, 1]}]})")),
        Catch::Contains("commands[0]: rod 'scope': sections[0].begin must be in [0, "));
}

TEST_CASE("scenes: a command that cannot be is refused, or ends the commands and is told")
{
    const auto with = [](const std::string& command) {
        return SceneFolder().load(text(R"({"bodies": [{"name": "a", "mesh": {"type": "block", "size": "1 1 1 cm"}},
            {"name": "r", "type": "RigidBodyDef", "elements": ["0 5 0 m"]}], "commands": [)",
                                       command, "]}"));
    };
    const auto added = [](const SceneDef& scene) {
        Simulation sim;
        static_cast<void>(addScene(sim, scene));
    };
    using Catch::Contains;
    CHECK_THROWS_WITH(with(R"({"time": 0})"), Contains("commands[0] must have the member 'type'"));
    CHECK_THROWS_WITH(with(R"({"time": 0, "type": "Pressure"})"), Contains("commands[0].type must be one of Attach, "));
    CHECK_THROWS_WITH(with(R"({"time": 0, "type": "SetPressure"})"), Contains("must have the member 'id'"));
    CHECK_THROWS_WITH(with(R"({"time": -1, "type": "SetGravity"})"), Contains("commands[0].time must be >= 0 s"));
    CHECK_THROWS_WITH(with(R"({"time": 1, "type": "Grasp", "id": "g", "rigid": "r", "target": "a"},
                              {"time": 0.5, "type": "Release", "id": "g"})"),
                      Contains("commands[1].time must be >= 1 s, when 'g' is made, got 0.5"));
    CHECK_THROWS_WITH(with(R"({"time": 1, "type": "Grasp", "id": "g", "rigid": "r", "target": "a"},
                              {"time": 1, "type": "Grasp", "id": "g", "rigid": "r", "target": "a"})"),
                      Contains("commands[1].id must differ from those of the other attachments"));
    CHECK_THROWS_WITH(added(with(R"({"time": 0, "type": "SetPressure", "id": "r"})")),
                      Contains("commands[0]: needs a soft body, got rigid body 'r'"));
    CHECK_THROWS_WITH(added(with(R"({"time": 0, "type": "SetWrench", "id": "a"})")), Contains("needs a rigid body"));
    // What only the run shows: the program removes the body.
    const SceneDef scene = with(R"({"time": "5 ms", "type": "SetPressure", "id": "a", "pressure": 1})");
    Simulation sim(simulationDef(scene));
    const BodyId a = addScene(sim, scene).bodies.at(0);
    sim.physics().remove(a);
    const RunReport report = sim.run({.headless = true, .steps = 9});
    REQUIRE(report.callbackProblems.size() == 1);
    CHECK_THAT(report.callbackProblems[0], Contains("commands[0]: soft body 'a' (body 1): no such body any more"));
    CHECK(!report.complete());
    CHECK_THAT(summary(report), Contains("a script ended early: "));
}

TEST_CASE("scenes: a scene's own cameras show it, and its lights light it")
{
    if (skipIf(!visual::hasBackend(visual::Backend::Headless), "this build draws nothing")) return;
    const SceneDef scene = loadScene(example("pull"));
    const auto red = [&](const std::function<void(SceneDef&)>& change) {
        SceneDef changed = scene;
        change(changed);
        Simulation sim(simulationDef(changed));
        static_cast<void>(addScene(sim, changed));
        runtime::SteppedRun run(sim);
        run.step();
        const visual::Image picture = run.picture({.width = 96, .height = 72});
        double sum = 0.0;
        for (std::size_t i = 0; i < picture.rgba.size(); i += 4) sum += picture.rgba[i];
        return sum * 4 / static_cast<double>(picture.rgba.size());
    };
    const double whole = red([](SceneDef&) {});
    CHECK(whole > 10.0);
    CHECK(red([](SceneDef& s) { s.lights.clear(); }) < 0.8 * whole);
    CHECK(red([](SceneDef& s) { s.cameras[0].target = Vec3{0, 1, 0}; }) < 1.0);       // looks away
    CHECK(red([](SceneDef& s) { s.cameras[0].pose.position *= 3.0; }) < 0.5 * whole); // is far away
    // The forceps are above the tissue, which a camera that they carry sees from there.
    const auto carried = [](SceneDef& s) {
        s.cameras[0].follow =
            SceneFollow{.def = {.offset = {{0, -0.02, 0}, axisAngle({1, 0, 0}, -90_deg)}}, .body = BodyId{2}};
        s.lights.resize(1);
        s.environment.reset();
    };
    CHECK(red(carried) > 10.0);

    const auto refused = [&](const std::function<void(SceneDef&)>& change) {
        std::string error = "no error";
        try {
            red(change);
        } catch (const Error& problem) {
            error = problem.what();
        }
        return error;
    };
    using Catch::Contains;
    CHECK_THAT(refused([](SceneDef& s) { s.cameras.clear(); }), Contains("lights[0]: give the scene cameras, too"));
    CHECK_THAT(refused([](SceneDef& s) { s.lights[0].on = "frnt"; }),
               Contains("lights[0].on must be the name of a camera of the scene, got 'frnt' (did you mean 'front'?)"));
    CHECK_THAT(refused([](SceneDef& s) { s.views = {{.camera = "x"}}; }), Contains("views[0].camera must be the name"));
    CHECK_THAT(refused([](SceneDef& s) { s.cameras.push_back(s.cameras[0]); }),
               Contains("cameras[1].name must differ"));
    CHECK_THAT(refused([](SceneDef& s) { s.cameras[0].target = s.cameras[0].pose.position; }), Contains("target must"));
    CHECK_THAT(refused([](SceneDef& s) { s.lights[0].follow = SceneFollow{}; }), Contains("lights[0].follow needs an"));
}

TEST_CASE("scenes: a wrong camera, light, view or haptic interface is refused with its place in the file")
{
    const SceneFolder folder;
    const auto errorOf = [&](const std::string& text) {
        const SceneDef scene = folder.load(text);
        Simulation sim(simulationDef(scene));
        try {
            static_cast<void>(addScene(sim, scene));
        } catch (const Error& error) {
            const std::string line = error.what();
            return line.substr(std::min(line.find("scene.json:"), line.size()));
        }
        return std::string("no error");
    };
    using Catch::Contains;
    CHECK_THAT(errorOf("{\"cameras\": [{\"name\": \"a\"},\n{\"name\": \"b\",\n\"on\": \"c\"}]}"),
               Contains("scene.json:3:7: cameras[1].on must be the name of a camera"));
    CHECK_THAT(errorOf("{\"cameras\": [{}],\n\"views\": [{\"camera\": \"x\"}]}"),
               Contains("scene.json:2:22: views[0].camera"));
    CHECK_THAT(errorOf("{\"lights\":\n [{}]}"), Contains("scene.json:2:3: lights[0]: give the scene cameras"));
    CHECK_THAT(errorOf("{\"haptics\": [{\"name\": \"h\"},\n {\"name\": \"h\", \"element\": 3}]}"),
               Contains("scene.json:") && Contains("haptics["));
}

TEST_CASE("scenes: a wrong body is refused with its place")
{
    SceneDef scene;
    scene.bodies = {{.def = RigidBodyDef{.name = "a"}},
                    {.def = RigidBodyDef{.name = "tool", .dynamic = true, .mass = TotalMass{1}},
                     .motions = {{.keys = {{}}}},
                     .places = {{"", "x.json:3:4"}, {"motions[0]", "x.json:4:5"}}}};
    Simulation sim(simulationDef(scene));
    CHECK_THROWS_WITH(
        addScene(sim, scene),
        "x.json:4:5: rigid body 'tool': motions[0] moves a dynamic body, which only forces move; give it a hand");
    const auto refused = [](SceneBody body) {
        Simulation other;
        std::string error = "no error";
        try {
            static_cast<void>(addScene(other, {.bodies = {std::move(body)}}));
        } catch (const Error& problem) {
            error = problem.what();
        }
        return error;
    };
    const RigidBodyDef tool{.name = "tool"};
    using Catch::Contains;
    CHECK_THAT(refused({.def = tool, .motions = {{}}}), Contains("motions[0].keys must not be empty"));
    CHECK_THAT(refused({.def = tool, .motions = {{.keys = {{1.0}, {1.0}}}}}), Contains("must be later than the key"));
    CHECK_THAT(refused({.def = tool, .motions = {{.element = 1, .keys = {{}}}}}), Contains("must be in [0, 1), got 1"));
    CHECK_THAT(refused({.def = tool, .motions = {{.keys = {{}}, .repeat = true}}}), Contains("needs a last key later"));
    CHECK_THAT(refused({.def = tool, .jointMotions = {{}}}),
               Contains("jointMotions[0] needs a body with an articulation"));
    CHECK_THAT(refused({.def = SoftBodyDef{.name = "s"}, .motions = {{}}}), Contains("only rigid bodies have them"));
    CHECK_THAT(refused({.def = tool, .motions = {{.keys = {{}}}, {.keys = {{}}}}}),
               Contains("motions[1] moves what motions[0] moves: number 0"));
    CHECK_THAT(refused({.def = tool, .motions = {{.keys = {{.pose = {{1e308, 0, 0}, {}}}}}}}),
               Contains("motions[0].keys[0].pose: position must lie within"));
    CHECK_THAT(refused({.def = tool, .paint = {{}}}), Contains("paint needs a body that is drawn"));
    Simulation handless;
    CHECK_THROWS_WITH(addScene(handless, {.haptics = {{.element = 3}}}), Contains("haptics[0]: haptic interface"));
    RigidBodyDef tied{.name = "tied", .dynamic = true, .mass = TotalMass{1}};
    tied.attachments = {{.to = BodyId{7}}};
    CHECK_THAT(refused({.def = tied}), Contains("the scene has 0 bodies before this one, got body 7"));
}

} // namespace filasofia::scene
