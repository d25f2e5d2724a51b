#include "filasofia/filasofia.h"
#include "filasofia/record/recording.h"
#include "filasofia/runtime/stepped_run.h"
#include "filasofia/scene/scene_file.h"
#include "scene_folder.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <sstream>

namespace filasofia::scene {
namespace {

using Catch::Matchers::Contains;

std::vector<std::uint64_t> hashesOf(const SceneDef& scene, std::size_t steps)
{
    Simulation sim(simulationDef(scene));
    static_cast<void>(addScene(sim, scene));
    runtime::SteppedRun run(sim);
    std::vector<std::uint64_t> hashes;
    for (std::size_t i = 0; i < steps; ++i) {
        run.step();
        hashes.push_back(sim.physics().hash());
    }
    return hashes;
}

std::string contentOf(const std::string& file)
{
    std::ostringstream out;
    out << std::ifstream(file).rdbuf();
    return out.str();
}

std::shared_ptr<const geometry::TriangleMesh> boxOf(double edge) { return geometry::shapes::box({edge, edge, edge}); }

/// A program with bodies of every kind, and commands of every kind between its steps.
struct Program {
    Simulation sim{{.physics = {.rate = 500.0, .gravity = {0.1, -9.0, 0.0}}}};
    BodyId liver = sim.add(SoftBodyDef{
        .name = "liver",
        .mesh = geometry::shapes::block({0.04, 0.02, 0.03}, {4, 2, 3}),
        .material = FemMaterial{.youngModulus = 1e4 / 3.0, .poissonRatio = 0.45},
        .attachments = {{.box = Box{{-1, -1, -1}, {1, -0.0099, 1}}}},
        .collision = {{.selfOnceCut = true}},
        .dynamicTopology = true,
    });
    BodyId sheet = sim.add(SoftBodyDef{.name = "sheet",
                                       .mesh = geometry::shapes::sheet(0.02, 0.02, {4, 4}),
                                       .pose = {{0.0, 0.012, 0.0}, axisAngle({0, 1, 0}, 0.3)},
                                       .material = physics::ShellMaterial{},
                                       .collision = {{}}});
    BodyId tool = sim.add(
        RigidBodyDef{.name = "tool", .elements = {Pose{{0.0, 0.03, 0.0}}}, .mesh = boxOf(0.01), .collision = {{}}});
    BodyId stone = sim.add(RigidBodyDef{.name = "stone",
                                        .elements = {Pose{{0.1, 0.0, 0.0}, {2.0, 0.0, 0.1, 0.0}}},
                                        .mesh = boxOf(0.01 / 3.0),
                                        .dynamic = true,
                                        .angularVelocity = {0.3, 0.1, 0.7}});
    BodyId arm = [this] {
        RigidBodyDef def{.name = "arm", .elements = {Pose{{0.0, 0.2, 0.0}}}, .mesh = boxOf(0.01)};
        def.articulation.joints = {{.child = 1, .speed = 10.0}};
        return sim.add(std::move(def));
    }();
    AttachmentId grip = {};

    Program()
    {
        sim.show(liver, {.subdivision = 1, .material = visual::TissueMaterial{.vessels = 0.25}});
        sim.show(tool, {.surface = geometry::shapes::sphere(0.004), .material = visual::MetalMaterial{}});
        sim.paint(liver, {.place = {0.0, 0.01, 0.0}, .radius = 0.004, .state = {.burn = 0.5}});
        sim.everyStep([this](double time) { act(time); });
    }

private:
    void act(double time)
    {
        physics::PhysicsServer& physics = sim.physics();
        const int step = static_cast<int>(std::lround(time * 500.0));
        if (step >= 5 && step < 25) // from its start on it stays, then it moves and turns, then it stays again
            physics.setPose(tool, {{0.0, 0.03 - 2e-4 * (step - 5) * std::sqrt(2.0), 0.001 * std::sin(time)},
                                   {std::cos(time), 0.0, std::sin(time), 0.1}});
        if (step == 40) physics.setPose(tool, {{0.0, 0.024, 0.0}}); // it jumps
        if (step % 7 == 3) physics.setJoint(arm, 0, filasofia::physics::JointPosition{0.1 * step});
        if (step == 30) grip = physics.grasp(tool, liver, {});
        if (step == 34) physics.setPressure(liver, 300.0 / 7.0);
        if (step == 36) physics.setMaterial(liver, FemMaterial{.youngModulus = 7e3, .poissonRatio = 0.4});
        if (step == 38) physics.setForces(liver, {{3, {0.01, 0.0, 1e-3}}});
        if (step == 42) physics.release(grip);
        if (step == 44) physics.setGravity({0.0, -5.0, 1.0});
        if (step == 46) physics.setPose(stone, {{0.0, 0.1, 0.0}});
        if (step == 48) physics.setWrench(stone, {1e-4, 0.0, 0.0}, {0.0, 1e-7, 0.0});
        if (step == 50) physics.attach(sheet, {.nodes = {0, 1}, .to = tool});
        if (step == 55) sim.reset();
        if (step == 60) physics.release(physics.attachments(liver).front()); // one that its Def made
    }
};

} // namespace

TEST_CASE("save: what a program did becomes a scene file with the same hash after every step")
{
    const SceneFolder folder;
    const std::string recording = folder.file("program.rec"), file = folder.file("saved/liver.json");
    Program program;
    program.sim.run({.headless = true, .steps = 80, .record = recording});

    const RecordedScene made = sceneOf(recording);
    CHECK(made.notes.empty());
    REQUIRE(made.hashes.size() == 80);
    std::filesystem::create_directories(std::filesystem::path(file).parent_path());
    saveScene(made.scene, file);
    const SceneDef scene = loadScene(file);
    const std::vector<std::uint64_t> hashes = hashesOf(scene, 80);
    CHECK(std::ranges::mismatch(hashes, made.hashes).in1 - hashes.begin() == 80);
    CHECK(scene.physics.rate == 500.0);
    CHECK(scene.physics.gravity == Vec3{0.1, -9.0, 0.0});
    CHECK(scene.bodies.at(0).show.at(0).subdivision == 1);
    CHECK(std::get<visual::TissueMaterial>(scene.bodies[0].show[0].material.value()).vessels == 0.25);
    CHECK(scene.bodies.at(0).paint.at(0).state.burn == 0.5);
    CHECK(scene.bodies.at(2).motions.at(0).keys.size() > 20);
    const auto collisionOf = [&](std::size_t i) {
        return std::get<SoftBodyDef>(scene.bodies.at(i).def).collision.at(0);
    };
    CHECK(collisionOf(0).selfOnceCut == true); // said, though the engine does so without it
    CHECK_FALSE(collisionOf(1).selfOnceCut.has_value());
    CHECK(std::filesystem::exists(folder.file("saved/liver_files/liver.msh")));
    CHECK_THAT(contentOf(file), Contains("\"youngModulus\": 3333.333333333333"));
    CHECK_THAT(contentOf(file), !Contains("friction")); // defaults are left out

    saveScene(scene, folder.file("saved/again.json")); // its meshes are in this folder now
    CHECK(hashesOf(loadScene(folder.file("saved/again.json")), 80) == made.hashes);
    CHECK_FALSE(std::filesystem::exists(folder.file("saved/again_files")));
}

TEST_CASE("save: a scene file without include, defaults and classes has the same states, also in another folder")
{
    const SceneFolder folder;
    for (const char* name : {"bunny", "poke", "friction", "jaws", "cut", "pull", "shell", "peritoneum", "dissection"}) {
        CAPTURE(name);
        const SceneDef scene = loadScene(text(FILASOFIA_SOURCE_DIR, "/examples/scenes/", name, ".json"));
        const std::string file = folder.file(text(name, ".json"));
        saveScene(scene, file);
        CHECK_THAT(contentOf(file), !Contains("defaults"));
        const SceneDef again = loadScene(file);
        CHECK(again.cameras.size() == scene.cameras.size());
        CHECK(again.look.direction == scene.look.direction);
        CHECK(hashesOf(again, 30) == hashesOf(scene, 30));
    }
}

TEST_CASE("save: no file in the folder of meshes is overwritten unknowingly, and then nothing is written")
{
    const SceneFolder folder;
    SceneDef scene;
    for (const char* name : {"a", "b"})
        scene.bodies.push_back({.def = RigidBodyDef{.name = name, .mesh = boxOf(0.01)}});
    const std::string kept = folder.write("box_files/b.vtk", "somebody's work"), file = folder.file("box.json");
    CHECK_THROWS_WITH(saveScene(scene, file), kept + ": is there already (--force replaces it)");
    CHECK(contentOf(kept) == "somebody's work");
    CHECK_FALSE(std::filesystem::exists(file));
    CHECK_FALSE(std::filesystem::exists(folder.file("box_files/a.vtk")));
    saveScene(scene, file, {.overwrite = true});
    CHECK_THAT(contentOf(kept), Contains("vtk"));
    CHECK(loadScene(file).bodies.size() == 2);

    std::get<RigidBodyDef>(scene.bodies[1].def).friction = std::nan("");
    CHECK_THROWS_WITH(saveScene(scene, folder.file("nan.json")), "a scene file cannot hold NaN");
    CHECK_FALSE(std::filesystem::exists(folder.file("nan_files")));
}

TEST_CASE("save: a recording that names what is not there is refused")
{
    const SceneFolder folder;
    const auto errorOf = [&](const physics::Command& last) {
        const std::string file = folder.file("hostile.rec");
        std::vector<physics::Command> commands;
        const auto def = std::make_shared<const physics::BodyDef>(RigidBodyDef{.name = "a"});
        commands.emplace_back(physics::AddBody{.id = BodyId{1}, .def = def});
        if (const auto* add = std::get_if<physics::AddBody>(&last))
            commands.emplace_back(physics::AddBody{.id = add->id, .def = def});
        else
            commands.emplace_back(std::get<physics::SetPose>(last));
        physics::StepRecord step;
        step.report.step = 1;
        step.report.dt = step.report.time = 1e-3;
        step.commands = std::move(commands);
        record::RecordingWriter writer(file, {});
        writer.write(step);
        writer.close();
        try {
            sceneOf(file);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string("no error");
    };
    CHECK_THAT(errorOf(physics::AddBody{.id = {}}), Contains("AddBody: id must be in [1, 1000000], got 0"));
    CHECK_THAT(errorOf(physics::AddBody{.id = BodyId{4294967295u}}), Contains("AddBody: id must be in"));
    CHECK_THAT(errorOf(physics::SetPose{BodyId{1}, 7, {}}), Contains("SetPose: element must be in [0, 1), got 7"));
    CHECK(errorOf(physics::SetPose{BodyId{}, 0, {}}) == "no error"); // it is told in a note
}

TEST_CASE("save: what a scene cannot hold is told, and what is no recording is refused")
{
    const SceneFolder folder;
    const std::string recording = folder.file("late.rec");
    Simulation sim({.physics = {.rate = 500.0}});
    const BodyId first = sim.add(RigidBodyDef{.name = "tool", .mesh = boxOf(0.01)});
    sim.add(RigidBodyDef{.name = "tool", .mesh = boxOf(0.01)});
    sim.show(first);
    int step = 0;
    BodyId late = {};
    sim.everyStep([&](double) {
        if (++step == 5) late = sim.add(RigidBodyDef{.name = "late", .mesh = boxOf(0.02), .dynamic = true});
        if (step == 7) sim.physics().setWrench(late, {1.0, 0.0, 0.0}, {});
        if (step == 8) sim.show(late);
        if (step == 9) sim.paint(first, {});
    });
    sim.dress([](visual::VisualServer&) {});
    sim.run({.headless = true, .steps = 10, .record = recording});
    const RecordedScene made = sceneOf(recording);
    std::string notes;
    for (const std::string& each : made.notes) notes += each + '\n';
    CHECK(made.scene.bodies.size() == 2);
    CHECK_THAT(notes, Contains("a second body 'tool' is called 'tool 2'\n"));
    CHECK_THAT(notes, Contains("rigid body 'late', added at 0.01 s, is left out\n"));
    CHECK_THAT(notes, Contains("SetWrench at 0.014 s is left out: it names what is not in the scene\n"));
    CHECK_THAT(notes, Contains("what was shown during the run is left out\n"));
    CHECK_THAT(notes, Contains("paint of the run is left out\n"));
    CHECK_THAT(notes, Contains("the session made its own lights and cameras and drew no picture"));

    const auto errorOf = [](auto&& act) {
        try {
            act();
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string("no error");
    };
    CHECK_THAT(errorOf([&] { sceneOf(folder.file("none.rec")); }), Contains("none.rec"));
    CHECK_THAT(errorOf([&] { sceneOf(folder.write("text.rec", "{}")); }), Contains("text.rec"));
    CHECK_THAT(errorOf([&] { saveScene(made.scene, folder.file("scene.txt")); }),
               Contains("must end in .json") || Contains("ends in .json"));
    CHECK_THAT(errorOf([&] { saveScene(made.scene, folder.file("no/folder/scene.json")); }), Contains("no/folder"));
}

} // namespace filasofia::scene
