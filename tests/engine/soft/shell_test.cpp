#include "filasofia/engine/build/build_body.h"

#include "engine/sheets.h"
#include "engine/stage.h"

#include <iostream>

namespace shell_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

constexpr Vec3 kGravity{0, 0, -9.81};

/// A square sheet of 10 cm.
SoftBodyDef sheet(int cells, const ShellMaterial& material = {}, double jitter = 0.2)
{
    return {.mesh = shared(sheetMesh({cells, cells}, 0.1, 0.1, jitter, true)), .material = material};
}

std::vector<int> edgeAt(int cells) // the nodes with x = 0
{
    std::vector<int> nodes;
    for (int i = 0; i <= cells; ++i) nodes.push_back(i);
    return nodes;
}

/// [J]
double elasticEnergy(const Shell& shell, std::span<const Vec3> x)
{
    double sum = 0.0;
    for (const MembraneElement& each : shell.membranes) sum += membraneEnergy(each, vectorsAt(each.nodes, x));
    for (const BendingElement& each : shell.bends) sum += bendingEnergy(each, vectorsAt(each.nodes, x));
    return sum;
}

/// [J] Kinetic, elastic and potential energy.
double energyOf(Stage& stage, Vec3 gravity)
{
    const SoftModel& model = stage.model();
    const SoftState& state = stage.soft();
    double sum = elasticEnergy(model.shell, state.x);
    for (std::size_t i = 0; i < state.x.size(); ++i)
        sum += model.masses[i] * (0.5 * lengthSquared(state.v[i]) - dot(gravity, state.x[i]));
    return sum;
}

double fastest(const SoftState& state)
{
    double most = 0.0;
    for (const Vec3& each : state.v) most = std::max(most, length(each));
    return most;
}

/// Distance, after some steps, between the default solver at a tight tolerance and Cholesky, relative to the
/// displacement.
double distanceToCholesky(SoftBodyDef def, double dt, int steps)
{
    Stage fast, exact;
    def.solver = ConjugateGradient{.maxIterations = 4000, .tolerance = 1e-6};
    fast.add(def);
    def.solver = Cholesky{};
    exact.add(def);
    for (Stage* stage : {&fast, &exact}) {
        stage->post(SetGravity{kGravity});
        CHECK(stage->run(steps, dt).flags == 0);
    }
    CHECK(fast.world.scene().soft[0].system.matrixFree != nullptr);
    double worst = 0.0, moved = 0.0;
    for (std::size_t i = 0; i < exact.soft().x.size(); ++i) {
        worst = std::max(worst, distance(fast.soft().x[i], exact.soft().x[i]));
        moved = std::max(moved, distance(exact.soft().x[i], exact.model().rest[i]));
    }
    CHECK(moved > 1e-3);
    return worst / moved;
}

} // namespace

TEST_CASE("the mass of a shell is that of area times thickness, or the one given")
{
    Stage stage;
    SoftBodyDef def = sheet(6, {.thickness = 2e-3});
    def.mass = Density{1100.0};
    stage.add(def);
    def.mass = TotalMass{0.3};
    stage.add(def);
    stage.step(0.0);
    for (const auto& [body, expected] : {std::pair<std::size_t, double>{0, 0.1 * 0.1 * 2e-3 * 1100.0}, {1, 0.3}}) {
        double mass = 0.0;
        for (double each : stage.model(body).masses) mass += each;
        CHECK(mass == Approx(expected));
    }
}

TEST_CASE("the default solver matches Cholesky's steps for membranes and shells")
{
    SECTION("a shell that hangs from an edge")
    {
        SoftBodyDef def = sheet(12, {.youngModulus = 200e3, .thickness = 1e-3});
        def.attachments = {{.nodes = edgeAt(12)}};
        CHECK(distanceToCholesky(def, 0.002, 60) < 1e-4);
    }
    SECTION("a membrane that hangs from an edge")
    {
        SoftBodyDef def = sheet(12, {.youngModulus = 100e3, .thickness = 0.2e-3, .bendingScale = 0.0});
        def.attachments = {{.nodes = edgeAt(12)}};
        CHECK(distanceToCholesky(def, 0.002, 60) < 1e-4);
    }
    SECTION("held by springs and inflated")
    {
        SoftBodyDef def{.mesh = shared(tubeMesh(16, 8, 0.01, 0.04)),
                        .material = ShellMaterial{.youngModulus = 50e3, .thickness = 0.5e-3},
                        .attachments = {{.nodes = {0, 1, 2, 3, 4, 5, 6, 7}, .stiffness = 50.0}},
                        .pressure = -200.0};
        CHECK(distanceToCholesky(def, 0.002, 60) < 1e-4);
    }
    SECTION("one triangle")
    {
        SoftBodyDef def{.mesh = shared(geometry::TriangleMesh{{{}, {0.1, 0, 0}, {0, 0.1, 0}}, {{0, 1, 2}}, {}}),
                        .material = ShellMaterial{},
                        .attachments = {{.nodes = {0, 1}}}};
        CHECK(distanceToCholesky(def, 0.002, 60) < 1e-4);
    }
}

TEST_CASE("a sheet that collapses is solved in few iterations however it is crumpled")
{
    for (const double young : {1e5, 1e6}) {
        Stage stage({.period = 0.001, .threads = 1});
        SoftBodyDef def = sheet(20, {.youngModulus = young, .thickness = 0.2e-3}, 0.0);
        def.pose.orientation = {std::numbers::sqrt2 / 2.0, 0.0, -std::numbers::sqrt2 / 2.0, 0.0}; // x points upwards
        def.attachments = {{.nodes = edgeAt(20)}};
        stage.add(def);
        stage.post(SetGravity{kGravity});
        int most = 0;
        double sum = 0.0, lowest = 1.0;
        for (int step = 0; step < 500; ++step) {
            const StepReport report = stage.step(0.001);
            most = std::max(most, report.solves[0].iterations);
            sum += report.solves[0].iterations;
            CHECK_FALSE(report.has(StepFlag::NotConverged));
        }
        for (const Vec3& x : stage.soft().x) lowest = std::min(lowest, x.z);
        std::cout << "collapsing sheet of " << young << " Pa: " << sum / 500 << " iterations per step, " << most
                  << " at most, lowest point " << lowest << " m\n";
        CHECK(lowest < -0.01); // it hangs below the edge that it stood on
        CHECK(most < 100);     // with the matrix at rest, 250 and more than 300
        CHECK(sum < 30 * 500); // 89 and 145 per step
    }
}

TEST_CASE("the preconditioner of a crumpled shell has the present blocks of stretching, bending, masses and pins")
{
    Stage stage({.period = 0.001, .threads = 1});
    SoftBodyDef def = sheet(8, {.youngModulus = 1e5, .thickness = 2e-3});
    def.rayleigh = {0.5, 0.002};
    def.attachments = {{.nodes = {0, 1, 2}}, {.nodes = {40}, .stiffness = 30.0}};
    stage.add(def);
    stage.step(0.0);
    std::mt19937 random(5);
    for (std::size_t i = 3; i < stage.soft().x.size(); ++i) stage.soft().x[i] += randomVec3(random, 0.01);
    const std::vector<Vec3> x = stage.soft().x;
    stage.step(0.001);
    const SoftModel& model = stage.model();
    const ImplicitWeights weights = implicitWeights(0.001, {0.5, 0.002});
    std::vector<Mat3> blocks(x.size());
    for (const MembraneElement& each : model.shell.membranes) {
        const MembraneTangent tangent = membraneTangent(each, vectorsAt(each.nodes, x), weights.turning);
        for (int i = 0; i < 3; ++i) blocks[each.nodes[i]] += weights.stiffness * stiffnessBlock(tangent, i, i);
    }
    for (const BendingElement& each : model.shell.bends) {
        const BendingTangent tangent = bendingTangent(each, vectorsAt(each.nodes, x));
        for (int i = 0; i < 6; ++i) blocks[each.nodes[i]] += weights.stiffness * stiffnessBlock(tangent, i, i);
    }
    for (std::size_t i = 3; i < x.size(); ++i) {
        const double pin = i == 40 ? 30.0 : 0.0;
        blocks[i] += (weights.mass * model.masses[i] + weights.stiffness * pin) * Mat3::identity();
        const double found = stage.world.scene().soft[0].system.matrixFree->compliance(static_cast<int>(i));
        CHECK(found == Approx(trace(inverse(blocks[i])) / 3.0).epsilon(1e-3));
    }
}

TEST_CASE("a shell computes the same bits with any number of threads")
{
    std::vector<std::vector<Vec3>> results;
    for (int threads : {1, 2, 3}) {
        Stage stage({.threads = threads});
        SoftBodyDef def = sheet(36);
        def.attachments = {{.nodes = {0, 36}}};
        stage.add(def);
        stage.post(SetGravity{kGravity});
        stage.run(20, 0.005);
        results.push_back(stage.soft().x);
    }
    CHECK(results[0] == results[1]);
    CHECK(results[0] == results[2]);
}

TEST_CASE("a free shell without damping that is thrown and spins keeps its momentum and, to 2 %, its energy")
{
    for (double young : {20e3, 2e6})
        for (bool curved : {false, true}) {
            Stage stage;
            SoftBodyDef def = sheet(10, {.youngModulus = young, .thickness = 1e-3});
            if (curved) def.mesh = shared(tubeMesh(20, 8, 0.015, 0.05));
            def.rayleigh = {0.0, 0.0};
            def.gravity = false;
            stage.add(def);
            stage.step(0.0);
            std::mt19937 random(3);
            for (std::size_t i = 0; i < stage.soft().v.size(); ++i)
                stage.soft().v[i] = cross({3.0, 5.0, 10.0}, stage.soft().x[i]) + randomVec3(random, 0.1);
            const auto momentum = [&] {
                Vec3 sum;
                for (std::size_t i = 0; i < stage.soft().v.size(); ++i)
                    sum += stage.model().masses[i] * stage.soft().v[i];
                return sum;
            };
            const Vec3 before = momentum();
            const double first = energyOf(stage, {});
            double highest = 0.0;
            for (int step = 0; step < 400; ++step) {
                stage.step(0.005);
                highest = std::max(highest, energyOf(stage, {}));
            }
            INFO("E " << young << " curved " << curved);
            CHECK(distance(momentum(), before) < 1e-5 * length(before));
            // A step that turns the body by w also stretches it by w^2 / 2: without damping it keeps that energy.
            CHECK(highest < 1.02 * first);
        }
}

TEST_CASE("a stiff sheet that was rolled up and is let go gains no energy")
{
    for (double thickness : {0.5e-3, 2e-3})
        for (const auto& [damping, dt] : {std::pair{0.0, 0.001}, {0.01, 0.001}, {0.01, 0.005}}) {
            Stage stage({.period = dt, .threads = 1});
            SoftBodyDef def = sheet(12, {.youngModulus = 2e6, .thickness = thickness});
            def.rayleigh = {0.0, damping};
            def.gravity = false;
            stage.add(def);
            stage.step(0.0);
            constexpr double radius = 0.03;
            for (Vec3& x : stage.soft().x)
                x = {radius * std::sin(x.x / radius), x.y, radius * (1.0 - std::cos(x.x / radius))};
            const double first = energyOf(stage, {});
            double highest = 0.0;
            for (int step = 0; step < 400; ++step) {
                stage.step(dt);
                highest = std::max(highest, energyOf(stage, {}));
            }
            INFO("thickness " << thickness << " damping " << damping << " dt " << dt);
            CHECK(first > 1e-4);
            CHECK(highest < 1.01 * first);
        }
}

TEST_CASE("a cloth that hangs from two corners comes to rest")
{
    Stage stage;
    SoftBodyDef def = sheet(16, {.youngModulus = 50e3, .thickness = 0.5e-3});
    def.attachments = {{.nodes = {0, 16}}};
    def.rayleigh = {0.5, 0.01};
    stage.add(def);
    stage.post(SetGravity{kGravity});
    double iterations = 0.0;
    StepReport report;
    for (int step = 0; step < 3000; ++step) {
        report = stage.step(0.005);
        iterations += report.solves[0].iterations;
    }
    std::cout << "hanging cloth: " << iterations / 3000 << " iterations per step, " << fastest(stage.soft())
              << " m/s\n";
    CHECK(fastest(stage.soft()) < 1e-3);
    CHECK_FALSE(report.has(StepFlag::Restless));
    CHECK_FALSE(report.has(StepFlag::NotConverged));
}

TEST_CASE("a sheet that is dropped on a ball from either side rests on it and does not pass through")
{
    for (bool below : {false, true}) {
        Stage stage;
        SoftBodyDef def = sheet(14, {.youngModulus = 50e3, .thickness = 0.5e-3});
        def.pose.position = {-0.05, -0.05, 0.032};
        if (below) { // the sheet is turned over: its other side faces the ball
            def.pose.orientation = {0.0, 1.0, 0.0, 0.0};
            def.pose.position.y = 0.05;
        }
        def.rayleigh = {0.5, 0.01};
        def.collision = {{.proximity = 1e-3}};
        stage.add(def);
        stage.add(RigidBodyDef{.mesh = geometry::shapes::sphere(0.03, 8), .collision = {{.proximity = 1e-3}}});
        stage.post(SetGravity{kGravity});
        StepReport report;
        double penetration = 0.0;
        for (int step = 0; step < 150; ++step) {
            report = stage.step(0.005);
            penetration = std::max(penetration, report.contacts.penetration);
        }
        CHECK(report.contacts.active > 10);
        CHECK(penetration < 1e-3);
        for (const Vec3& x : stage.soft().x) CHECK(length(x) > 0.029);
        CHECK(stage.soft().x[112].z > 0.029); // its middle is on top
        CHECK(stage.soft().x[0].z < 0.02);    // and its corner hangs
    }
}

TEST_CASE("pressure inflates a closed shell, and a reset takes it back")
{
    Stage stage;
    SoftBodyDef def{.mesh = geometry::shapes::sphere(0.03, 8),
                    .material = ShellMaterial{.youngModulus = 30e3, .thickness = 0.5e-3},
                    .pressure = -200.0};
    def.gravity = false;
    stage.add(def);
    stage.run(400, 0.005);
    // p = 2 t mu (1 - s^-6) / (s R) for the incompressible sphere gives s = 1.24
    CHECK(length(stage.soft().x[0]) > 1.2 * 0.03);
    CHECK(length(stage.soft().x[0]) < 1.3 * 0.03);
    stage.post(Reset{});
    stage.step(0.0);
    CHECK(stage.soft().x == stage.model().rest);
}

TEST_CASE("a new material of a shell takes effect at once")
{
    const auto sinkingAfter = [](bool change) {
        Stage stage;
        SoftBodyDef def = sheet(10, {.youngModulus = 1e6, .thickness = 1e-3});
        def.attachments = {{.nodes = edgeAt(10)}};
        const BodyId id = stage.add(def);
        stage.post(SetGravity{kGravity});
        stage.run(200, 0.005);
        if (change)
            stage.post(SetMaterial{.id = id, .material = ShellMaterial{.youngModulus = 1e5, .thickness = 1e-3}});
        stage.run(200, 0.005);
        return stage.soft().x.back().z;
    };
    // Its own weight stretches it by rho g L / (2 E): 0.05 % and 0.5 %.
    CHECK(sinkingAfter(false) == Approx(-0.1).epsilon(2e-3));
    CHECK(sinkingAfter(true) < sinkingAfter(false) - 2e-4);
}

TEST_CASE("the pins of a hanging shell bear its weight")
{
    Stage stage;
    SoftBodyDef def = sheet(8, {.youngModulus = 200e3, .thickness = 1e-3});
    def.attachments = {{.nodes = edgeAt(8)}};
    def.rayleigh = {2.0, 0.02};
    stage.add(def);
    stage.post(SetGravity{kGravity});
    stage.run(1500, 0.005);
    const Vec3 force = stage.world.scene().attachmentReports[0].force;
    CHECK(force.z == Approx(0.1 * 0.1 * 1e-3 * 1000.0 * 9.81).epsilon(1e-3));
    CHECK(std::abs(force.x) + std::abs(force.y) < 1e-3 * force.z);
}

TEST_CASE("a shell can be attached to a shell, to a body and by a rigid body to it")
{
    Stage stage;
    const BodyId first = stage.add(sheet(8));
    SoftBodyDef def = sheet(6);
    def.pose.position = {0.1, 0, 0};
    def.attachments = {{.nodes = edgeAt(6), .to = first}};
    const BodyId second = stage.add(def);
    stage.add(RigidBodyDef{.elements = {Pose{{0.2, 0.05, 0}, {}}},
                           .mesh = geometry::shapes::sphere(0.01, 2),
                           .attachments = {{.to = second}}});
    stage.post(SetGravity{{-9.81, 0, 0}});
    CHECK(stage.run(100, 0.005).flags == 0);
    CHECK(stage.soft(0).x[0].x > -0.05); // both hang on the kinematic ball
    CHECK(distance(stage.soft(1).x[0], stage.soft(0).x[72]) < 1e-3);
}

TEST_CASE("a shell that is strained beyond its range is reported")
{
    Stage stage;
    SoftBodyDef def = sheet(6, {.youngModulus = 10e3, .thickness = 0.5e-3, .validStrain = 0.2});
    def.attachments = {{.nodes = edgeAt(6)}};
    def.gravity = false;
    const BodyId id = stage.add(def);
    CHECK_FALSE(stage.run(2, 0.005).has(StepFlag::BeyondStrain));
    stage.post(SetForces{id, {{48, {2.0, 0, 0}}}});
    stage.run(99, 0.005);
    const std::vector<Vec3> before = stage.soft().x;
    const StepReport report = stage.step(0.005);
    CHECK(report.has(StepFlag::BeyondStrain));
    CHECK(report.beyondStrain.body == id);
    const auto& mesh = std::get<std::shared_ptr<const geometry::TriangleMesh>>(def.mesh);
    const auto [a, b, c] = mesh->triangles.at(report.beyondStrain.element);
    CHECK(distance(1.0 / 3.0 * (before[a] + before[b] + before[c]), report.beyondStrain.place) < 1e-12);
    CHECK(report.beyondStrain.strain > 0.2);
    CHECK(report.beyondStrain.valid == 0.2);
}

} // namespace shell_test
