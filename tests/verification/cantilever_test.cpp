#include "verification/verification.h"

namespace cantilever_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

constexpr double kLength = 1.0, kHeight = 0.1, kYoung = 1e6, kPoisson = 0.3, kLoad = 0.1; // [m] [m] [Pa] [-] [N]

/// Deflection of the end of a cantilever of square section under a shear load there: bending and shear (Timoshenko
/// 1921, with Cowper's 1966 shear coefficient for a rectangle).
double timoshenko()
{
    const double area = kHeight * kHeight, inertia = area * area / 12.0, shear = kYoung / (2 * (1 + kPoisson));
    const double kappa = 10 * (1 + kPoisson) / (12 + 11 * kPoisson);
    return kLoad * kLength * kLength * kLength / (3 * kYoung * inertia) + kLoad * kLength / (kappa * area * shear);
}

/// A bar along x with n cells through its height and width, pinned at x = 0, with the load on its end face.
struct Cantilever {
    Stage stage;
    std::vector<double> share; ///< [-] fraction of the load per node; sums to 1

    explicit Cantilever(int n)
    {
        const geometry::TetMesh mesh = boxMesh({10 * n, n, n}, {kLength, kHeight, kHeight});
        SoftBodyDef def = freeBody(mesh);
        def.material = FemMaterial{.youngModulus = kYoung, .poissonRatio = kPoisson};
        def.solver = Cholesky{};
        def.attachments = {{.nodes = nodesWhere(mesh, [](Vec3 p) { return p.x == 0.0; })}};
        stage.add(def);
        stage.step(0.0);
        // The traction on the end face is that of shear in a beam, a parabola over the height.
        share.resize(mesh.nodes.size());
        double sum = 0.0;
        for (const geometry::Triangle& t : stage.model().surface) {
            const Vec3 a = mesh.nodes[t[0]], b = mesh.nodes[t[1]], c = mesh.nodes[t[2]];
            if (a.x < kLength - 1e-9 || b.x < kLength - 1e-9 || c.x < kLength - 1e-9) continue;
            const double y = 2.0 * (a.y + b.y + c.y) / 3.0 / kHeight - 1.0;
            const double traction = 0.5 * length(cross(b - a, c - a)) * (1.0 - y * y);
            for (int node : t) share[node] += traction / 3.0;
            sum += traction;
        }
        for (double& each : share) each /= sum;
    }

    std::vector<Vec3> loads() const
    {
        std::vector<Vec3> loads;
        for (double each : share) loads.push_back({0, -each * kLoad, 0});
        return loads;
    }
    /// [m] Deflection of the loaded face, weighted by the load, so that it is the load's work per unit of force.
    double deflection(const std::vector<Vec3>& x)
    {
        double sum = 0.0;
        for (std::size_t i = 0; i < x.size(); ++i) sum += share[i] * (stage.model().rest[i].y - x[i].y);
        return sum;
    }
    double staticDeflection()
    {
        std::vector<Vec3> x = stage.model().rest;
        solveStatic(stage.model(), loads(), x, 1e-5);
        return deflection(x);
    }
};

} // namespace

TEST_CASE("a cantilever's deflection converges to Timoshenko's")
{
    const double theory = timoshenko();
    verify("cantilever, Timoshenko's deflection over length", theory / kLength, 0.01);
    std::vector<double> found;
    for (int n : {2, 4, 8}) {
        found.push_back(Cantilever(n).staticDeflection());
        tell(text("cantilever, ", n, " cells through the height, deflection over Timoshenko's"), found.back() / theory);
    }
    CHECK(found[0] < found[1]); // linear elements are too stiff, the coarser the more
    CHECK(found[1] < found[2]);
    CHECK(found[2] < 1.01 * theory);
    // The error of linear elements in bending adds to the stiffness, with second order in the cell size. The stiffness,
    // not the deflection, at three sizes therefore gives order and limit (Richardson 1911; Aitken's form).
    const double first = 1 / found[0] - 1 / found[1], second = 1 / found[1] - 1 / found[2];
    verifyWithin("cantilever, observed order of convergence of the stiffness", std::log2(first / second), 1.7, 2.3);
    const double limit = 1 / (1 / found[2] - second * second / (first - second));
    verify("cantilever, extrapolated deflection against Timoshenko's, relative", std::abs(limit / theory - 1), 0.02);
}

TEST_CASE("a cantilever stepped to rest agrees with the static solution")
{
    Cantilever bar(2);
    const double expected = bar.staticDeflection();
    std::vector<NodalForce> forces;
    const std::vector<Vec3> loads = bar.loads();
    for (std::size_t i = 0; i < loads.size(); ++i) forces.push_back({static_cast<int>(i), loads[i]});
    bar.stage.post(SetForces{BodyId{1}, forces});
    bar.stage.model().rayleigh = {.mass = 1.0, .stiffness = 0.01};
    bar.stage.run(300, 0.1);
    verify("cantilever, stepped to rest against static, relative",
           std::abs(bar.deflection(bar.stage.soft().x) / expected - 1), 1e-6);
}

} // namespace cantilever_test
