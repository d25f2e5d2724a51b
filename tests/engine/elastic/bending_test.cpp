#include "filasofia/engine/body/shell.h"

#include "engine/sheets.h"

namespace bending_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

/// A triangle with three neighbours, bent at rest.
struct Sample {
    BendingCorners rest{Vec3{0, 0, 0}, {1, 0, 0}, {0.3, 0.8, 0}, {1.1, 0.9, 0.3}, {-0.7, 0.6, -0.2}, {0.4, -0.9, 0.1}};
    BendingElement element;

    explicit Sample(const Hinged& hinged = {true, true, true}, double poissonRatio = 0.3)
    {
        std::array<int, 6> nodes{0, 1, 2, 3, 4, 5};
        for (std::size_t i = 0; i < 3; ++i)
            if (!hinged[i]) {
                nodes[3 + i] = nodes[i];
                rest[3 + i] = rest[i];
            }
        element = bendingOn(nodes, hinged, rest, poissonRatio);
        element.rigidity = 2.0;
    }
    [[nodiscard]] BendingCorners moved(std::mt19937& random, double size) const
    {
        BendingCorners x = rest;
        for (std::size_t i = 0; i < 6; ++i)
            x[i] = element.nodes[i] == static_cast<int>(i) ? rest[i] + randomVec3(random, size)
                                                           : x[static_cast<std::size_t>(element.nodes[i])];
        return x;
    }
};

BendingCorners numericForces(const BendingElement& element, const BendingCorners& x)
{
    constexpr double step = 1e-6;
    BendingCorners forces;
    for (std::size_t node = 0; node < 6; ++node)
        for (int i = 0; i < 3; ++i) {
            BendingCorners low = x, high = x;
            low[node][i] -= step;
            high[node][i] += step;
            forces[node][i] = -(bendingEnergy(element, high) - bendingEnergy(element, low)) / (2.0 * step);
        }
    return forces;
}

/// [J] The bending energy of a mesh when its nodes are lifted by z(x, y), per area, for D = 1. Bending is small.
template <class Height> double energyPerArea(const geometry::TriangleMesh& mesh, double nu, const Height& height)
{
    physics::ShellMaterial material{.youngModulus = 12.0 * (1.0 - nu * nu), .poissonRatio = nu, .thickness = 1.0};
    const Shell shell = makeShell(material, mesh.vertices, mesh.triangles);
    std::vector<Vec3> x = mesh.vertices;
    for (Vec3& each : x) each.z = height(each.x, each.y);
    double energy = 0.0, area = 0.0;
    // The rim has free edges, which bend less: only triangles with three neighbours, each of which has three, count.
    for (const BendingElement& bend : shell.bends) {
        const BendingCorners rest = vectorsAt(bend.nodes, mesh.vertices);
        bool inner = true;
        for (const Vec3& each : rest) inner = inner && each.x > 0.2 && each.x < 0.8 && each.y > 0.2 && each.y < 0.8;
        if (!inner) continue;
        energy += bendingEnergy(bend, vectorsAt(bend.nodes, x));
        area += 0.5 * length(cross(rest[1] - rest[0], rest[2] - rest[0]));
    }
    return energy / area;
}

} // namespace

TEST_CASE("the force of bending is minus the gradient of its energy, with one, two and three neighbours")
{
    std::mt19937 random(1);
    for (const Hinged& hinged : {Hinged{true, true, true}, {true, false, true}, {false, true, false}}) {
        const Sample sample(hinged);
        for (int k = 0; k < 40; ++k) {
            const BendingCorners x = sample.moved(random, k % 2 == 0 ? 0.05 : 0.3);
            const BendingCorners forces = bendingForces(sample.element, x), exact = numericForces(sample.element, x);
            for (std::size_t i = 0; i < 6; ++i) CHECK(distance(forces[i], exact[i]) < 1e-6 * (1.0 + length(exact[i])));
        }
    }
}

TEST_CASE("a sheet keeps the curvature that it has at rest, wherever it is and however it is turned")
{
    std::mt19937 random(2);
    const Sample sample;
    CHECK(std::abs(sample.element.restAngles[0]) > 0.1);
    for (int k = 0; k < 20; ++k) {
        const Quat turn = randomRotation(random);
        const Vec3 shift = randomVec3(random, 5.0);
        BendingCorners rigid = sample.rest, bent = sample.moved(random, 0.2), both = bent;
        for (Vec3& each : rigid) each = rotate(turn, each) + shift;
        for (Vec3& each : both) each = rotate(turn, each) + shift;
        CHECK(bendingEnergy(sample.element, rigid) < 1e-25);
        for (const Vec3& force : bendingForces(sample.element, rigid)) CHECK(length(force) < 1e-12);
        CHECK(bendingEnergy(sample.element, both) == Approx(bendingEnergy(sample.element, bent)));
    }
}

TEST_CASE("forces of bending cancel and have no torque")
{
    std::mt19937 random(3);
    const Sample sample;
    const BendingCorners x = sample.moved(random, 0.3), forces = bendingForces(sample.element, x);
    Vec3 sum, torque;
    for (std::size_t i = 0; i < 6; ++i) {
        sum += forces[i];
        torque += cross(x[i], forces[i]);
    }
    CHECK(length(forces[0]) > 0.1);
    CHECK(length(sum) < 1e-12);
    CHECK(length(torque) < 1e-12);
}

TEST_CASE("the tangent of bending is positive semi-definite, symmetric, and exact at rest")
{
    std::mt19937 random(4);
    const Sample sample;
    for (int k = 0; k < 20; ++k) {
        const BendingCorners x = k == 0 ? sample.rest : sample.moved(random, 0.3);
        const BendingTangent tangent = bendingTangent(sample.element, x);
        BendingCorners p;
        for (Vec3& each : p) each = randomVec3(random, 1.0);
        const BendingCorners product = stiffnessTimes(tangent, p);
        double work = 0.0;
        for (std::size_t i = 0; i < 6; ++i) work += dot(p[i], product[i]);
        CHECK(work >= 0.0);
        for (int i = 0; i < 6; ++i) {
            Vec3 row;
            for (int j = 0; j < 6; ++j) row += stiffnessBlock(tangent, i, j) * p[static_cast<std::size_t>(j)];
            CHECK(distance(row, product[static_cast<std::size_t>(i)]) < 1e-11);
        }
        if (k > 0) continue;
        constexpr double step = 1e-6;
        BendingCorners low = x, high = x;
        for (std::size_t i = 0; i < 6; ++i) {
            low[i] -= step * p[i];
            high[i] += step * p[i];
        }
        const BendingCorners a = bendingForces(sample.element, low), b = bendingForces(sample.element, high);
        for (std::size_t i = 0; i < 6; ++i)
            CHECK(distance(product[i], -1.0 / (2.0 * step) * (b[i] - a[i])) < 1e-6 * length(product[i]) + 1e-6);
    }
}

TEST_CASE("bending of flat, crushed and folded triangles is finite")
{
    const Sample sample;
    for (int which = 0; which < 4; ++which) {
        BendingCorners x = sample.rest;
        if (which == 0) x.fill({1, 1, 1});
        if (which == 1) x[2] = 0.5 * (x[0] + x[1]);
        if (which == 2) x[5] = x[2]; // folded onto the triangle
        if (which == 3) x[1] = x[2]; // an edge without a length
        for (const Vec3& force : bendingForces(sample.element, x)) CHECK(isFinite(force));
        CHECK(std::isfinite(bendingEnergy(sample.element, x)));
    }
}

TEST_CASE("a regular mesh has the energy of a plate in every constant curvature, whatever its Poisson ratio")
{
    constexpr double k = 1e-3;
    const geometry::TriangleMesh mesh = sheetMesh({20, 14}, 1.0, 1.0);
    for (double nu : {0.0, 0.3, 0.45}) {
        const auto energy = [&](const auto& height) { return energyPerArea(mesh, nu, height) / (0.5 * k * k); };
        CHECK(energy([&](double x, double) { return 0.5 * k * x * x; }) == Approx(1.0).epsilon(1e-4));
        CHECK(energy([&](double, double y) { return 0.5 * k * y * y; }) == Approx(1.0).epsilon(1e-4));
        CHECK(energy([&](double x, double y) { return 0.5 * k * (x * x + y * y); }) ==
              Approx(2.0 + 2.0 * nu).epsilon(1e-4));
        CHECK(energy([&](double x, double y) { return k * x * y; }) == Approx(2.0 - 2.0 * nu).epsilon(1e-4));
    }
}

TEST_CASE("on an irregular mesh the energy of constant curvature is at most a quarter above that of a plate")
{
    constexpr double k = 1e-3, nu = 0.3;
    const geometry::TriangleMesh mesh = sheetMesh({24, 24}, 1.0, 1.0, 0.25);
    const auto energy = [&](const auto& height) { return energyPerArea(mesh, nu, height) / (0.5 * k * k); };
    const double x = energy([&](double a, double) { return 0.5 * k * a * a; });
    const double dome = energy([&](double a, double b) { return 0.5 * k * (a * a + b * b); });
    const double saddle = energy([&](double a, double b) { return k * a * b; });
    for (double ratio : {x, dome / 2.6, saddle / 1.4}) {
        CHECK(ratio > 1.0);
        CHECK(ratio < 1.25);
    }
}

} // namespace bending_test
