#include "filasofia/engine/step/apply_commands.h"

#include "engine/stage.h"

namespace apply_commands_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

SoftBodyDef hangingBox()
{
    return {.mesh = shared(boxMesh({3, 2, 2}, {0.3, 0.1, 0.1})),
            .attachments = {{.box = geometry::Box{{0, 0, 0}, {0, 1, 1}}}}};
}

Stage hanging()
{
    Stage stage;
    stage.add(hangingBox());
    stage.post(SetGravity{{0, -9.81, 0}});
    return stage;
}

} // namespace

TEST_CASE("a command takes effect in the step that it is given to")
{
    Stage a = hanging(), b = hanging();
    a.run(10, 0.01);
    b.run(10, 0.01);
    CHECK(a.world.hash() == b.world.hash());
    b.post(SetMaterial{BodyId{1}, FemMaterial{.youngModulus = 50e3}});
    a.step(0.01);
    b.step(0.01);
    CHECK(a.soft().x != b.soft().x);
    for (const FemElement& element : b.model().elements) CHECK(element.youngModulus == 50e3);
}

TEST_CASE("a material set by command equals one that a body is built with")
{
    Stage a, b;
    SoftBodyDef def = hangingBox();
    def.material = FemMaterial{.youngModulus = 5e3, .poissonRatio = 0.3};
    a.add(def);
    b.add(hangingBox());
    b.post(SetMaterial{BodyId{1}, def.material});
    for (Stage* stage : {&a, &b}) {
        stage->post(SetGravity{{0, -9.81, 0}});
        stage->run(20, 0.01);
    }
    CHECK(a.world.hash() == b.world.hash());
}

TEST_CASE("spring stiffness and damping follow a material command")
{
    Stage stage;
    SoftBodyDef def = hangingBox();
    def.material = MassSpringMaterial{};
    stage.add(def);
    stage.post(SetMaterial{BodyId{1}, MassSpringMaterial{.stiffness = 7, .damping = 2}});
    stage.step(0.01);
    for (const Spring& spring : stage.model().springs) CHECK((spring.stiffness == 7 && spring.damping == 2));
}

TEST_CASE("forces are replaced, pressure and gravity are set")
{
    Stage stage;
    SoftBodyDef def = hangingBox();
    def.forces = {{1, {9, 9, 9}}};
    stage.add(def);
    stage.post(SetForces{BodyId{1}, {{2, {1, 0, 0}}, {2, {0, 1, 0}}}});
    stage.post(SetPressure{BodyId{1}, 12});
    stage.post(SetGravity{{3, 0, 0}});
    stage.step(0.0);
    CHECK(stage.soft().forces[1] == Vec3{});
    CHECK(stage.soft().forces[2] == Vec3{1, 1, 0});
    CHECK(stage.soft().pressure == 12);
    CHECK(stage.world.scene().gravity == Vec3{3, 0, 0});
}

TEST_CASE("reset restores every body's start, and the same trajectory follows bit by bit")
{
    Stage stage = hanging();
    stage.add(RigidBodyDef{.elements = {{{1, 2, 3}, {}}}});
    std::vector<std::vector<Vec3>> first;
    for (int i = 0; i < 30; ++i) {
        stage.step(0.01);
        first.push_back(stage.soft().x);
    }
    stage.post(SetPose{BodyId{2}, 0, {{7, 7, 7}, {}}});
    stage.step(0.01);
    stage.post(Reset{});
    stage.step(0.0);
    CHECK(stage.soft().x == stage.model().rest);
    CHECK(stage.soft().v == std::vector<Vec3>(stage.soft().v.size()));
    CHECK(stage.world.scene().rigid[0].state.poses[0].position == Vec3{1, 2, 3});
    CHECK(stage.world.scene().step == 31); // the step counter continues
    for (int i = 0; i < 30; ++i) {
        stage.step(0.01);
        REQUIRE(stage.soft().x == first[i]);
    }
}

TEST_CASE("reset keeps forces, pressure and material that were set")
{
    Stage stage = hanging();
    stage.post(SetForces{BodyId{1}, {{2, {1, 0, 0}}}});
    stage.post(SetPressure{BodyId{1}, 12});
    stage.post(SetMaterial{BodyId{1}, FemMaterial{.youngModulus = 50e3}});
    stage.step(0.01);
    stage.post(Reset{});
    stage.step(0.0);
    CHECK(stage.soft().forces[2] == Vec3{1, 0, 0});
    CHECK(stage.soft().pressure == 12);
    CHECK(stage.model().elements[0].youngModulus == 50e3);
}

TEST_CASE("removing a body in the middle leaves the others bit-identical")
{
    const auto build = [](Stage& stage) {
        SoftBodyDef def = hangingBox();
        stage.add(def);
        stage.add(RigidBodyDef{.elements = {{{1, 0, 0}, {}}}});
        def.material = FemMaterial{.youngModulus = 3e3};
        stage.add(def);
        stage.add(RigidBodyDef{.elements = {{{4, 0, 0}, {}}}});
        def.material = MassSpringMaterial{};
        stage.add(def);
        stage.post(SetGravity{{0, -9.81, 0}});
        stage.run(10, 0.01);
    };
    Stage all, fewer;
    build(all);
    build(fewer);
    fewer.post(RemoveBody{BodyId{3}});
    fewer.post(RemoveBody{BodyId{2}});
    all.run(10, 0.01);
    const StepReport report = fewer.run(10, 0.01);
    REQUIRE(fewer.world.scene().soft.size() == 2);
    REQUIRE(fewer.world.scene().rigid.size() == 1);
    CHECK(fewer.soft(0).x == all.soft(0).x);
    CHECK(fewer.soft(1).x == all.soft(2).x);
    REQUIRE(report.solves.size() == 2);
    CHECK(report.solves[0].body == BodyId{1});
    CHECK(report.solves[1].body == BodyId{5});

    fewer.post(SetPressure{BodyId{5}, 9}); // ids still find their bodies
    fewer.post(SetPose{BodyId{4}, 0, {{8, 0, 0}, {}}});
    fewer.step(0.01);
    CHECK(fewer.soft(1).pressure == 9);
    CHECK(fewer.soft(0).pressure == 0);
    CHECK(fewer.world.scene().rigid[0].state.poses[0].position == Vec3{8, 0, 0});
}

TEST_CASE("a body added and removed between two steps has no effect")
{
    Stage a = hanging(), b = hanging();
    b.add(hangingBox());
    b.post(RemoveBody{BodyId{2}});
    a.run(5, 0.01);
    b.run(5, 0.01);
    CHECK(a.world.hash() == b.world.hash());
}

TEST_CASE("however many commands change a body in a step, its solver is rebuilt once, after the last")
{
    SoftBodyDef def = hangingBox();
    def.attachments = {};
    for (int node = 0; node < 10; ++node) def.attachments.push_back({.nodes = {node}, .stiffness = 10.0});
    World world{{.threads = 1}};
    Scene scene;
    StepReport report;
    WorkerPool pool(1);
    const ContactMethod method = ExactContact{};
    const StepContext context{1e-3, nullptr, method, pool, report};
    std::vector<Command> commands;
    const auto post = [&](auto command) {
        commands.emplace_back(std::in_place_type<decltype(command)>, std::move(command));
    };
    post(AddBody{{1}, std::make_shared<const BodyDef>(def), world.build(def), {1}});
    applyCommands(context, commands, world, scene);
    const SoftSystem& system = scene.soft[0].system;
    CHECK_FALSE(system.outdated); // built with its body

    const auto* before = system.matrixFree.get();
    commands.clear();
    for (std::uint32_t id = 1; id <= 10; ++id) post(Release{{id}});
    post(SetMaterial{{1}, FemMaterial{.youngModulus = 50e3}, nullptr});
    applyCommands(context, commands, world, scene);
    CHECK(scene.soft[0].model.pins.springs.empty());
    CHECK(system.matrixFree.get() == before);
    CHECK((system.outdated && system.tuned));
    rebuildSystems(1e-3, scene);
    CHECK(system.matrixFree.get() != before);
    CHECK((!system.outdated && system.tuned));
    before = system.matrixFree.get();
    rebuildSystems(1e-3, scene);
    CHECK(system.matrixFree.get() == before);
}

} // namespace apply_commands_test
