#include "filasofia/geometry/shapes.h"
#include "filasofia/math/mat3.h"

#include "verification/verification.h"

#include <numbers>

/// Rings of muscle in the wall of a tube, whose families of fibres contract one after the other.
namespace peristalsis_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

constexpr double kYoung = 10e3, kNu = 0.4;             // [Pa] [-]
constexpr double kInner = 5e-3, kOuter = 7e-3;         // [m] radii
constexpr double kLength = 0.06, kRing = 0.005;        // [m] the tube's, and a ring's, shorter than the ball
constexpr double kFirst = 0.5 * (kLength - 4 * kRing); // [m] where the first ring begins

/// A tube along z in so many layers, parts of the circle and parts of its length.
std::shared_ptr<const geometry::TetMesh> tube(std::array<int, 3> n)
{
    std::vector<Vec3> line;
    for (int k = 0; k <= n[2]; ++k) line.push_back({0, 0, kLength * k / n[2]});
    return geometry::shapes::vessel(line, kInner, kOuter - kInner, {n[1], n[0]});
}

FibreFamily ring(int k)
{
    const double from = kFirst + k * kRing;
    return {.stiffness = 0.0,
            .direction = Around{.axis = {0, 0, 1}},
            .where = geometry::Box{{-1, -1, from}, {1, 1, from + kRing}}};
}

/// [-] By how much the inner radius of a long free tube shrinks if rings contract all along it with the stress T, at
/// small strain: u = T / (2 (lambda + 2 mu)) r ln r + A r + B / r and the strain e along the tube, with free surfaces
/// and no force along it.
double lumenShrinks(double stress)
{
    const Lame material = lame(kYoung, kNu);
    const double mu = material.mu, lambda = material.lambda;
    const double m = lambda + 2 * mu, c = stress / (2 * m);
    const double a = kInner, b = kOuter, area = 0.5 * (b * b - a * a);
    const auto radial = [&](double r) { return c * (m * (std::log(r) + 1) + lambda * std::log(r)); };
    // The integral of r (2 ln r + 1) over the wall, times c lambda, is what the first part adds to the force along it.
    const double force = c * lambda * (b * b * std::log(b) - a * a * std::log(a));
    const Mat3 equations{{{2 * (mu + lambda), -2 * mu / (a * a), lambda},
                          {2 * (mu + lambda), -2 * mu / (b * b), lambda},
                          {2 * lambda * area, 0.0, m * area}}};
    const Vec3 found = inverse(equations) * Vec3{-radial(a), -radial(b), -force};
    return -(c * std::log(a) + found.x + found.y / (a * a));
}

/// [m] mean distance from the axis of the inner nodes in the middle of the tube.
double lumen(const SoftModel& model, const std::vector<Vec3>& x)
{
    double sum = 0.0, count = 0.0;
    for (std::size_t n = 0; n < x.size(); ++n) {
        const Vec3 at = model.rest[n];
        if (std::hypot(at.x, at.y) > kInner + 1e-9 || std::abs(at.z - 0.5 * kLength) > 1e-9) continue;
        sum += std::hypot(x[n].x, x[n].y), count += 1.0;
    }
    return sum / count;
}

SoftBodyDef gut(std::array<int, 3> cells)
{
    return {.name = "gut",
            .mesh = tube(cells),
            .material = FemMaterial{.youngModulus = kYoung, .poissonRatio = kNu},
            .gravity = false};
}

} // namespace

TEST_CASE("peristalsis: rings of muscle narrow a tube as the formula of a thick tube says")
{
    constexpr double kStress = 20.0;
    std::vector<double> errors;
    for (const int n : {1, 2}) {
        SoftBodyDef def = gut({n, 12 * n, 12 * n});
        def.material = FemMaterial{.youngModulus = kYoung,
                                   .poissonRatio = kNu,
                                   .fibres = {{.stiffness = 0.0, .direction = Around{.axis = {0, 0, 1}}}}};
        def.mass = Density{10.0}; // with so long steps, it only keeps the tube from turning
        def.solver = Cholesky{};
        Stage stage;
        const BodyId id = stage.add(def);
        stage.post(SetFibreStress{id, 0, kStress});
        stage.run(5, 1.0);
        const double before = lumen(stage.model(), stage.model().rest);
        errors.push_back((1.0 - lumen(stage.model(), stage.soft().x) / before) / lumenShrinks(kStress) - 1.0);
        tell(text("peristalsis: rings contract, ", n, " layers, narrowing over that of a thick tube, less one"),
             errors.back());
    }
    tell("peristalsis: narrowing of a thick tube over T / E, that of a thin one",
         lumenShrinks(kStress) * kYoung / kStress);
    verify("peristalsis: the same, extrapolated, relative error", std::abs(errors[1] + (errors[1] - errors[0]) / 3.0),
           2e-2);
}

TEST_CASE("peristalsis: a wave of contraction carries a ball along a tube")
{
    SoftBodyDef def = gut({1, 12, 24});
    FemMaterial muscle{.youngModulus = kYoung, .poissonRatio = kNu};
    for (int k = 0; k < 4; ++k) muscle.fibres.push_back(ring(k));
    def.material = muscle;
    def.friction = 0.1;
    def.collision = {{}};
    def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1, 1e-9}}},
                       {.box = geometry::Box{{-1, -1, kLength - 1e-9}, {1, 1, 1}}}};
    RigidBodyDef bolus{.name = "bolus", .elements = {Pose{{0, 0, kFirst + kRing}, {}}}};
    bolus.mesh = geometry::shapes::sphere(0.95 * kInner, 6);
    bolus.dynamic = true;
    bolus.gravity = false;
    bolus.friction = 0.1;
    bolus.linearDamping = 50.0; // if nothing slowed it, the first ring would shoot it out
    bolus.collision = {{}};
    Stage stage;
    const BodyId id = stage.add(def);
    stage.add(bolus);
    const auto place = [&] { return stage.world.scene().rigid[0].state.poses[0].position.z; };
    constexpr double kStep = 5e-3, kBetween = 0.3, kPulse = 0.6; // [s]
    stage.run(40, kStep);
    const double before = place();
    CHECK(std::abs(before - (kFirst + kRing)) < 1e-4); // nothing moves it yet
    for (int step = 0; step < 320; ++step) {
        for (int k = 0; k < 4; ++k) {
            const double phase = std::clamp((step * kStep - k * kBetween) / kPulse, 0.0, 1.0);
            stage.post(SetFibreStress{id, k, 12e3 * std::pow(std::sin(std::numbers::pi * phase), 2)});
        }
        stage.step(kStep);
    }
    verifyWithin("peristalsis: a wave of four rings carries a ball [m]", place() - before, 0.015, 0.025);
}

} // namespace peristalsis_test
