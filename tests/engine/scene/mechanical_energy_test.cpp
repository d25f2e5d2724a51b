#include "engine/articulation/jaw.h"
#include "engine/elastic/laws.h"
#include "engine/rigid/rigid_bodies.h"
#include "engine/rods.h"
#include "engine/sheets.h"
#include "engine/stage.h"

#include <cmath>
#include <numbers>

namespace mechanical_energy_test {

using namespace filasofia;
using namespace filasofia::engine;
using physics::MechanicalEnergy;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr Vec3 kBlock{0.02, 0.03, 0.04}; // [m]

double volume(Vec3 size) { return size.x * size.y * size.z; }

MechanicalEnergy energyNow(Stage& stage) { return stage.world.energyOf({1}); }
double sumOf(const MechanicalEnergy& each) { return each.kinetic + each.elastic + each.gravitational; }

/// [J] What a block of this tissue stores when it is as a whole deformed by f.
double storedBy(const Mat3& f, const physics::SoftMaterial& material)
{
    Stage stage;
    physics::SoftBodyDef def = freeBody(boxMesh({2, 2, 2}, kBlock, 0.2));
    def.material = material;
    stage.add(def);
    stage.step(0.0);
    CHECK(std::abs(energyNow(stage).elastic) < 1e-15); // at rest
    for (Vec3& x : stage.soft().x) x = f * x;
    const MechanicalEnergy energy = energyNow(stage);
    CHECK(energy.kinetic == 0.0);
    CHECK(energy.gravitational == 0.0);
    return energy.elastic;
}

Mat3 stretched(Vec3 by)
{
    Mat3 f;
    f[0].x = by.x, f[1].y = by.y, f[2].z = by.z;
    return f;
}

} // namespace

TEST_CASE("a falling soft body gains the kinetic energy that its weight loses, to the order of the steps")
{
    constexpr double dt = 1e-3;
    constexpr int steps = 200;
    const Vec3 gravity{1.0, -9.0, 2.0};
    for (const bool symplectic : {false, true}) {
        Stage stage;
        stage.post(physics::SetGravity{gravity});
        physics::SoftBodyDef def = freeBody(boxMesh({2, 2, 2}, kBlock));
        def.gravity = true;
        def.pose.position = {0.1, 0.2, 0.3};
        if (symplectic) def.integrator = physics::ExplicitEuler{.symplectic = true};
        stage.add(def);
        stage.step(0.0);
        const double mass = 1000.0 * volume(kBlock), g2 = dot(gravity, gravity), time = steps * dt;
        const MechanicalEnergy start = energyNow(stage);
        CHECK(start.kinetic == 0.0);
        CHECK(start.gravitational == Approx(-mass * dot(gravity, def.pose.position + 0.5 * kBlock)).epsilon(1e-12));
        stage.run(steps, dt);
        const MechanicalEnergy end = energyNow(stage);
        CHECK(end.kinetic == Approx(0.5 * mass * g2 * time * time).epsilon(1e-6)); // the solver is exact to that
        CHECK(std::abs(end.elastic) < 1e-9 * end.kinetic);
        // A step falls by its last velocity: half a step more than the closed form.
        CHECK(sumOf(end) - sumOf(start) == Approx(-0.5 * mass * g2 * time * dt).epsilon(1e-4));
    }
}

TEST_CASE("a stretched block stores its volume times the energy density, whatever its law")
{
    const Mat3 f = toMat3(axisAngle({1, 2, 3}, 0.7)) * stretched({1.3, 0.9, 0.95});
    for (const NamedLaw& each : everyLaw()) {
        CAPTURE(each.name);
        const physics::FemMaterial material{.youngModulus = 20e3, .poissonRatio = 0.4, .law = each.law};
        const double density = energyDensity(each.law, lame(20e3, 0.4), deformation(f));
        CHECK(storedBy(f, material) == Approx(volume(kBlock) * density).epsilon(1e-9));
    }
    // Two of them by hand, with the stretches 1.3, 0.9 and 0.95.
    const auto [mu, lambda] = lame(20e3, 0.4);
    const double j = 1.3 * 0.9 * 0.95, i1 = 1.3 * 1.3 + 0.9 * 0.9 + 0.95 * 0.95, stretch = 1.3 + 0.9 + 0.95 - 3.0;
    const double neoHookean = mu / 2 * (i1 - 3) - mu * std::log(j) + lambda / 2 * (j - 1) * (j - 1);
    const double corotational = mu * (0.3 * 0.3 + 0.1 * 0.1 + 0.05 * 0.05) + lambda / 2 * stretch * stretch;
    const auto stored = [&](const physics::ElasticLaw& law) {
        return storedBy(f, physics::FemMaterial{.youngModulus = 20e3, .poissonRatio = 0.4, .law = law});
    };
    CHECK(stored(physics::NeoHookean{}) == Approx(volume(kBlock) * neoHookean).epsilon(1e-9));
    CHECK(stored(physics::Corotational{}) == Approx(volume(kBlock) * corotational).epsilon(1e-9));
}

TEST_CASE("nodes that share their volume, and fibres, store what their formulas say")
{
    const Mat3 f = stretched({1.2, 0.9, 0.98});
    const double j = 1.2 * 0.9 * 0.98, i1 = 1.2 * 1.2 + 0.9 * 0.9 + 0.98 * 0.98;
    const auto [mu, lambda] = lame(20e3, 0.499);
    const double tissue = mu / 2 * (i1 - 3) - mu * std::log(j) + lambda / 2 * (j - 1) * (j - 1);
    physics::FemMaterial material{.youngModulus = 20e3, .poissonRatio = 0.499};
    CHECK(storedBy(f, material) == Approx(volume(kBlock) * tissue).epsilon(1e-9));
    material.relaxation = {{.share = 0.6, .time = 0.1}}; // what the term holds counts for nothing
    material.poissonRatio = 0.4;
    const auto [muAt, lambdaAt] = lame(20e3, 0.4);
    const double lasting = 0.4 * (muAt / 2 * (i1 - 3) - muAt * std::log(j) + lambdaAt / 2 * (j - 1) * (j - 1));
    CHECK(storedBy(f, material) == Approx(volume(kBlock) * lasting).epsilon(1e-9));
    material.relaxation = {};
    material.poissonRatio = 0.499;
    material.fibres = {{.stiffness = 30e3, .exponent = 2.0, .direction = physics::Along{{1, 0, 0}}}};
    const double e = 1.2 * 1.2 - 1.0, fibres = 30e3 / 4.0 * (std::exp(2.0 * e * e) - 1.0);
    CHECK(storedBy(f, material) == Approx(volume(kBlock) * (tissue + fibres)).epsilon(1e-9));
}

TEST_CASE("springs store half their stiffness times the square of what they are longer")
{
    const geometry::TetMesh mesh = tetrahedronMesh();
    Stage stage;
    physics::SoftBodyDef def = freeBody(mesh);
    def.material = physics::MassSpringMaterial{.stiffness = 50.0};
    stage.add(def);
    stage.step(0.0);
    CHECK(energyNow(stage).elastic == 0.0);
    for (Vec3& x : stage.soft().x) x = 1.1 * x;
    CHECK(energyNow(stage).elastic == Approx(0.5 * 50.0 * 0.01 * (3.0 * 1.0 + 3.0 * 2.0)).epsilon(1e-12));
}

TEST_CASE("a shell stores what stretching and bending it takes")
{
    constexpr double thickness = 1e-3, modulus = 100e3, nu = 0.3, width = 0.1, depth = 0.05;
    const physics::ShellMaterial material{.youngModulus = modulus, .poissonRatio = nu, .thickness = thickness};
    Stage stage;
    physics::SoftBodyDef def{.mesh = shared(sheetMesh({40, 20}, width, depth, 0.0, true)), .material = material};
    stage.add(def);
    stage.step(0.0);
    const std::vector<Vec3> flat = stage.soft().x;
    CHECK(std::abs(energyNow(stage).elastic) < 1e-15);

    for (Vec3& x : stage.soft().x) x = {1.1 * x.x, 0.97 * x.y, 0.0};
    const double mu = modulus / (2 * (1 + nu)), q = 1 - 2 * nu, t = 1.1 * 1.1 + 0.97 * 0.97,
                 a = std::pow(1.1 * 0.97, 2.0);
    const double density = mu / 2 * (t - 2 + (1 + q) * (1 - a) / (q + a));
    CHECK(energyNow(stage).elastic == Approx(width * depth * thickness * density).epsilon(1e-9));

    constexpr double radius = 0.05; // rolled up around y, which stretches nothing
    for (std::size_t i = 0; i < flat.size(); ++i) {
        const double angle = flat[i].x / radius;
        stage.soft().x[i] = {radius * std::sin(angle), flat[i].y, radius * (1 - std::cos(angle))};
    }
    const double rigidity = modulus * std::pow(thickness, 3.0) / (12 * (1 - nu * nu));
    CHECK(energyNow(stage).elastic == Approx(width * depth * rigidity / (2 * radius * radius)).epsilon(0.03));
}

TEST_CASE("a rod stores what stretching, bending and twisting it takes, and moves by its spin as well")
{
    constexpr double radius = 1e-3, modulus = 1e9, nu = 0.25, length = 0.1;
    const double area = kPi * radius * radius, second = area * radius * radius / 4;
    physics::RodBodyDef def{.points = {{0, 0, 0}, {length, 0, 0}}, .spacing = 1e-3, .radius = radius};
    def.youngModulus = modulus;
    def.poissonRatio = nu;
    {
        Stage stage;
        stage.add(def);
        stage.step(0.0);
        CHECK(energyNow(stage).elastic == 0.0);
        for (Vec3& x : stage.soft().x) x = 1.02 * x;
        CHECK(energyNow(stage).elastic == Approx(0.5 * modulus * area * 0.02 * 0.02 * length).epsilon(1e-9));
    }
    {
        Stage stage;
        physics::RodBodyDef twisted = def;
        twisted.twist = 3.0;
        stage.add(twisted);
        stage.step(0.0);
        const double torsion = modulus / (2 * (1 + nu)) * 2 * second; // from the middle of the first edge on
        CHECK(energyNow(stage).elastic == Approx(0.5 * torsion * 9.0 / (length - 1e-3)).epsilon(1e-9));
    }
    {
        Stage stage;
        physics::RodBodyDef ring = def;
        ring.closed = true;
        ring.points.clear();
        constexpr int corners = 100;
        const double around = length / (2 * kPi);
        for (int i = 0; i < corners; ++i)
            ring.points.push_back(
                {around * std::cos(2 * kPi * i / corners), around * std::sin(2 * kPi * i / corners), 0});
        ring.spacing.reset();
        stage.add(ring);
        stage.step(0.0);
        const double bent = 0.5 * modulus * second / (around * around) * length;
        CHECK(energyNow(stage).elastic == Approx(bent).epsilon(0.005));
        for (double& spin : stage.soft().rod.spins) spin = 7.0;
        CHECK(energyNow(stage).kinetic == Approx(0.5 * 1000.0 * 2 * second * length * 49.0).epsilon(0.001));
    }
}

TEST_CASE("a piece that was removed has no energy")
{
    Stage stage;
    stage.post(physics::SetGravity{{0, -9.81, 0}});
    geometry::TetMesh mesh = tetrahedronMesh();
    for (const Vec3 x : tetrahedronMesh().nodes) mesh.nodes.push_back(x + Vec3{5, 0, 0});
    mesh.tetrahedra.push_back({4, 5, 6, 7});
    physics::SoftBodyDef def = freeBody(std::move(mesh));
    def.gravity = true;
    def.dynamicTopology = true;
    stage.add(def);
    stage.step(0.0);
    const double whole = energyNow(stage).gravitational;
    REQUIRE(stage.model().pieces.size() == 2);
    stage.soft().x[1].x += 0.1;
    stage.soft().x[5].x += 0.1; // both halves are strained alike
    const double stored = energyNow(stage).elastic;
    REQUIRE(stored > 0.0);
    stage.post(physics::RemovePiece{{1}, stage.model().pieces[1].number});
    stage.step(0.0);
    CHECK(energyNow(stage).elastic == Approx(0.5 * stored).epsilon(1e-9));
    CHECK(energyNow(stage).gravitational == Approx(0.5 * whole).epsilon(1e-9));
}

TEST_CASE("a rigid body that flies and spins has the kinetic energy of both")
{
    Stage stage;
    stage.post(physics::SetGravity{{0, 0, -9.81}});
    physics::RigidBodyDef def = boxBody(); // 1 kg; its origin is a corner
    def.gravity = true;
    def.velocity = {3, 0, 0};
    def.angularVelocity = {0, 0, 20};
    stage.add(def);
    stage.step(0.0);
    const double about = (0.2 * 0.2 + 0.1 * 0.1) / 12.0;
    CHECK(energyNow(stage).kinetic == Approx(0.5 * 9.0 + 0.5 * about * 400.0).epsilon(1e-9));
    CHECK(energyNow(stage).gravitational == Approx(9.81 * 0.025).epsilon(1e-9));
    CHECK(energyNow(stage).elastic == 0.0);
    const double before = sumOf(energyNow(stage));
    stage.run(100, 1e-3);
    CHECK(sumOf(energyNow(stage)) == Approx(before - 0.5 * 9.81 * 9.81 * 0.1 * 1e-3).epsilon(1e-6));
}

TEST_CASE("what is told its motion, and what gravity leaves alone, has no such energy")
{
    Stage stage;
    stage.post(physics::SetGravity{{0, -9.81, 0}});
    physics::RigidBodyDef told = boxBody();
    told.dynamic = false;
    told.gravity = true;
    stage.add(told);
    stage.step(0.0);
    stage.post(physics::SetPose{{1}, 0, {{0, 0.005, 0}, {}}});
    stage.step(1e-3);
    const MechanicalEnergy energy = energyNow(stage);
    CHECK(energy.kinetic == 0.0);
    CHECK(energy.gravitational == 0.0);

    Stage joints;
    joints.post(physics::SetGravity{{0, -9.81, 0}});
    physics::RigidBodyDef jaw = jawBody(physics::JointPosition{0.5});
    jaw.gravity = true;
    joints.add(jaw);
    joints.run(20, 1e-3);
    REQUIRE(joint(joints).now.velocity != 0.0);
    CHECK(energyNow(joints).kinetic == 0.0);
    CHECK(energyNow(joints).gravitational == 0.0);

    Stage floating;
    floating.post(physics::SetGravity{{0, -9.81, 0}});
    physics::SoftBodyDef weightless = freeBody(boxMesh({2, 2, 2}, kBlock, 0.2));
    weightless.pose.position = {0, 1, 0};
    floating.add(weightless);
    floating.step(1e-3);
    CHECK(energyNow(floating).gravitational == 0.0);
    CHECK_THROWS_WITH(stage.world.energyOf({2}), "mechanicalEnergy: body 2 is there only after the next step");
}

TEST_CASE("a pendulum of two links with a drive keeps its energy, to the order of the steps")
{
    // The difference is that of the velocities, which are those in the middle of a step.
    const auto largestChange = [](double dt) {
        Stage stage;
        stage.post(physics::SetGravity{{0, -9.81, 0}});
        physics::RigidBodyDef def = jawBody(physics::JointForce{});
        def.gravity = true;
        physics::JointDef second = def.articulation.joints[0];
        second.parent = 1;
        second.child = 2;
        second.parentOffset = {{kArm, 0, 0}, {}};
        second.inertia = 1e-5;
        def.articulation.joints.push_back(second);
        stage.add(def);
        stage.step(0.0);
        const double start = sumOf(energyNow(stage)), scale = 2.0 * kJawMass * 9.81 * kArm;
        double most = 0.0;
        for (int i = 0; i < static_cast<int>(std::lround(2.0 / dt)); ++i) {
            stage.step(dt);
            most = std::max(most, std::abs(sumOf(energyNow(stage)) - start) / scale);
        }
        CHECK(energyNow(stage).kinetic > 0.0);
        return most;
    };
    const double coarse = largestChange(1e-3), fine = largestChange(5e-4);
    CHECK(coarse < 0.05);
    CHECK(fine == Approx(0.5 * coarse).epsilon(0.2));
}

} // namespace mechanical_energy_test
