#include "filasofia/engine/body/usable.h"
#include "filasofia/engine/build/build_body.h"
#include "filasofia/engine/step/assemble.h"
#include "filasofia/math/polar.h"

#include "effort.h"
#include "engine/soft/hanging_bunny.h"

#include <iostream>

namespace matrix_free_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

/// A box pinned at its low end along x that bends under its weight.
SoftBodyDef pinnedBox(geometry::TetMesh mesh)
{
    return {.mesh = shared(std::move(mesh)), .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1e-6, 1, 1}}}}};
}

/// Distance, after some steps, between the default solver at a tight tolerance and Cholesky, relative to the
/// displacement.
double distanceToCholesky(SoftBodyDef def, double dt, int steps, NativeEngineDef engine = {.threads = 1})
{
    Stage fast(engine), exact(engine);
    def.solver = ConjugateGradient{.maxIterations = 2000, .tolerance = 1e-6};
    fast.add(def);
    def.solver = Cholesky{};
    exact.add(def);
    for (Stage* stage : {&fast, &exact}) {
        stage->post(SetGravity{{0, -9.81, 0}});
        CHECK(stage->run(steps, dt).flags == 0);
    }
    return relativeDistance(fast.soft().x, exact.soft().x, relativeDistance(exact.soft().x, exact.model().rest, 1.0));
}

double iterationsOf(Stage& stage, int steps, double dt)
{
    int sum = 0;
    for (int i = 0; i < steps; ++i) sum += stage.step(dt).solves[0].iterations;
    return static_cast<double>(sum) / steps;
}

} // namespace

TEST_CASE("the default solver matches Cholesky's steps for every body")
{
    CHECK(distanceToCholesky(pinnedBox(boxMesh({12, 3, 3}, {0.4, 0.1, 0.1}, 0.2)), 0.005, 40) < 1e-5);
    SECTION("a thin sheet")
    {
        CHECK(distanceToCholesky(pinnedBox(boxMesh({20, 20, 1}, {0.1, 0.1, 0.002})), 0.002, 20) < 1e-4);
    }
    SECTION("two pieces that do not touch")
    {
        CHECK(distanceToCholesky(pinnedBox(twice(boxMesh({6, 2, 2}, {0.3, 0.05, 0.05}), {0, 0, 0.0501})), 0.005, 40) <
              1e-5);
    }
    SECTION("one element")
    {
        SoftBodyDef def{.mesh = shared(tetrahedronMesh()), .attachments = {{.nodes = {0, 1, 2}}}};
        CHECK(distanceToCholesky(def, 0.005, 40) < 1e-5);
    }
    SECTION("pinned by springs")
    {
        SoftBodyDef def{.mesh = shared(boxMesh({4, 4, 4}, {0.1, 0.1, 0.1})),
                        .attachments = {{.nodes = {0, 3, 7, 11}, .stiffness = 50.0}}};
        CHECK(distanceToCholesky(def, 0.005, 40) < 1e-5);
    }
    SECTION("springs and dashpots")
    {
        SoftBodyDef def = pinnedBox(boxMesh({6, 3, 3}, {0.2, 0.1, 0.1}));
        def.material = MassSpringMaterial{.stiffness = 80.0, .damping = 0.2};
        CHECK(distanceToCholesky(def, 0.005, 40) < 1e-5);
    }
    SECTION("nearly incompressible and stiff")
    {
        SoftBodyDef def = pinnedBox(boxMesh({12, 3, 3}, {0.4, 0.1, 0.1}, 0.2));
        def.material = FemMaterial{1e6, 0.49};
        CHECK(distanceToCholesky(def, 0.005, 40) < 1e-4);
    }
    SECTION("nearly incompressible, soft")
    {
        SoftBodyDef def = pinnedBox(boxMesh({12, 3, 3}, {0.4, 0.1, 0.1}, 0.2));
        def.material = FemMaterial{1e4, 0.4999};
        CHECK(distanceToCholesky(def, 0.005, 40) < 1e-4);
    }
    SECTION("nearly incompressible in one half")
    {
        SoftBodyDef def = pinnedBox(boxMesh({12, 3, 3}, {0.4, 0.1, 0.1}, 0.2));
        def.material =
            FemMaterial{.youngModulus = 2e4,
                        .poissonRatio = 0.3,
                        .regions = {{.where = geometry::Box{{0.2, -1, -1}, {1, 1, 1}}, .poissonRatio = 0.495}}};
        CHECK(distanceToCholesky(def, 0.005, 40) < 1e-4);
    }
    SECTION("far from the origin")
    {
        SoftBodyDef def = pinnedBox(boxMesh({12, 3, 3}, {0.4, 0.1, 0.1}, 0.2));
        def.attachments = {{.nodes = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15}}};
        def.pose.position = {900, -900, 900};
        CHECK(distanceToCholesky(def, 0.005, 40) < 1e-5);
    }
}

TEST_CASE("a step whose right-hand side was kept is solved again with the same result")
{
    Stage stage;
    stage.add(pinnedBox(boxMesh({12, 3, 3}, {0.4, 0.1, 0.1}, 0.2)));
    stage.post(SetGravity{{0, -9.81, 0}});
    stage.run(100, 1e-3); // so that the last step hands a residual on
    SoftBody& body = stage.world.scene().soft[0];
    WorkerPool pool(1);
    assembleBody({{0, -9.81, 0}, 1e-3, 1.0}, body, pool);
    MatrixFreeSystem& system = *body.system.matrixFree;
    const auto solved = [&] {
        std::vector<Vec3> dv(body.state.x.size()), residual = dv;
        system.solve({.tolerance = 1e-3, .maxIterations = 100}, 0, dv, residual, pool);
        dv.insert(dv.end(), residual.begin(), residual.end());
        return dv;
    };
    system.keepImpulses();
    const std::vector<Vec3> once = solved(), usedUp = solved();
    system.restoreImpulses();
    CHECK(solved() == once);
    CHECK(usedUp != once);
}

TEST_CASE("after a slow step, the smoother is that of the present tangents: fewer iterations, the same solution")
{
    for (const ElasticLaw& law : {ElasticLaw(NeoHookean{}), ElasticLaw(MooneyRivlin{})}) {
        Stage stage = hangingBunny(3004, FemMaterial{.youngModulus = 5e3, .poissonRatio = 0.45, .law = law}, 5e-3);
        const Vec3 gravity{0, -9.81, 0};
        stage.run(60, 5e-3);
        SoftBody& body = stage.world.scene().soft[0];
        CHECK(body.state.iterations > 0);
        WorkerPool pool(1);
        const auto solved = [&](int iterations, double tolerance) {
            assembleBody({gravity, 5e-3, 1.0}, body, pool);
            std::vector<Vec3> dv(body.state.x.size()), residual = dv;
            const int made =
                body.system.matrixFree
                    ->solve({.tolerance = tolerance, .maxIterations = 1000}, iterations, dv, residual, pool)
                    .iterations;
            return std::pair{made, dv};
        };
        const int before = solved(0, 5e-3).first, after = solved(100, 5e-3).first;
        INFO(nameOf(law) << ": " << before << " and " << after << " iterations");
        CHECK(after < 0.9 * before);
        const std::vector<Vec3> rest = solved(0, 1e-6).second, present = solved(100, 1e-6).second;
        CHECK(relativeDistance(present, rest, length(rest[0])) < 1e-4);
    }
}

TEST_CASE("a material that varies a thousandfold between elements is solved within the limit of iterations")
{
    Stage stage = hangingBunny(1492);
    stage.step(0.0);
    std::mt19937 random(3);
    stage.post(Tune{[&](PhysicsEngine& engine) {
        for (FemElement& e : static_cast<World&>(engine).scene().soft[0].model.elements)
            e.youngModulus = 1e4 * std::pow(1000.0, random() % 2);
    }});
    CHECK_FALSE(stage.run(50, 0.001).has(StepFlag::NotConverged));
}

TEST_CASE("a body of few nodes has room for a coarse node per node, and a larger one has fewer coarse nodes than nodes")
{
    const auto coarse = [](const geometry::TetMesh& mesh) {
        const auto built = buildBody(SoftBodyDef{.mesh = shared(mesh)}, 1e-3);
        return dynamic_cast<BuiltSoftBody&>(*built).body.system.matrixFree->coarseNodes();
    };
    CHECK(coarse(tetrahedronMesh()) == linalg::kPieceNodes);
    CHECK(coarse(boxMesh({1, 1, 1}, {1, 1, 1})) == linalg::kPieceNodes);
    CHECK(coarse(boxMesh({8, 8, 8}, {1, 1, 1})) >= 12);
    CHECK(coarse(boxMesh({8, 8, 8}, {1, 1, 1})) < 9 * 9 * 9 / 4);
}

TEST_CASE("a body at rest takes few iterations a step, and hangs where a tighter tolerance leaves it")
{
    // At 1 kHz the change of the velocities is rounding noise of some 0.2 um/s.
    for (const double period : {0.001, 0.01}) {
        SoftBodyDef def = pinnedBox(boxMesh({10, 7, 4}, {0.02, 0.014, 0.008}, 0.1));
        def.material = FemMaterial{.youngModulus = 5e4, .poissonRatio = 0.45};
        def.rayleigh.mass = 20.0;
        Stage loose(NativeEngineDef{.period = period, .threads = 1}),
            tight(NativeEngineDef{.period = period, .threads = 1});
        for (Stage* stage : {&loose, &tight}) stage->post(SetGravity{{0, -9.81, 0}});
        loose.add(def);
        def.solver = ConjugateGradient{.maxIterations = 2000, .tolerance = 1e-6};
        tight.add(def);
        const int settled = static_cast<int>(2.0 / period);
        loose.run(settled, period);
        tight.run(settled, period);
        const double iterations = iterationsOf(loose, 100, period);
        INFO("at a period of " << period << " s: " << iterations << " iterations");
        CHECK(iterations <= 3.0);
        const double sag = relativeDistance(tight.soft().x, tight.model().rest, 1.0);
        CHECK(relativeDistance(loose.soft().x, tight.soft().x, sag) < 1e-3);
    }
}

TEST_CASE("a body that comes to rest settles where a tighter tolerance leaves it")
{
    // The residuals of steps too small to be solved for added up to 1.7e-4 of the displacement.
    SoftBodyDef def{.mesh = bunnyFile(3004),
                    .material = FemMaterial{.youngModulus = 1e4, .poissonRatio = 0.45},
                    .mass = Density{1000.0},
                    .rayleigh = {.mass = 0.1, .stiffness = 0.01},
                    .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 0.045, 1}}}}};
    const NativeEngineDef engine{.period = 0.005, .threads = 1};
    Stage loose(engine), tight(engine);
    loose.add(def);
    def.solver = ConjugateGradient{.maxIterations = 2000, .tolerance = 1e-5};
    tight.add(def);
    for (Stage* stage : {&loose, &tight}) stage->post(SetGravity{{0, -9.81, 0}});
    tight.run(200, 0.005);
    const double iterations = iterationsOf(loose, 200, 0.005);
    INFO(iterations << " iterations a step");
    CHECK(iterations < 10.5);
    const double sag = relativeDistance(tight.soft().x, tight.model().rest, 1.0);
    CHECK(relativeDistance(loose.soft().x, tight.soft().x, sag) < 1e-4);
}

TEST_CASE("a step twice as long as the solver was prepared for takes at most half as many iterations more")
{
    for (double period : {0.001, 0.005}) {
        Stage prepared = hangingBunny(3004, FemMaterial{}, 2.0 * period),
              other = hangingBunny(3004, FemMaterial{}, period);
        const double expected = iterationsOf(prepared, 60, 2.0 * period);
        const double measured = iterationsOf(other, 60, 2.0 * period);
        std::cout << "iterations at dt = 2 T, T = " << period << " s: " << measured << ", prepared: " << expected
                  << "\n";
        CHECK(measured <= 1.5 * expected);
    }
}

TEST_CASE("nearly incompressible and stiff tissue converges within the default limit of iterations")
{
    Stage stage = hangingBunny(3004, FemMaterial{1e6, 0.49}, 0.005);
    CHECK(stage.run(100, 0.005).flags == 0);
}

TEST_CASE("a step with a clock reports the times of its stages")
{
    std::int64_t now = 0;
    const StepBudget budget{.now = [&] { return now += 1'000'000; }};
    Stage stage = hangingBunny(756);
    CHECK(stage.step(0.001).times.assemble == 0.0);
    const StepReport report = stage.world.step({.dt = 0.001, .budget = &budget});
    CHECK(report.times.commands == Approx(1e-3));
    CHECK(report.times.assemble == Approx(1e-3));
    CHECK(report.times.advance == Approx(1e-3));
}

TEST_CASE("bodies of all sizes and solvers step side by side as they do alone")
{
    std::vector<SoftBodyDef> defs;
    for (int elements : {756, 1492, 3004})
        defs.push_back({.mesh = bunnyFile(elements), .attachments = {{.nodes = {0, 1, 2}}}});
    defs.push_back(pinnedBox(boxMesh({3, 2, 2}, {0.3, 0.1, 0.1})));
    defs.push_back(pinnedBox(boxMesh({3, 2, 2}, {0.3, 0.1, 0.1})));
    defs[1].solver = ConjugateGradient{.tolerance = 1e-5};
    defs[3].solver = Cholesky{};
    defs[4].material = MassSpringMaterial{};
    for (int threads : {1, 3, 8}) {
        Stage together({.threads = threads});
        for (const SoftBodyDef& def : defs) together.add(def);
        together.post(SetGravity{{0, -9.81, 0}});
        together.run(20, 0.002);
        for (std::size_t b = 0; b < defs.size(); ++b) {
            Stage alone;
            alone.add(defs[b]);
            alone.post(SetGravity{{0, -9.81, 0}});
            alone.run(20, 0.002);
            CHECK(alone.soft().x == together.soft(b).x);
        }
    }
}

TEST_CASE("a solve ten times looser than the default ends where a tight one does, since its residual is carried on",
          "[cases]")
{
    for (double tolerance : {0.05, 1e-6}) {
        Stage loose = hangingBunny(756, FemMaterial{}, 0.005, ConjugateGradient{.tolerance = tolerance}, {5.0, 0.05});
        Stage exact = hangingBunny(756, FemMaterial{}, 0.005, Cholesky{}, {5.0, 0.05});
        loose.run(cases(1000), 0.005);
        exact.run(cases(1000), 0.005);
        const double size = relativeDistance(exact.soft().x, exact.model().rest, 1.0);
        CHECK(relativeDistance(loose.soft().x, exact.soft().x, size) < 1e-3);
    }
}

TEST_CASE("a body whose numbers do not fit single precision is solved in double")
{
    const auto built = buildBody(SoftBodyDef{.mesh = bunnyFile(756), .material = FemMaterial{1e-300, 0.45}}, 1e-3);
    CHECK(dynamic_cast<BuiltSoftBody&>(*built).body.system.matrixFree == nullptr);
    CHECK(dynamic_cast<BuiltSoftBody&>(*built).body.system.assembled != nullptr);
}

TEST_CASE("a nearly incompressible body that is pulled does not blow up and moves as a less incompressible one")
{
    const auto fall = [](double poissonRatio) {
        Stage stage;
        stage.add(SoftBodyDef{.mesh = bunnyFile(756),
                              .material = FemMaterial{.poissonRatio = poissonRatio},
                              .forces = {{.node = 5, .force = {0, 0.3, 0}}},
                              .pressure = 200});
        stage.post(SetGravity{{0, -9.81, 0}});
        CHECK(stage.run(50, 0.005).flags == 0);
        return stage.soft().x;
    };
    const std::vector<Vec3> usual = fall(0.499);
    for (const double poissonRatio : {0.4998, 0.4999, 0.49993, 0.49999, 0.4999999, 0.4999999999})
        CHECK(relativeDistance(fall(poissonRatio), usual, 0.1) < 0.05);
}

// Without geometricStiffness() the strips gained up to a thousand times their initial energy.
TEST_CASE("a stretched strip that whirls about its pinned corner gains no energy at any step length")
{
    for (const int length : {4, 8})
        for (const double poissonRatio : {0.4, 0.49, 0.499})
            for (const double dt : {0.001, 0.005, 0.02}) {
                Stage stage({.period = dt, .threads = 1});
                stage.add(SoftBodyDef{.mesh = shared(boxMesh({length, 1, 1}, {0.02, 0.005, 0.005})),
                                      .material = FemMaterial{8000.0, poissonRatio},
                                      .gravity = false,
                                      .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1e-6, 1e-6, 1e-6}}}}});
                stage.step(0.0);
                SoftState& state = stage.soft();
                for (std::size_t i = 0; i < state.x.size(); ++i) {
                    state.x[i].x *= 4.0;
                    state.v[i] = cross(Vec3{15.0, 50.0, 0.0}, state.x[i]);
                }
                const double start = mechanicalEnergy(stage, 0.0);
                double most = 0.0;
                for (int i = 0; i < 200; ++i) {
                    stage.step(dt);
                    most = std::max(most, mechanicalEnergy(stage, 0.0));
                }
                CHECK(most < 1.01 * start);
            }
}

TEST_CASE("a blow-up is rolled back, and the step is repeated with damping")
{
    Stage stage = hangingBunny(756, FemMaterial{}, 0.005);
    stage.step(0.005);
    const std::vector<Vec3> before = stage.soft().x;
    for (Vec3& v : stage.soft().v) v = {9000, 9000, 0};
    stage.soft().v[0] = {};
    const StepReport report = stage.step(2.0); // 18 km
    CHECK(report.has(StepFlag::Undone));
    CHECK(report.has(StepFlag::Damped));
    for (const Vec3& x : stage.soft().x) CHECK(length(x) < 10.0);
    CHECK(stage.run(100, 0.005).flags == 0);
    CHECK(usable(stage.soft().x));
}

TEST_CASE("an engine refuses a period and a number of threads out of range")
{
    CHECK_THROWS_WITH(makeNativeEngine({.period = 0.0}), Catch::Contains("period must be in (0, 10] s, got 0"));
    CHECK_THROWS_WITH(makeNativeEngine({.period = std::nan("")}), Catch::Contains("period"));
    for (int threads : {-1, 0, 257, 10000})
        CHECK_THROWS_WITH(makeNativeEngine({.threads = threads}), Catch::Contains("threads must be in [1, 256]"));
}

TEST_CASE("solver settings out of range are refused with their bound and value")
{
    const auto refused = [](const ConjugateGradient& solver, const char* words) {
        CHECK_THROWS_WITH(buildBody(SoftBodyDef{.mesh = bunnyFile(756), .solver = solver}, 1e-3),
                          Catch::Contains(words));
    };
    refused({.maxIterations = 0}, "maxIterations must be in [1, 100000], got 0");
    refused({.tolerance = 0.0}, "tolerance must be in (0, 1), got 0");
    refused({.tolerance = 1.0}, "tolerance must be in (0, 1), got 1");
    refused({.minIterations = -1}, "minIterations must be in [0, 100000], got -1");
    CHECK_THROWS_WITH(buildBody(SoftBodyDef{.mesh = bunnyFile(756), .material = FemMaterial{1e4, 0.5}}, 1e-3),
                      Catch::Contains("poissonRatio must be in [0, 0.5), got 0.5"));
}

TEST_CASE("springs that tune adds to a body of elements pull on it and leave its rotations unchanged")
{
    Stage stage = hangingBunny(756, FemMaterial{}, 0.005), exact = hangingBunny(756, FemMaterial{}, 0.005, Cholesky{});
    for (Stage* each : {&stage, &exact}) {
        each->step(0.005);
        each->post(Tune{[](PhysicsEngine& engine) {
            SoftModel& body = static_cast<World&>(engine).scene().soft[0].model;
            for (int k = 0; k < 40; ++k)
                body.springs.push_back({.nodes = {k, k + 60}, .restLength = 0.01, .stiffness = 20.0, .damping = 0.1});
        }});
        CHECK((each->run(60, 0.005).flags & ~static_cast<std::uint32_t>(StepFlag::Tuned) &
               ~static_cast<std::uint32_t>(StepFlag::Inverted)) == 0);
    }
    const double size = relativeDistance(exact.soft().x, exact.model().rest, 1.0);
    CHECK(relativeDistance(stage.soft().x, exact.soft().x, size) < 1e-3);
}

TEST_CASE("a body tuned to another solver is not moved by the residual of the default one")
{
    Stage stage = hangingBunny(756, FemMaterial{}, 0.005);
    stage.run(5, 0.005);
    double before = 0.0;
    for (const Vec3& l : stage.soft().residual) before += length(l);
    CHECK(before > 0.0);
    stage.post(
        Tune{[](PhysicsEngine& engine) { static_cast<World&>(engine).scene().soft[0].model.solver = Cholesky{}; }});
    for (int i = 0; i < 3; ++i) {
        stage.step(0.005);
        CHECK(stage.soft().residual == std::vector<Vec3>(stage.soft().x.size()));
    }
}

TEST_CASE("one step of an absurd force does not freeze a body for ever")
{
    Stage stage = hangingBunny(756, FemMaterial{}, 0.005);
    stage.step(0.005);
    stage.post(SetForces{BodyId{1}, {{.node = 0, .force = {1e40, 0, 0}}}});
    CHECK(stage.step(0.005).has(StepFlag::Undone));
    stage.post(SetForces{BodyId{1}, {}});
    CHECK(stage.run(100, 0.005).flags == 0);
    CHECK(relativeDistance(stage.soft().x, stage.model().rest, 1.0) > 0.01);
}

} // namespace matrix_free_test
