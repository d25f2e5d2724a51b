#include "filasofia/engine/rupture/tear.h"

#include "engine/rupture/meshes.h"

#include "filasofia/engine/rupture/pieces.h"
#include "filasofia/engine/rupture/stress.h"
#include "filasofia/engine/rupture/tet_shape.h"
#include "filasofia/math/polar.h"
#include "filasofia/math/svd.h"

#include <random>

namespace tear_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

Mat3 randomMatrix(std::mt19937& random)
{
    std::uniform_real_distribution<double> u(-1, 1);
    Mat3 m;
    for (int r = 0; r < 3; ++r) m[r] = {u(random), u(random), u(random)};
    return m;
}

constexpr double kMu = 2000.0, kLambda = 8000.0; // [Pa]

/// Linear elasticity of the bar, fixed at one end and pulled at the other, solved by conjugate gradients on
/// displacements.
class PulledBar {
public:
    explicit PulledBar(const EditableMesh& mesh) : mesh_(mesh.data()) {}

    /// Stress of every element, and in `held` the fixed nodes.
    std::vector<Mat3> solve(Vec3 pull, std::vector<std::uint8_t>& held)
    {
        const std::size_t n = mesh_.rest.size();
        held.assign(n, 0);
        std::vector<Vec3> u(n);
        for (std::size_t i = 0; i < n; ++i)
            if (std::abs(mesh_.rest[i].x) > 0.02 - 1e-9) {
                held[i] = 1;
                if (mesh_.rest[i].x > 0.0) u[i] = pull;
            }
        std::vector<Vec3> r = forces(u), p, q;
        for (std::size_t i = 0; i < n; ++i) r[i] = held[i] ? Vec3{} : -r[i];
        p = r;
        double rr = sum(r, r);
        const double stop = 1e-10 * rr;
        for (int k = 0; k < 2000 && rr > stop; ++k) {
            q = forces(p);
            for (std::size_t i = 0; i < n; ++i)
                if (held[i]) q[i] = {};
            const double alpha = rr / sum(p, q);
            for (std::size_t i = 0; i < n; ++i) u[i] += alpha * p[i], r[i] -= alpha * q[i];
            const double next = sum(r, r);
            for (std::size_t i = 0; i < n; ++i) p[i] = r[i] + (next / rr) * p[i];
            rr = next;
        }
        std::vector<Mat3> stresses;
        for (std::size_t t = 0; t < mesh_.tetrahedra.size(); ++t) stresses.push_back(stress(t, u));
        return stresses;
    }

private:
    static double sum(const std::vector<Vec3>& a, const std::vector<Vec3>& b)
    {
        double s = 0.0;
        for (std::size_t i = 0; i < a.size(); ++i) s += dot(a[i], b[i]);
        return s;
    }
    /// The gradients of the first three corners' shape functions, then the volume.
    [[nodiscard]] std::array<Vec3, 4> gradients(std::size_t t) const
    {
        const auto p = cornersOf(mesh_.tetrahedra[t], mesh_.rest);
        const Mat3 g = inverse(Mat3::columns(p[1] - p[0], p[2] - p[0], p[3] - p[0]));
        return {-(g[0] + g[1] + g[2]), g[0], g[1], g[2]};
    }
    [[nodiscard]] Mat3 stress(std::size_t t, const std::vector<Vec3>& u) const
    {
        const auto g = gradients(t);
        Mat3 d;
        for (int k = 0; k < 4; ++k) d += outer(u[mesh_.tetrahedra[t][k]], g[k]);
        const double l = kLambda * trace(d);
        return kMu * (d + transpose(d)) + Mat3::diagonal({l, l, l});
    }
    [[nodiscard]] std::vector<Vec3> forces(const std::vector<Vec3>& u) const
    {
        std::vector<Vec3> f(u.size());
        for (std::size_t t = 0; t < mesh_.tetrahedra.size(); ++t) {
            const auto g = gradients(t);
            const Mat3 s = restVolume(mesh_, static_cast<int>(t)) * stress(t, u);
            for (int k = 0; k < 4; ++k) f[mesh_.tetrahedra[t][k]] += s * g[k];
        }
        for (std::size_t i = 0; i < u.size(); ++i) f[i] += 1e-6 * u[i]; // keeps debris in place
        return f;
    }

    const MeshTopology& mesh_;
};

} // namespace

TEST_CASE("the largest principal stress is the largest eigenvalue, with its direction, and below its bound")
{
    std::mt19937 random(1);
    for (int i = 0; i < 1000; ++i) {
        const Mat3 a = randomMatrix(random), s = 1e4 * (a + transpose(a));
        const PrincipalStress p = principalStress(s);
        CHECK(length(s * p.direction - p.value * p.direction) < 1e-10);
        CHECK(length(p.direction) == Approx(1.0).epsilon(1e-14));
        CHECK(principalStressBound(s) >= p.value);
        const Mat3 shifted = s + Mat3::diagonal({1e5, 1e5, 1e5}); // positive definite: singular values are eigenvalues
        CHECK(p.value + 1e5 == Approx(svd(shifted).sigma.x).epsilon(1e-13));
    }
    CHECK(principalStress(Mat3::diagonal({5, 7, 6})).direction == Vec3{0, 1, 0});
    CHECK(principalStress({}).value == 0.0);
    CHECK(principalStressBound(Mat3::diagonal({7, -2, -2})) == Approx(7.0));
    CHECK(principalStress(Mat3::diagonal({-3, -2, -4})).value == -2.0);
}

TEST_CASE("the virial stress of springs is the work of their tensions per volume and strain")
{
    std::mt19937 random(3);
    std::uniform_real_distribution<double> u(-1, 1);
    const std::array<Vec3, 4> x{Vec3{0, 0, 0}, {0.01, 0, 0.001}, {0.002, 0.012, 0}, {0, 0.001, 0.009}};
    std::array<double, 6> tensions{};
    for (double& t : tensions) t = u(random);
    const Mat3 sigma = virialStress(x, tensions);
    CHECK(frobeniusNorm(sigma - transpose(sigma)) < 1e-9);
    const double volume = geometry::signedVolume(x[0], x[1], x[2], x[3]);
    const Mat3 a = 1e-6 * randomMatrix(random), strain = 0.5 * (a + transpose(a));
    double work = 0.0;
    for (int e = 0; e < 6; ++e) {
        const auto [i, j] = geometry::kTetrahedronEdges[e];
        const Vec3 d = x[j] - x[i];
        work += tensions[e] * (length(d + strain * d) - length(d));
    }
    CHECK(volume * contract(sigma, strain) == Approx(work).epsilon(1e-4));
    CHECK(virialStress({x[0], x[2], x[1], x[3]}, tensions) == Mat3{});
}

TEST_CASE("tissue in uniform tension tears above its threshold and not below, across the tension")
{
    for (const double over : {0.99, 1.01}) {
        EditableMesh mesh = bar();
        const Vec3 d = normalized(Vec3{1, 0.3, -0.2});
        const std::vector<Mat3> stresses(mesh.tetrahedra(), 5000.0 * over * outer(d, d));
        Tearing tearing;
        const RuptureReport report = tearing.step(mesh, stresses, {}, {.threshold = 5000.0});
        CHECK(tearing.torn().size() == (over > 1.0 ? 4u : 0u));
        CHECK((report.openedFaces > 0) == (over > 1.0));
        for (const Tear& tear : tearing.torn()) {
            CHECK(tear.stress == Approx(5000.0 * over));
            CHECK(std::abs(dot(tear.direction, d)) == Approx(1.0));
        }
        CHECK(faultsOf(mesh) == "");
    }
}

TEST_CASE("a bar that is pulled tears in two for every mesh and pull, and is valid after every tear")
{
    for (int run = 0; run < 6; ++run) {
        CAPTURE(run);
        geometry::TetMesh block = *geometry::shapes::block({0.04, 0.02, 0.02}, {8, 4, 4});
        std::mt19937 random(static_cast<unsigned>(run));
        std::uniform_real_distribution<double> u(-1, 1);
        if (run > 0) // an irregular mesh
            for (Vec3& p : block.nodes) {
                const auto inner = [](double x, double end) { return std::abs(x) < end - 1e-9 ? 1e-3 : 0.0; };
                p += Vec3{inner(p.x, 0.02) * u(random), inner(p.y, 0.01) * u(random), inner(p.z, 0.01) * u(random)};
            }
        EditableMesh mesh(block);
        const double quality = std::min(0.15, worstQuality(mesh.data()));
        PulledBar elastic(mesh);
        frame::TopologyMirror mirror(mesh.data().tetrahedra);
        std::vector<Vec3> positions = mesh.data().rest;
        Pieces pieces(mesh.data());
        Tearing tearing;
        std::vector<std::uint8_t> held;
        const auto apart = [&] { // no piece reaches from end to end
            std::vector<int> ends(1000, 0);
            for (int t = 0; t < mesh.tetrahedra(); ++t)
                for (int n : mesh.data().tetrahedra[t])
                    if (const double x = mesh.data().rest[n].x; std::abs(x) > 0.02 - 1e-9)
                        ends[pieces.ofTetrahedron()[t]] |= x > 0 ? 1 : 2;
            return std::ranges::find(ends, 3) == ends.end();
        };
        const Vec3 pull = run % 3 == 0 ? Vec3{0.004, 0, 0} : 0.004 * Vec3{1, 0.7 * u(random), 0.7 * u(random)};
        int steps = 0;
        std::size_t tears = 0;
        for (; !apart() && steps < 400; ++steps) {
            const std::vector<Mat3> stresses = elastic.solve(pull, held);
            const RuptureReport report =
                tearing.step(mesh, stresses, held, {.threshold = 200.0, .maxTears = 1, .maxTries = 4});
            tears += tearing.torn().size();
            CHECK(faultsOf(mesh, quality) == "");
            CHECK(report.repairBisections == 0);
            const frame::TopologyEdit edit = mesh.takeEdit({1});
            frame::followNodes(edit, positions);
            mirror.apply(edit);
            CHECK(checkMirror(mesh.data(), mirror, positions).empty());
            pieces.update(mesh.data(), edit);
        }
        CHECK(apart());
        CHECK(tears > 2);
        CHECK(tears < 200);
        CHECK(mesh.tetrahedra() == 768); // no element is deleted or added
    }
}

TEST_CASE("a node that cannot open is counted, and the next one is tried")
{
    EditableMesh mesh = bar(2);
    RuptureReport report;
    std::mt19937 random(4);
    int opened = 0;
    for (int i = 0; i < 400; ++i) {
        const Mat3 a = randomMatrix(random);
        opened += tearAt(mesh, static_cast<int>(random() % mesh.nodes()), normalized(a[0]), report) ? 1 : 0;
        REQUIRE(faultsOf(mesh) == "");
    }
    CHECK(opened > 20);
    CHECK(opened + report.refused[static_cast<int>(RuptureRefusal::TearClosed)] == 400);
    CHECK(mesh.tetrahedra() == 96);
}

} // namespace tear_test
