#include "verification/verification.h"

#include <numbers>

namespace space_order_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

constexpr std::array<double, 3> kSize{1.0, 0.8, 0.9}; // [m]
constexpr Lame kMaterial = lame(1e6, 0.3);
constexpr double kAmplitude = 1e-6; // [m] so small that the geometry does not change

/// The manufactured displacement: component c is a product of sines, zero on the whole surface of the box.
constexpr std::array<std::array<int, 3>, 3> kWaves{{{1, 1, 1}, {2, 1, 1}, {1, 1, 1}}};
constexpr std::array<double, 3> kParts{1.0, -0.3, 0.7};

/// Component c at p, differentiated along each axis as often as `along` counts.
double field(int c, Vec3 p, std::array<int, 3> along = {})
{
    double value = kAmplitude * kParts[c];
    for (int d = 0; d < 3; ++d) {
        const double k = kWaves[c][d] * std::numbers::pi / kSize[d];
        value *= std::pow(k, along[d]) * std::sin(k * p[d] + 0.5 * std::numbers::pi * along[d]);
    }
    return value;
}

double derivative(int c, Vec3 p, int i, int j)
{
    std::array<int, 3> along{};
    ++along[i];
    ++along[j];
    return field(c, p, along);
}

/// [N/m^3] The body force that balances the field: -(mu laplace u + (lambda + mu) grad div u) (Navier).
Vec3 bodyForce(Vec3 p)
{
    Vec3 force;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            force[i] -=
                kMaterial.mu * derivative(i, p, j, j) + (kMaterial.lambda + kMaterial.mu) * derivative(j, p, i, j);
    return force;
}

/// The box in n^3 cells, distorted smoothly inside, so that no symmetry makes the result better than it is.
geometry::TetMesh distortedBox(int n)
{
    geometry::TetMesh mesh = boxMesh({n, n, n}, {kSize[0], kSize[1], kSize[2]});
    for (Vec3& p : mesh.nodes) {
        double bump = 0.06;
        for (int d = 0; d < 3; ++d) bump *= std::sin(std::numbers::pi * p[d] / kSize[d]);
        p += bump * Vec3{1.0, -0.7, 0.5} * (1.0 + p.x - p.y);
    }
    return mesh;
}

struct Errors {
    double displacement = 0.0, gradient = 0.0; ///< [-] root mean squares over the box, relative
};

/// Errors of the engine's state by Keast's rule of 4 points, exact for squares of linear functions.
Errors errors(Stage& stage)
{
    const SoftModel& model = stage.model();
    constexpr double far = 0.5854101966249685, near = 0.1381966011250105;
    Errors sums, sizes;
    for (const FemElement& e : model.elements) {
        Corners rest, u;
        for (int i = 0; i < 4; ++i) rest[i] = model.rest[e.nodes[i]], u[i] = stage.soft().x[e.nodes[i]] - rest[i];
        const Mat3 strain = gradient(e, u);
        for (int q = 0; q < 4; ++q) {
            Vec3 p, found;
            for (int i = 0; i < 4; ++i) p += (i == q ? far : near) * rest[i], found += (i == q ? far : near) * u[i];
            for (int c = 0; c < 3; ++c) {
                const double exact = field(c, p), weight = e.volume / 4.0;
                sums.displacement += weight * (found[c] - exact) * (found[c] - exact);
                sizes.displacement += weight * exact * exact;
                for (int d = 0; d < 3; ++d) {
                    const double slope = field(c, p, {d == 0, d == 1, d == 2});
                    sums.gradient += weight * (strain[c][d] - slope) * (strain[c][d] - slope);
                    sizes.gradient += weight * slope * slope;
                }
            }
        }
    }
    return {std::sqrt(sums.displacement / sizes.displacement), std::sqrt(sums.gradient / sizes.gradient)};
}

Errors solve(int n, const ElasticLaw& law = NeoHookean{})
{
    const geometry::TetMesh mesh = distortedBox(n);
    SoftBodyDef def = freeBody(mesh);
    def.material = FemMaterial{.youngModulus = 1e6, .poissonRatio = 0.3, .law = law};
    def.solver = Cholesky{};
    def.attachments = {{.nodes = nodesWhere(mesh, [](Vec3 p) {
                            for (int d = 0; d < 3; ++d)
                                if (std::min(p[d], kSize[d] - p[d]) < 1e-9) return true;
                            return false;
                        })}};
    // The body force by the corner rule, which has second order like the elements.
    std::vector<double> volumes(mesh.nodes.size());
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        for (int node : mesh.tetrahedra[t]) volumes[node] += 0.25 * geometry::signedVolume(mesh, static_cast<int>(t));
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
        def.forces.push_back({static_cast<int>(i), volumes[i] * bodyForce(mesh.nodes[i])});
    Stage stage;
    stage.add(def);
    CHECK(stage.run(2, 1e3).flags == 0);
    return errors(stage);
}

} // namespace

TEST_CASE("linear tetrahedra have second order in the cell size")
{
    std::vector<Errors> found;
    for (int n : {4, 8, 16}) {
        found.push_back(solve(n));
        tell(text("manufactured solution, ", n, " cells, error of the displacement"), found.back().displacement);
        tell(text("manufactured solution, ", n, " cells, error of its gradient"), found.back().gradient);
    }
    for (std::size_t i : {1, 2}) {
        const double halved = std::log2(found[i - 1].displacement / found[i].displacement);
        const double slope = std::log2(found[i - 1].gradient / found[i].gradient);
        verifyWithin(text("manufactured solution, order of the displacement, pair ", i), halved, 1.8, 2.2);
        verifyWithin(text("manufactured solution, order of its gradient, pair ", i), slope, 0.9, 1.1);
    }
}

TEST_CASE("every law: linear tetrahedra have second order in the cell size")
{
    for (const NamedLaw& each : everyLaw()) {
        const Errors coarse = solve(4, each.law), fine = solve(8, each.law);
        verifyWithin(text("manufactured solution, ", each.name, ", order of the displacement"),
                     std::log2(coarse.displacement / fine.displacement), 1.8, 2.2);
    }
}

} // namespace space_order_test
