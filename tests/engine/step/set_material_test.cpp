#include "filasofia/core/log.h"
#include "filasofia/engine/build/build_body.h"
#include "filasofia/engine/native/native.h"
#include "filasofia/physics/physics_server.h"

#include "engine/stage.h"

#include <thread>

namespace set_material_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

SoftBodyDef hangingBox(const SoftMaterial& material = FemMaterial{})
{
    return {.mesh = shared(boxMesh({4, 3, 3}, {0.4, 0.1, 0.1})),
            .material = material,
            .attachments = {{.box = geometry::Box{{0, 0, 0}, {0, 1, 1}}}}};
}

/// A body moving under gravity, with two kinds of material commands: prebuilt, as the server posts them, or plain.
struct TestScene {
    Stage stage;
    SoftBodyDef def;
    BodyId id;

    explicit TestScene(const SoftBodyDef& made, int steps = 20) : def(made), id(stage.add(made))
    {
        stage.post(SetGravity{{0, -9.81, 0}});
        stage.run(steps, 0.005);
    }
    std::unique_ptr<BuiltBody> built(const SoftMaterial& material)
    {
        SoftBodyDef changed = def;
        changed.material = material;
        return stage.world.build(changed);
    }
    void postBuilt(const SoftMaterial& material) { stage.post(SetMaterial{id, material, built(material)}); }
    void postPlain(const SoftMaterial& material) { stage.post(SetMaterial{id, material}); }
    /// Posts a prebuilt material and steps once. Returns true if the step used the prebuilt data.
    bool takes(const SoftMaterial& material)
    {
        postBuilt(material);
        const SoftSystem& system =
            dynamic_cast<BuiltSoftBody&>(*std::get<SetMaterial>(stage.commands[0]).body).body.system;
        const void *fast = system.matrixFree.get(), *exact = system.assembled.get();
        stage.world.step({.dt = 0.005, .commands = stage.commands});
        const bool gone = system.matrixFree.get() != fast || system.assembled.get() != exact;
        stage.commands.clear();
        return gone;
    }
};

void checkSameSteps(TestScene& a, TestScene& b)
{
    for (int i = 0; i < 20; ++i) {
        a.stage.step(0.005);
        b.stage.step(0.005);
        REQUIRE(a.stage.world.hash() == b.stage.world.hash());
    }
}

/// Captures the log during its lifetime instead of printing it.
struct Logged {
    std::string text;
    Logged()
    {
        setLogSink([this](LogLevel, std::string_view line) { text += line; });
    }
    ~Logged() { setLogSink({}); }
};

void makeHeavier(Stage& stage)
{
    stage.post(Tune{[](PhysicsEngine& engine) {
        for (double& mass : static_cast<World&>(engine).scene().soft[0].model.masses) mass *= 3.0;
    }});
}

} // namespace

TEST_CASE("a prebuilt material is bit-identical to one that the step builds, for every solver and integrator")
{
    const SoftMaterial fem = FemMaterial{.youngModulus = 20e3, .poissonRatio = 0.3};
    const SoftMaterial springs = MassSpringMaterial{.stiffness = 30, .damping = 0.02};
    std::vector<std::pair<SoftBodyDef, SoftMaterial>> cases{{hangingBox(), fem},
                                                            {hangingBox(MassSpringMaterial{}), springs}};
    for (const Solver& solver : {Solver{ConjugateGradient{.assembled = true}}, Solver{Cholesky{}}}) {
        cases.emplace_back(hangingBox(), fem);
        cases.back().first.solver = solver;
    }
    cases.emplace_back(hangingBox(), fem);
    cases.back().first.integrator = ExplicitEuler{};
    for (const auto& [def, material] : cases) {
        TestScene before(def), plain(def), other(def);
        CHECK(before.takes(material));
        plain.postPlain(material);
        plain.stage.step(0.005);
        REQUIRE(before.stage.world.hash() == plain.stage.world.hash());
        checkSameSteps(before, plain);
        other.stage.run(21, 0.005);
        CHECK(other.stage.world.hash() != before.stage.world.hash());
    }
}

TEST_CASE("if two materials are posted to one body, the last one counts, whichever was built first")
{
    const FemMaterial soft{.youngModulus = 5e3}, stiff{.youngModulus = 40e3};
    TestScene a(hangingBox()), b(hangingBox());
    std::unique_ptr<BuiltBody> builtSoft = a.built(soft), builtStiff = a.built(stiff);
    a.stage.post(SetMaterial{a.id, stiff, std::move(builtStiff)});
    a.stage.post(SetMaterial{a.id, soft, std::move(builtSoft)});
    b.postPlain(soft);
    checkSameSteps(a, b);
    CHECK(a.stage.model().elements[0].youngModulus == 5e3);
}

TEST_CASE("a material set right after its body was added equals one that the body is built with")
{
    const FemMaterial stiff{.youngModulus = 40e3};
    TestScene a(hangingBox(), 0), b(hangingBox(stiff), 0);
    a.postBuilt(stiff);
    checkSameSteps(a, b);
}

TEST_CASE("a body switches to double if float cannot hold its material, and back")
{
    const Logged logged;
    const FemMaterial extreme{.youngModulus = 1e-300}, usual{.youngModulus = 20e3};
    TestScene before(hangingBox()), plain(hangingBox());
    for (const FemMaterial& material : {extreme, usual}) {
        const bool fits = material.youngModulus > 1e-20;
        const std::unique_ptr<BuiltBody> built = before.built(material);
        CHECK((dynamic_cast<BuiltSoftBody&>(*built).body.system.matrixFree != nullptr) == fits);
        CHECK(before.takes(material));
        plain.postPlain(material);
        plain.stage.step(0.005);
        REQUIRE(before.stage.world.hash() == plain.stage.world.hash());
        checkSameSteps(before, plain);
    }
    CHECK_THAT(logged.text, Catch::Contains("single precision"));
}

TEST_CASE("residual impulse, first guess and rotations stay when the material changes")
{
    TestScene scene(hangingBox());
    const SoftState before = scene.stage.soft();
    scene.postBuilt(FemMaterial{.youngModulus = 20e3});
    scene.stage.step(0.0);
    const SoftState& after = scene.stage.soft();
    for (const auto& list : {&SoftState::x, &SoftState::v, &SoftState::dv, &SoftState::residual}) {
        CHECK(after.*list == before.*list);
        CHECK(after.*list != std::vector<Vec3>(after.x.size()));
    }
    for (std::size_t e = 0; e < scene.stage.model().elements.size(); ++e)
        CHECK(rotationOf(after.rotations, e) == rotationOf(before.rotations, e));
}

TEST_CASE("after a tune the step builds the solver of the tuned model, and a rejected tune changes nothing")
{
    const Logged logged;
    TestScene tuned(hangingBox()), plain(hangingBox()), rejected(hangingBox());
    for (TestScene* scene : {&tuned, &plain}) {
        makeHeavier(scene->stage);
        scene->stage.step(0.005);
    }
    const FemMaterial stiff{.youngModulus = 40e3};
    for (int i = 0; i < 2; ++i) { // permanently
        CHECK_FALSE(tuned.takes(stiff));
        plain.postPlain(stiff);
        plain.stage.step(0.005);
        checkSameSteps(tuned, plain);
    }
    rejected.stage.post(Tune{[](PhysicsEngine&) { fail("no"); }});
    rejected.stage.step(0.005);
    CHECK(rejected.takes(stiff));
}

TEST_CASE("materials set by several threads during steps are replayed from the log with the same steps")
{
    PhysicsServer server(makeNativeEngine({.threads = 1}));
    server.keepLog(true);
    server.hashEveryStep(true);
    const BodyId id = server.add(hangingBox());
    std::vector<std::thread> threads;
    std::atomic<int> left = 3;
    for (int t = 0; t < 3; ++t)
        threads.emplace_back([&server, &left, id, t] {
            for (int i = 0; i < 30; ++i) server.setMaterial(id, FemMaterial{.youngModulus = 1e3 * (1 + i + 40 * t)});
            --left;
        });
    World again({.threads = 1});
    int materials = 0;
    for (bool last = false; !last;) {
        last = left == 0;
        server.step(0.005);
        const StepRecord* record = server.nextRecord();
        REQUIRE(record != nullptr);
        std::vector<Command> commands;
        for (const Command& each : record->commands) {
            if (const auto* add = std::get_if<AddBody>(&each))
                commands.emplace_back(AddBody{add->id, add->def, again.build(*add->def)});
            if (const auto* gravity = std::get_if<SetGravity>(&each)) commands.emplace_back(*gravity);
            if (const auto* set = std::get_if<SetMaterial>(&each)) {
                CHECK(set->body == nullptr);
                commands.emplace_back(SetMaterial{set->id, set->material});
                ++materials;
            }
        }
        again.step({.dt = 0.005, .commands = commands});
        CHECK(again.hash() == record->hash);
        server.popRecord();
    }
    for (std::thread& thread : threads) thread.join();
    CHECK(materials == 90);
}

} // namespace set_material_test
