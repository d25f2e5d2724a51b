#include "engine/elastic/laws.h"
#include "engine/stage.h"

#include <numeric>

namespace advance_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

bool allFinite(const SoftState& state)
{
    for (const auto* list : {&state.x, &state.v, &state.dv})
        for (const Vec3& v : *list)
            if (!isFinite(v)) return false;
    return true;
}

/// [J] Elastic energy plus the kinetic energy across the body's direction of flight.
double energy(Stage& stage)
{
    double sum = 0.0;
    for (std::size_t e = 0; e < stage.model().elements.size(); ++e) {
        const FemElement& element = stage.model().elements[e];
        Corners x;
        for (std::size_t i = 0; i < 4; ++i) x[i] = stage.soft().x[element.nodes[i]];
        const Deformation at{gradient(element, x), toMat3(normalized(rotationOf(stage.soft().rotations, e)))};
        sum += element.volume * energyDensity(stage.model().material.law, lameOf(element), at);
    }
    for (std::size_t i = 0; i < stage.soft().v.size(); ++i) {
        const Vec3 v = stage.soft().v[i];
        sum += 0.5 * stage.model().masses[i] * (v.y * v.y + v.z * v.z);
    }
    return sum;
}

} // namespace

TEST_CASE("a step of dt = 0 moves nothing and makes no step")
{
    Stage stage;
    stage.add(SoftBodyDef{.mesh = bunnyFile(756)});
    stage.post(SetGravity{{0, -9.81, 0}});
    stage.run(5, 0.01);
    const std::uint64_t before = stage.world.hash();
    const StepReport report = stage.step(0.0);
    CHECK(stage.world.hash() == before);
    CHECK(report.step == 5);
    CHECK(report.time == Approx(0.05));
    CHECK(report.dt == 0.0);
}

TEST_CASE("a free body falls with velocity g t, undeformed, with every integrator")
{
    for (const Integrator& integrator :
         {Integrator{ImplicitEuler{}}, Integrator{ExplicitEuler{false}}, Integrator{ExplicitEuler{true}}}) {
        Stage stage;
        SoftBodyDef def = freeBody(boxMesh({2, 2, 2}, {0.1, 0.1, 0.1}, 0.2));
        def.integrator = integrator;
        def.solver = Cholesky{};
        def.gravity = true;
        stage.add(def);
        stage.post(SetGravity{{0, -10, 0}});
        const int n = 500;
        const double dt = 2e-4, t = n * dt;
        stage.run(n, dt);
        const auto* explicitly = std::get_if<ExplicitEuler>(&integrator);
        const bool old = explicitly && !explicitly->symplectic;
        for (std::size_t i = 0; i < 27; ++i) {
            CHECK(distance(stage.soft().v[i], {0, -10 * t, 0}) < 1e-9);
            const double fall = 0.5 * 10 * t * (old ? t - dt : t + dt); // the sum of dt v over the steps
            CHECK(distance(stage.soft().x[i], stage.model().rest[i] - Vec3{0, fall, 0}) < 1e-9);
        }
    }
}

TEST_CASE("mass damping slows a free body by 1 / (1 + a dt) per step")
{
    Stage stage;
    SoftBodyDef def = freeBody(tetrahedronMesh());
    def.rayleigh = {3.0, 0.0};
    def.solver = Cholesky{};
    stage.add(def);
    stage.step(0.0);
    for (Vec3& v : stage.soft().v) v = {1, 0, 0};
    stage.run(20, 0.01);
    for (const Vec3& v : stage.soft().v) CHECK(distance(v, {std::pow(1.03, -20.0), 0, 0}) < 1e-12);
}

TEST_CASE("stiffness damping does not slow a rigid motion, and damps a vibration")
{
    Stage damped, undamped;
    for (Stage* stage : {&damped, &undamped}) {
        SoftBodyDef def = freeBody(boxMesh({2, 2, 2}, {0.1, 0.1, 0.1}, 0.2));
        def.rayleigh.stiffness = stage == &damped ? 0.005 : 0.0;
        def.solver = Cholesky{};
        stage->add(def);
        stage->step(0.0);
        for (std::size_t i = 0; i < 27; ++i) {
            stage->soft().v[i] = {1, 0, 0};
            stage->soft().x[i].y *= 1.2;
        }
        stage->run(50, 0.002);
    }
    Vec3 momentum;
    double mass = 0.0;
    for (std::size_t i = 0; i < 27; ++i) {
        momentum += damped.model().masses[i] * damped.soft().v[i];
        mass += damped.model().masses[i];
    }
    CHECK(distance(momentum / mass, {1, 0, 0}) < 1e-9);
    CHECK(energy(damped) < 0.1 * energy(undamped));
}

TEST_CASE("explicit Euler with far too large a step is rolled back and reported, and stays finite for ever")
{
    Stage stage;
    SoftBodyDef def = freeBody(boxMesh({2, 2, 2}, {0.1, 0.1, 0.1}));
    def.integrator = ExplicitEuler{};
    def.forces = {{0, {1, 2, 3}}};
    stage.add(def);
    bool undone = false;
    for (int i = 0; i < 500; ++i) {
        undone = stage.step(0.05).has(StepFlag::Undone) || undone;
        REQUIRE(allFinite(stage.soft()));
    }
    CHECK(undone);
}

TEST_CASE("a body that blows up does not affect the others")
{
    Stage with, without;
    for (Stage* stage : {&with, &without}) {
        stage->add(SoftBodyDef{.mesh = shared(boxMesh({2, 2, 2}, {0.1, 0.1, 0.1}))});
        stage->post(SetGravity{{0, -9.81, 0}});
    }
    SoftBodyDef wild = freeBody(boxMesh({2, 2, 2}, {0.1, 0.1, 0.1}));
    wild.integrator = ExplicitEuler{};
    wild.forces = {{0, {1, 2, 3}}};
    with.add(wild);
    CHECK(with.run(100, 0.05).has(StepFlag::Undone));
    CHECK_FALSE(without.run(100, 0.05).has(StepFlag::Undone));
    CHECK(with.soft(0).x == without.soft(0).x);
}

TEST_CASE("a body whose step is rolled back keeps its positions and loses its velocity")
{
    Stage stage;
    SoftBodyDef def = freeBody(tetrahedronMesh());
    stage.add(def);
    stage.step(0.0);
    for (Vec3& v : stage.soft().v) v = {1e5, 0, 0};
    CHECK(stage.step(100.0).has(StepFlag::Undone)); // 10 000 km away
    CHECK(stage.soft().x == stage.model().rest);
    CHECK(stage.soft().v == std::vector<Vec3>(4));
    CHECK_FALSE(stage.step(0.01).has(StepFlag::Undone));
}

TEST_CASE("implicit Euler stays finite and upright at any step and stiffness")
{
    for (double dt : {1e-6, 0.1, 10.0, 1000.0})
        for (double young : {1e-3, 1e4, 1e12}) {
            Stage stage;
            stage.add(SoftBodyDef{.mesh = shared(boxMesh({3, 2, 2}, {0.3, 0.1, 0.1})),
                                  .material = FemMaterial{.youngModulus = young},
                                  .attachments = {{.box = geometry::Box{{0, 0, 0}, {0, 1, 1}}}}});
            stage.post(SetGravity{{0, -9.81, 0}});
            stage.run(20, dt);
            CHECK(allFinite(stage.soft()));
        }
}

TEST_CASE("a solver stopped at its limit of iterations reports that and its residual")
{
    Stage stage;
    stage.add(SoftBodyDef{.mesh = bunnyFile(756),
                          .solver = ConjugateGradient{.maxIterations = 1, .tolerance = 1e-8},
                          .attachments = {{.nodes = {0}}}});
    stage.post(SetGravity{{0, -9.81, 0}});
    const StepReport report = stage.step(0.01);
    CHECK(report.has(StepFlag::NotConverged));
    REQUIRE(report.solves.size() == 1);
    CHECK(report.solves[0].iterations == 1);
    CHECK(report.solves[0].residual > 1e-8);
    CHECK(allFinite(stage.soft()));
}

TEST_CASE("the report contains step, time, dt and one solve per soft body")
{
    Stage stage;
    stage.add(SoftBodyDef{.mesh = shared(tetrahedronMesh()), .solver = Cholesky{}});
    stage.add(RigidBodyDef{});
    SoftBodyDef def{.mesh = shared(tetrahedronMesh())};
    def.integrator = ExplicitEuler{};
    stage.add(def);
    stage.post(SetGravity{{0, -9.81, 0}});
    const StepReport report = stage.run(4, 0.25);
    CHECK(report.step == 4);
    CHECK(report.time == 1.0);
    CHECK(report.dt == 0.25);
    REQUIRE(report.solves.size() == 2);
    CHECK(report.solves[0].body == BodyId{1});
    CHECK(report.solves[0].iterations == 1);
    CHECK(report.solves[0].residual < 1e-12);
    CHECK(report.solves[1].body == BodyId{3});
    CHECK(report.solves[1].iterations == 0);
}

TEST_CASE("a body all of whose nodes are pinned stays in place")
{
    for (const Solver& solver : {Solver{Cholesky{}}, Solver{ConjugateGradient{}}}) {
        Stage stage;
        SoftBodyDef def{.mesh = shared(boxMesh({1, 1, 1}, {1, 1, 1})), .solver = solver};
        std::vector<int> all(8);
        std::iota(all.begin(), all.end(), 0);
        def.attachments = {{.nodes = all}};
        stage.add(def);
        stage.post(SetGravity{{0, -9.81, 0}});
        const StepReport report = stage.run(10, 0.01);
        CHECK(report.flags == 0);
        CHECK(stage.soft().x == stage.model().rest);
    }
}

TEST_CASE("a body in two pieces moves as two bodies")
{
    const geometry::TetMesh one = boxMesh({2, 1, 1}, {0.2, 0.1, 0.1}), two = twice(one, {0, 1, 0});
    const int n = static_cast<int>(one.nodes.size());
    Stage together, alone;
    SoftBodyDef def{.mesh = shared(two), .solver = Cholesky{}, .attachments = {{.nodes = {0, 1, 2, 3}}}};
    together.add(def);
    def.mesh = shared(one);
    alone.add(def);
    for (Stage* stage : {&together, &alone}) {
        stage->post(SetGravity{{0, -9.81, 0}});
        CHECK(stage->run(40, 0.01).flags == 0);
    }
    const std::vector<Vec3> first(together.soft().x.begin(), together.soft().x.begin() + n);
    CHECK(relativeDistance(first, alone.soft().x, 0.2) < 1e-10);
    for (int i = 0; i < n; ++i) CHECK(together.soft().v[n + i].y < -3.0); // the second piece falls
}

} // namespace advance_test
