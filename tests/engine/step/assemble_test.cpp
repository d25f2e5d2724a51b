#include "engine/stage.h"

#include <numeric>

namespace assemble_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

SoftBodyDef explicitBox()
{
    SoftBodyDef def = freeBody(boxMesh({3, 3, 3}, {0.3, 0.2, 0.1}, 0.2));
    def.integrator = ExplicitEuler{};
    return def;
}

Vec3 sum(const std::vector<Vec3>& values) { return std::accumulate(values.begin(), values.end(), Vec3{}); }

} // namespace

TEST_CASE("a body at rest has no forces")
{
    Stage stage;
    stage.add(explicitBox());
    stage.step(0.0);
    for (const Vec3& f : forcesNow(stage)) CHECK(length(f) < 1e-9);
}

TEST_CASE("gravity is mass times acceleration, on the bodies that ask for it")
{
    Stage stage;
    SoftBodyDef def = explicitBox();
    stage.add(def);
    def.gravity = true;
    stage.add(def);
    stage.post(SetGravity{{1, -9.81, 2}});
    stage.step(0.0);
    CHECK(length(sum(forcesNow(stage, 0))) < 1e-9);
    const std::vector<Vec3> forces = forcesNow(stage, 1);
    for (std::size_t i = 0; i < forces.size(); ++i)
        CHECK(distance(forces[i], stage.model(1).masses[i] * Vec3{1, -9.81, 2}) < 1e-9);
}

TEST_CASE("forces act on their nodes, and several on one node add up")
{
    Stage stage;
    SoftBodyDef def = explicitBox();
    def.forces = {{3, {1, 0, 0}}, {5, {0, 2, 0}}, {3, {0, 0, 4}}};
    stage.add(def);
    stage.step(0.0);
    const std::vector<Vec3> forces = forcesNow(stage);
    CHECK(distance(forces[3], {1, 0, 4}) < 1e-9);
    CHECK(distance(forces[5], {0, 2, 0}) < 1e-9);
    CHECK(distance(sum(forces), {1, 2, 4}) < 1e-9);
}

TEST_CASE("pressure on a closed surface has no resultant, pushes inwards, and does the work p dV")
{
    constexpr double p = 250.0;
    Stage stage;
    SoftBodyDef def = explicitBox();
    stage.add(def);
    def.pressure = p;
    stage.add(def);
    stage.step(0.0);
    std::mt19937 random(5);
    for (Vec3& x : stage.soft(0).x) x += randomVec3(random, 0.004);
    stage.soft(1).x = stage.soft(0).x;

    std::vector<Vec3> pressing = forcesNow(stage, 1);
    const std::vector<Vec3> elastic = forcesNow(stage, 0);
    double terms = 0.0;
    for (std::size_t i = 0; i < pressing.size(); ++i) {
        pressing[i] -= elastic[i];
        terms += length(pressing[i]);
    }
    CHECK(terms > 0.5 * p * 2 * (0.06 + 0.03 + 0.02) / 3);
    CHECK(length(sum(pressing)) < 1e-9 * terms);

    for (int k = 0; k < 5; ++k) { // the work of a small motion, against the change of the volume
        std::vector<Vec3> ahead = stage.soft(1).x, behind = ahead;
        double work = 0.0;
        for (std::size_t i = 0; i < ahead.size(); ++i) {
            const Vec3 dx = randomVec3(random, 1e-6);
            ahead[i] += dx;
            behind[i] -= dx;
            work += 2.0 * dot(pressing[i], dx);
        }
        const double dV = meshVolume(stage.model(1), ahead) - meshVolume(stage.model(1), behind);
        CHECK(work == Approx(-p * dV).epsilon(1e-6));
    }
}

TEST_CASE("a hard pin does not move under any force")
{
    for (const Integrator& integrator : {Integrator{ImplicitEuler{}}, Integrator{ExplicitEuler{true}}})
        for (const Solver& solver : {Solver{Cholesky{}}, Solver{ConjugateGradient{}}}) {
            Stage stage;
            SoftBodyDef def{.mesh = shared(boxMesh({3, 2, 2}, {0.3, 0.1, 0.1})),
                            .integrator = integrator,
                            .solver = solver,
                            .attachments = {{.nodes = {0, 4, 17}}},
                            .forces = {{4, {100, 0, 0}}},
                            .pressure = 50};
            stage.add(def);
            stage.post(SetGravity{{0, -9.81, 0}});
            const bool implicit = std::holds_alternative<ImplicitEuler>(integrator);
            stage.run(implicit ? 100 : 1000, implicit ? 0.01 : 1e-5);
            for (int node : {0, 4, 17}) {
                CHECK(stage.soft().x[node] == stage.model().rest[node]);
                CHECK(stage.soft().v[node] == Vec3{});
            }
            CHECK(distance(stage.soft().x[35], stage.model().rest[35]) > 1e-6);
        }
}

TEST_CASE("a spring pin pulls back, and at rest carries the weight")
{
    Stage stage;
    SoftBodyDef def{.mesh = shared(boxMesh({2, 2, 2}, {0.1, 0.1, 0.1})), .rayleigh = {50.0, 0.0}, .solver = Cholesky{}};
    std::vector<int> all(27);
    std::iota(all.begin(), all.end(), 0);
    def.attachments = {{.nodes = all, .stiffness = 400.0}};
    stage.add(def);
    stage.post(SetGravity{{0, -10, 0}});
    stage.run(2000, 0.01);
    double carried = 0.0;
    for (std::size_t i = 0; i < 27; ++i) carried += 400.0 * (stage.model().rest[i].y - stage.soft().x[i].y);
    CHECK(carried == Approx(10 * 1000 * 0.001).epsilon(1e-9));
}

TEST_CASE("a spring pin on a node that is also hard-pinned changes nothing")
{
    Stage a, b;
    SoftBodyDef def{.mesh = shared(boxMesh({2, 1, 1}, {0.2, 0.1, 0.1})), .attachments = {{.nodes = {0, 1, 2}}}};
    a.add(def);
    def.attachments.push_back({.nodes = {0, 1}, .stiffness = 1e5});
    b.add(def);
    for (Stage* stage : {&a, &b}) {
        stage->post(SetGravity{{0, -9.81, 0}});
        stage->run(50, 0.01);
    }
    CHECK(a.soft().x == b.soft().x);
}

TEST_CASE("elements that are inside out are counted, of tissue and of springs, and the worst is named")
{
    for (const SoftMaterial& material : {SoftMaterial{FemMaterial{}}, SoftMaterial{MassSpringMaterial{}}}) {
        Stage stage;
        const BodyId body = stage.add(
            SoftBodyDef{.mesh = shared(boxMesh({3, 3, 3}, {0.3, 0.3, 0.3})), .material = material, .gravity = false});
        CHECK(stage.step(1e-6).inverted.count == 0);
        const auto& x = stage.soft().x;
        const auto inner = static_cast<std::size_t>(std::ranges::find_if(x,
                                                                         [](Vec3 p) {
                                                                             return p.x > 0.05 && p.x < 0.15 &&
                                                                                    p.y > 0.05 && p.y < 0.15 &&
                                                                                    p.z > 0.05 && p.z < 0.15;
                                                                         }) -
                                                    x.begin());
        REQUIRE(inner < x.size());
        stage.soft().x[inner].x -= 0.15; // out of the body by half a cell
        const StepReport report = stage.step(1e-6);
        CHECK(report.has(StepFlag::Inverted));
        CHECK(report.inverted.count > 0);
        CHECK(report.inverted.body == body);
        CHECK(report.inverted.volume == Approx(-0.5).epsilon(0.1)); // behind the face that it left
        CHECK(report.inverted.element >= 0);
    }
}

} // namespace assemble_test
