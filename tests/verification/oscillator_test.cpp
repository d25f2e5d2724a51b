#include "verification/verification.h"

#include <complex>
#include <functional>
#include <numbers>

namespace oscillator_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

constexpr double kMass = 0.2, kStiffness = 45.0; // [kg] per node, [N/m] per spring

geometry::TetMesh regularTetrahedron() { return {{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}, {{0, 2, 1, 3}}}; }

/// A tetrahedron on four pin springs, displaced: every node is the same harmonic oscillator.
Stage pinned(const Integrator& integrator)
{
    Stage stage;
    SoftBodyDef def = freeBody(regularTetrahedron());
    def.material = FemMaterial{.youngModulus = 1e-3}; // undeformed: its stiffness must not limit the explicit step
    def.mass = TotalMass{4 * kMass};
    def.integrator = integrator;
    def.solver = Cholesky{};
    def.attachments = {{.nodes = {0, 1, 2, 3}, .stiffness = kStiffness}};
    stage.add(def);
    stage.step(0.0);
    for (Vec3& x : stage.soft().x) x.y += 0.5;
    return stage;
}

/// A regular tetrahedron of springs, inflated and released: it breathes. The square of its angular frequency is exactly
/// 4 k / m, because its shape is kept and each spring is linear in its length.
Stage breathing(const Integrator& integrator, double damping)
{
    Stage stage;
    SoftBodyDef def = freeBody(regularTetrahedron());
    def.material = MassSpringMaterial{.stiffness = kStiffness, .damping = damping};
    def.mass = TotalMass{4 * kMass};
    def.integrator = integrator;
    def.solver = Cholesky{};
    stage.add(def);
    stage.step(0.0);
    for (Vec3& x : stage.soft().x) x *= 1.3;
    return stage;
}

double aside(Stage& stage) { return stage.soft().x[2].y - stage.model().rest[2].y; }
double swollen(Stage& stage) { return length(stage.soft().x[1]) - length(stage.model().rest[1]); }

/// The largest difference between a stage's elongation and expected(step), over the first elongation.
double worst(Stage stage, double (*elongation)(Stage&), double dt, int steps,
             const std::function<double(int)>& expected)
{
    const double start = elongation(stage);
    double highest = 0.0;
    for (int n = 1; n <= steps; ++n) {
        stage.step(dt);
        highest = std::max(highest, std::abs(elongation(stage) - start * expected(n)) / start);
    }
    return highest;
}

/// The angular frequency [rad/s] of a stage that swings, from 20 half periods between zero crossings. Each crossing is
/// interpolated linearly, as the curve is straight there.
double measuredFrequency(Stage stage, double (*elongation)(Stage&), double dt)
{
    constexpr int kHalves = 20;
    std::vector<double> crossings;
    double before = elongation(stage);
    for (int n = 0; static_cast<int>(crossings.size()) <= kHalves; ++n) {
        REQUIRE(n < 100000);
        stage.step(dt);
        const double now = elongation(stage);
        if ((now > 0.0) != (before > 0.0)) crossings.push_back((n + before / (before - now)) * dt);
        before = now;
    }
    return kHalves * std::numbers::pi / (crossings.back() - crossings.front());
}

/// Elongation after n steps of u' = v, v' = -w^2 u from (1, 0), in closed form.
double implicitEuler(double hw, int n) { return std::pow(std::complex(1.0, -hw), -n).real(); }
double explicitEuler(double hw, int n) { return std::pow(std::complex(1.0, hw), n).real(); }
double symplecticEuler(double hw, int n)
{
    const double angle = std::acos(1.0 - 0.5 * hw * hw); // per step: the frequency is off by the second order only
    return std::cos(n * angle) - std::tan(0.5 * angle) * std::sin(n * angle);
}

} // namespace

TEST_CASE("an oscillator on pin springs follows each integrator's closed form")
{
    const double w = std::sqrt(kStiffness / kMass), h = 0.01;
    verify("pin oscillator, implicit Euler against its closed form",
           worst(pinned(ImplicitEuler{}), aside, h, 300, [&](int n) { return implicitEuler(h * w, n); }), 1e-10);
    verify("pin oscillator, explicit Euler against its closed form",
           worst(pinned(ExplicitEuler{false}), aside, h, 100, [&](int n) { return explicitEuler(h * w, n); }), 1e-10);
    verify("pin oscillator, symplectic Euler against its closed form",
           worst(pinned(ExplicitEuler{true}), aside, h, 300, [&](int n) { return symplecticEuler(h * w, n); }), 1e-10);
}

TEST_CASE("a breathing tetrahedron of springs follows each integrator's closed form, at any amplitude")
{
    const double w = std::sqrt(4 * kStiffness / kMass), h = 0.005;
    verify("spring oscillator, implicit Euler against its closed form",
           worst(breathing(ImplicitEuler{}, 0), swollen, h, 300, [&](int n) { return implicitEuler(h * w, n); }),
           1e-10);
    verify("spring oscillator, symplectic Euler against its closed form",
           worst(breathing(ExplicitEuler{true}, 0), swollen, h, 300, [&](int n) { return symplecticEuler(h * w, n); }),
           1e-10);
}

TEST_CASE("dashpots damp a breathing tetrahedron as in implicit Euler's closed form")
{
    const double h = 0.005, k = 4 * kStiffness, c = 4 * 0.3;
    double u = 1.0, v = 0.0;
    const auto next = [&](int) {
        v += (h * (-k * u - c * v) - h * h * k * v) / (kMass + h * c + h * h * k);
        u += h * v;
        return u;
    };
    verify("spring oscillator with dashpots, implicit Euler against its closed form",
           worst(breathing(ImplicitEuler{}, 0.3), swollen, h, 300, next), 1e-10);
    CHECK(std::abs(u) < 1e-3); // the damping had an effect
}

TEST_CASE("symplectic Euler converges to the true oscillation with first order in dt, its frequency with second order")
{
    const double w = std::sqrt(kStiffness / kMass);
    const auto error = [&](double h) {
        return worst(pinned(ExplicitEuler{true}), aside, h, static_cast<int>(std::lround(2.0 / h)),
                     [&](int n) { return std::cos(n * h * w); });
    };
    const double coarse = error(0.001), fine = error(0.0005);
    verifyWithin("pin oscillator, symplectic Euler against the true motion, ratio of errors at dt and dt / 2",
                 coarse / fine, 1.8, 2.2);
    const auto detuning = [&](double h) { return measuredFrequency(pinned(ExplicitEuler{true}), aside, h) / w - 1.0; };
    const double far = detuning(0.004), near = detuning(0.002);
    verifyWithin("pin oscillator, symplectic Euler, ratio of frequency errors at dt and dt / 2", far / near, 3.9, 4.1);
    // From the closed form's series: the frequency is too high by the fraction (h w)^2 / 24.
    verifyWithin("pin oscillator, symplectic Euler, frequency error over (dt w)^2 / 24",
                 near / (0.002 * 0.002 * w * w / 24.0), 0.98, 1.02);
}

} // namespace oscillator_test
