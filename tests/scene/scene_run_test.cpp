#include "filasofia/filasofia.h"
#include "filasofia/scene/scene_file.h"

#include <catch2/catch.hpp>

namespace filasofia::scene {
namespace {

std::string example(const std::string& name) { return text(FILASOFIA_SOURCE_DIR, "/examples/scenes/", name, ".json"); }

RunReport runScene(const SceneDef& scene, int steps)
{
    Simulation sim(simulationDef(scene));
    addScene(sim, scene);
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

TEST_CASE("scenes: friction, a grasp and a poke come out as they do in C++")
{
    const SceneDef friction = loadScene(example("friction"));
    Simulation slope(simulationDef(friction));
    const std::vector<BodyId> boxes = addScene(slope, friction);
    slope.run({.headless = true, .steps = 500});
    const auto frame = slope.physics().latest();
    const auto moved = [&](std::size_t i) { return frame->rigidBody(boxes[i])->poses[0].position.x + 0.08; };
    CHECK(std::abs(moved(1)) < 1e-4);
    CHECK(moved(2) == Approx(0.5 * 9.81 * (std::sin(20_deg) - 0.3 * std::cos(20_deg)) * 0.25).epsilon(0.1));

    const SceneDef jaws = loadScene(example("jaws"));
    Simulation gripper(simulationDef(jaws));
    const std::vector<BodyId> ids = addScene(gripper, jaws);
    gripper.run({.headless = true, .steps = 1500});
    const auto last = gripper.physics().latest();
    const auto lowest = std::ranges::min(last->softBody(ids[0])->positions, {}, &Vec3::y);
    CHECK(lowest.y > 25_mm);
    CHECK(lowest.y < 31_mm);

    const SceneDef poke = loadScene(example("poke"));
    Simulation block(simulationDef(poke));
    const std::vector<BodyId> bodies = addScene(block, poke);
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

TEST_CASE("scenes: commands of joints are given when their time comes, again in every round")
{
    SceneDef scene{.physics = {.rate = 100.0}};
    RigidBodyDef arm{.name = "arm"};
    arm.articulation.joints = {{.start = 0.0, .speed = 100.0}};
    scene.bodies = {{.def = arm,
                     .jointMotions = {{.keys = {{0.1, physics::JointPosition{0.5}}, {0.2, physics::JointPosition{0.2}}},
                                       .repeat = true}}}};
    Simulation sim(simulationDef(scene));
    const BodyId id = addScene(sim, scene).at(0);
    const auto positionAfter = [&](int steps) {
        sim.run({.headless = true, .steps = steps});
        return sim.physics().latest()->rigidBody(id)->joints.at(0).position;
    };
    CHECK(positionAfter(8) == 0.0);
    CHECK(positionAfter(8) == Approx(0.5)); // 0.16 s
    CHECK(positionAfter(8) == Approx(0.2)); // 0.24 s
    CHECK(positionAfter(8) == Approx(0.5)); // 0.32 s
}

TEST_CASE("scenes: a wrong body is refused with its place")
{
    SceneDef scene;
    scene.bodies = {{.def = RigidBodyDef{.name = "a"}},
                    {.def = RigidBodyDef{.name = "tool", .dynamic = true, .mass = TotalMass{1}},
                     .motions = {{.keys = {{}}}},
                     .places = {{"", "x.json:3:4"}, {"motions[0]", "x.json:4:5"}}}};
    Simulation sim(simulationDef(scene));
    CHECK_THROWS_WITH(addScene(sim, scene),
                      "x.json:4:5: rigid body 'tool': motions[0] moves a dynamic body, which only forces move");
    const auto refused = [](SceneBody body) {
        Simulation other;
        std::string error = "no error";
        try {
            addScene(other, {.bodies = {std::move(body)}});
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
