#include "engine/stage.h"
#include "filasofia/geometry/shapes.h"

#include <map>

namespace save_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

constexpr double kDt = 1e-3; // [s]

TriangleMeshSource bladeMesh()
{
    return std::make_shared<const geometry::TriangleMesh>(
        geometry::TriangleMesh{.vertices = {{0, -0.1, 0}, {0, 0.1, 0}, {0, 0.1, 0.1}, {0, -0.1, 0.1}},
                               .triangles = {{0, 1, 2}, {0, 2, 3}},
                               .uv = {}});
}

/// Bodies of all kinds, with what persists from step to step: a slab that is cut and has relaxing tissue, a strip that
/// tears, tissue that flows, springs, a shell, both solvers in double, rigid bodies in contact, a gripper, attachments.
/// The commands are a function of the step.
struct Busy {
    Stage stage;
    BodyId slab, blade, strip, dough, ball, springs, sheet, assembled, factored, arm, puller;
    AttachmentId hook{100};

    explicit Busy(int threads = 1) : stage({.threads = threads})
    {
        const auto bottom = [](double z) { return AttachmentDef{.box = geometry::Box{{-9, -9, -9}, {9, 9, z}}}; };
        slab = stage.add(
            SoftBodyDef{.name = "slab",
                        .mesh = shared(boxMesh({10, 8, 6}, {0.05, 0.04, 0.03}, 0.2)),
                        .material = FemMaterial{.youngModulus = 5e3, .relaxation = {{.share = 0.5, .time = 0.02}}},
                        .attachments = {bottom(1e-4)},
                        .dynamicTopology = true});
        blade = stage.add(RigidBodyDef{.name = "blade",
                                       .elements = {{{0.0262, 0.02, 0.04}, {}}},
                                       .collision = {{.mesh = bladeMesh(), .proximity = 0, .cutting = true}}});
        strip = stage.add(SoftBodyDef{.name = "strip",
                                      .mesh = shared(boxMesh({6, 2, 2}, {0.06, 0.01, 0.01})),
                                      .pose = {{0.2, 0, 0}, {}},
                                      .material = FemMaterial{.youngModulus = 1e4, .tearingThreshold = 2e3},
                                      .attachments = {{.box = geometry::Box{{-9, -9, -9}, {0.2001, 9, 9}}}},
                                      .dynamicTopology = true});
        puller = stage.add(RigidBodyDef{.name = "puller", .elements = {{{0.26, 0, 0}, {}}}});
        dough = stage.add(SoftBodyDef{.name = "dough",
                                      .mesh = shared(boxMesh({4, 4, 3}, {0.04, 0.04, 0.03})),
                                      .pose = {{0, 0.2, 0}, {}},
                                      .material = FemMaterial{.youngModulus = 5e3, .yieldStress = 300},
                                      .attachments = {bottom(1e-4)},
                                      .collision = {{}}});
        ball = stage.add(RigidBodyDef{.name = "ball",
                                      .elements = {{{0.02, 0.22, 0.0365}, {}}},
                                      .mesh = geometry::shapes::sphere(0.006),
                                      .dynamic = true,
                                      .mass = TotalMass{0.05},
                                      .collision = {{}}});
        springs = stage.add(SoftBodyDef{.name = "springs",
                                        .mesh = shared(boxMesh({2, 2, 2}, {0.02, 0.02, 0.02})),
                                        .pose = {{0, 0.4, 0}, {}},
                                        .material = MassSpringMaterial{.stiffness = 40, .damping = 0.05},
                                        .attachments = {bottom(1e-4)}});
        sheet = stage.add(SoftBodyDef{.name = "sheet",
                                      .mesh = geometry::shapes::sheet(0.04, 0.04, {5, 5}),
                                      .pose = {{0.4, 0.4, 0.1}, {}},
                                      .material = ShellMaterial{},
                                      .attachments = {{.nodes = {0, 5}}}});
        const auto cube = [&](const char* name, double y, const Solver& solver) {
            return stage.add(SoftBodyDef{.name = name,
                                         .mesh = shared(boxMesh({2, 2, 2}, {0.02, 0.02, 0.02}, 0.2)),
                                         .pose = {{0.6, y, 0}, {}},
                                         .solver = solver,
                                         .attachments = {bottom(1e-4)}});
        };
        assembled = cube("assembled", 0.0, ConjugateGradient{.assembled = true});
        factored = cube("factored", 0.1, Cholesky{});
        RigidBodyDef jointed{.name = "arm", .elements = {{{0, 0.6, 0}, {}}}, .mass = Density{1000}};
        jointed.mesh = geometry::shapes::box({0.01, 0.02, 0.01});
        jointed.articulation.joints = {{.parentOffset = {{0, -0.02, 0}, {}}, .childOffset = {{0, 0.02, 0}, {}}}};
        arm = stage.add(jointed);
    }

    /// Gives the commands of this step and makes it; returns the hash.
    std::uint64_t step(int number)
    {
        const double t = number * kDt;
        stage.post(SetPose{blade, 0, {{0.0262 + 0.01 * t, 0.02, 0.04 - 0.6 * t}, {}}});
        if (number == 2)
            stage.post(Attach{{101}, strip, {.box = geometry::Box{{0.2599, -9, -9}, {9, 9, 9}}, .to = puller}});
        stage.post(SetPose{puller, 0, {{0.26 + 0.5 * t, 0, 0}, {}}});
        if (number == 5) stage.post(Attach{hook, springs, {.nodes = {26}, .stiffness = 50}});
        if (number == 45) stage.post(Release{hook});
        if (number == 25) stage.post(SetForces{sheet, {{.node = 35, .force = {0, 0, 0.01}}}});
        if (number == 30) stage.post(SetJoint{arm, 0, JointForce{1e-4}});
        if (number == 40) stage.post(SetTissue{assembled, {.where = Ball{{0.6, 0, 0}, 1.0}, .youngModulus = 2e4}});
        stage.step(kDt);
        return stage.world.hash();
    }
};

constexpr int kSteps = 80;

} // namespace

TEST_CASE("a saved state goes on with the bits of the run that it was saved in")
{
    std::vector<std::uint64_t> hashes;
    Busy straight;
    for (int i = 0; i < kSteps; ++i) hashes.push_back(straight.step(i));
    CHECK(straight.stage.world.scene().soft[0].topology.revision > 3); // it was cut
    CHECK(straight.stage.world.scene().soft[1].topology.revision > 0); // it has torn

    std::map<int, std::shared_ptr<const EngineState>> saved;
    Busy busy;
    for (int i = 0; i < kSteps; ++i) {
        if (i == 1 || i % 7 == 0) saved[i] = i == 0 ? nullptr : busy.stage.world.save();
        CHECK(busy.step(i) == hashes[static_cast<std::size_t>(i)]); // saving changes nothing
    }
    saved.erase(0);
    for (const auto& [from, state] : saved) {
        INFO("saved before step " << from);
        busy.stage.world.restore(*state);
        int wrong = -1;
        for (int i = from; i < kSteps; ++i)
            if (busy.step(i) != hashes[static_cast<std::size_t>(i)] && wrong < 0) wrong = i;
        CHECK(wrong == -1);
    }
}

TEST_CASE("a saved state goes on in another engine with the same bodies, on any number of threads")
{
    Busy first;
    for (int i = 0; i < 50; ++i) first.step(i);
    const auto state = first.stage.world.save();
    std::vector<std::uint64_t> hashes;
    for (int i = 50; i < kSteps; ++i) hashes.push_back(first.step(i));
    Busy other(3);
    other.step(0);
    other.stage.world.restore(*state);
    for (int i = 50; i < kSteps; ++i) CHECK(other.step(i) == hashes[static_cast<std::size_t>(i - 50)]);
}

TEST_CASE("a state of another kind or of steps of another length is refused")
{
    struct Other final : EngineState {};
    Stage stage;
    CHECK_THROWS_WITH(stage.world.restore(Other{}), "restore: the state is one of another engine");
    Stage slower({.period = 2e-3, .threads = 1});
    CHECK_THROWS_WITH(stage.world.restore(*slower.world.save()),
                      Catch::Contains("steps of 0.002 s, but here they take 0.001 s"));
}

} // namespace save_test
