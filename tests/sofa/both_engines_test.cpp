#include "sofa/sofa_stage.h"

// Scenes of tests/verification that need no contact, with either engine and against the same closed forms.
namespace both_engines_test {

using namespace filasofia;
using namespace filasofia::physics;
using namespace filasofia::sofa_test;

namespace {

/// [kg] A quarter of each tetrahedron's mass at each of its corners.
std::vector<double> lumped(const geometry::TetMesh& mesh, double density)
{
    std::vector<double> masses(mesh.nodes.size());
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        for (const int node : mesh.tetrahedra[t])
            masses[static_cast<std::size_t>(node)] += density * signedVolume(mesh, static_cast<int>(t)) / 4.0;
    return masses;
}

/// [s] The period of a rigid body of these masses on a hinge along z, for a swing of this amplitude [rad].
double pendulumPeriod(const geometry::TetMesh& mesh, Vec3 hinge, double gravity, double amplitude)
{
    const std::vector<double> masses = lumped(mesh, 1.0);
    double inertia = 0.0;
    Vec3 moment;
    for (std::size_t i = 0; i < masses.size(); ++i) {
        const Vec3 arm{mesh.nodes[i].x - hinge.x, mesh.nodes[i].y - hinge.y, 0};
        inertia += masses[i] * lengthSquared(arm);
        moment += masses[i] * arm;
    }
    return 2 * M_PI * std::sqrt(inertia / (gravity * length(moment))) * (1 + amplitude * amplitude / 16);
}

constexpr double kLength = 1.0, kHeight = 0.1, kYoung = 1e6, kPoisson = 0.3, kLoad = 0.1; // [m] [m] [Pa] [-] [N]

/// Deflection of the end of a cantilever of square section under a shear load there: bending and shear (Timoshenko
/// 1921, with Cowper's 1966 shear coefficient for a rectangle).
double timoshenko()
{
    const double area = kHeight * kHeight, inertia = area * area / 12.0, shear = kYoung / (2 * (1 + kPoisson));
    const double kappa = 10 * (1 + kPoisson) / (12 + 11 * kPoisson);
    return kLoad * kLength * kLength * kLength / (3 * kYoung * inertia) + kLoad * kLength / (kappa * area * shear);
}

/// [m] That of a bar with n cells through its height, loaded evenly on its end face, at rest.
double deflection(const std::string& engine, int n)
{
    const auto mesh = bar(8 * n, n, n, {kLength, kHeight, kHeight});
    SoftBodyDef def{.name = "beam",
                    .mesh = mesh,
                    .material = FemMaterial{.youngModulus = kYoung, .poissonRatio = kPoisson, .law = Corotational{}},
                    .gravity = false,
                    .solver = Cholesky{},
                    .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1e-9, 1, 1}}}}};
    std::vector<int> end;
    for (std::size_t i = 0; i < mesh->nodes.size(); ++i)
        if (mesh->nodes[i].x > kLength - 1e-9) end.push_back(static_cast<int>(i));
    for (const int node : end)
        def.forces.push_back({.node = node, .force = {0, -kLoad / static_cast<double>(end.size()), 0}});
    const auto server = serverWith(engine, 1.0);
    const BodyId body = server->add(def);
    steps(*server, 40, 1.0); // long steps damp every swing
    double sum = 0.0;
    for (const int node : end) {
        const auto at = static_cast<std::size_t>(node);
        sum += mesh->nodes[at].y - server->latest()->softBody(body)->positions[at].y;
    }
    return sum / static_cast<double>(end.size());
}

} // namespace

TEST_CASE("with either engine bodies fall as backward Euler says")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    CAPTURE(engine);
    const auto server = serverWith(engine, 4e-3);
    SoftBodyDef soft{.name = "cube",
                     .mesh = bar(2, 2, 2, {0.02, 0.02, 0.02}),
                     .material = FemMaterial{.law = Corotational{}},
                     .rayleigh = {.mass = 0.0, .stiffness = 0.0}};
    RigidBodyDef rigid{.name = "ball", .dynamic = true, .mass = GivenInertia{.mass = 0.2}};
    const BodyId cube = server->add(soft), ball = server->add(rigid);
    steps(*server, 100, 4e-3);
    const auto frame = server->latest();
    const double way = 0.5 * 9.81 * 16e-6 * 100 * 101;
    CHECK(frame->softBody(cube)->positions[0].y == Approx(-way).epsilon(1e-6));
    CHECK(frame->rigidBody(ball)->poses[0].position.y == Approx(-way).epsilon(1e-9));
}

TEST_CASE("with either engine a stiff bar on a hinge swings with the period of a pendulum")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    CAPTURE(engine);
    constexpr double amplitude = 0.05, dt = 1e-3; // [rad] [s]
    const auto mesh = bar(8, 2, 2, {0.08, 0.02, 0.02});
    const Vec3 hinge{0, 0.01, 0};
    const auto server = serverWith(engine, dt, 9.81 * Vec3{std::cos(amplitude), -std::sin(amplitude), 0});
    SoftBodyDef def{.name = "bar",
                    .mesh = mesh,
                    .material = FemMaterial{.youngModulus = 1e7, .poissonRatio = 0.3, .law = Corotational{}},
                    .rayleigh = {.mass = 0.0, .stiffness = 0.0},
                    .solver = Cholesky{},
                    .attachments = {{.box = geometry::Box{{-1, 0.0099, -1}, {1e-9, 0.0101, 1}}}}};
    const BodyId body = server->add(def);
    std::vector<double> crossings; // [s] times when it hangs along gravity
    double before = amplitude;
    for (int i = 1; crossings.size() < 3 && i < 2000; ++i) {
        server->step(dt);
        const Vec3 end = server->latest()->softBody(body)->positions.back() - Vec3{0, 0.01, 0};
        const Vec3 atRest = mesh->nodes.back() - hinge;
        const double angle = std::atan2(end.y, end.x) - std::atan2(atRest.y, atRest.x) + amplitude;
        if (before * angle < 0) crossings.push_back(dt * (i - angle / (angle - before)));
        before = angle;
    }
    REQUIRE(crossings.size() == 3);
    const double period = pendulumPeriod(*mesh, hinge, 9.81, amplitude);
    CHECK(crossings[2] - crossings[0] == Approx(period).epsilon(5e-3));
}

TEST_CASE("with either engine a cantilever's deflection converges to Timoshenko's")
{
    const double theory = timoshenko();
    double coarse[2], fine[2];
    int e = 0;
    for (const std::string engine : {"native", "sofa"}) {
        coarse[e] = deflection(engine, 2) / theory;
        fine[e] = deflection(engine, 4) / theory;
        CAPTURE(engine, coarse[e], fine[e]);
        CHECK(std::abs(fine[e] - 1) < 0.45 * std::abs(coarse[e] - 1));
        CHECK(fine[e] == Approx(1.0).epsilon(0.15));
        ++e;
    }
    CHECK(fine[1] == Approx(fine[0]).epsilon(1e-3));
}

} // namespace both_engines_test
