#include "filasofia/engine/body/elements.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/geometry/split_solid.h"

#include "verification/verification.h"

/// A thick hollow sphere whose inner surface is pushed outwards, and a bar that is bent, against solutions that need no
/// tetrahedra.
namespace inflation_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;
namespace shapes = filasofia::geometry::shapes;

namespace {

constexpr double kInner = 0.01, kOuter = 0.02, kYoung = 10e3, kNu = 0.3; // [m] [m] [Pa] [-]

/// The sphere in layers of prisms, each split into three tetrahedra; the nodes of the inner surface come first.
geometry::TetMesh hollowSphere(int quarter, int layers)
{
    const auto surface = shapes::sphere(1.0, quarter);
    const auto count = static_cast<std::int64_t>(surface->vertices.size());
    geometry::TetMesh mesh;
    for (int layer = 0; layer <= layers; ++layer)
        for (const Vec3& p : surface->vertices) mesh.nodes.push_back((kInner + (kOuter - kInner) * layer / layers) * p);
    for (int layer = 0; layer < layers; ++layer)
        for (const geometry::Triangle& t : surface->triangles) {
            std::vector<std::int64_t> prism;
            for (const std::int64_t base : {layer * count, (layer + 1) * count})
                for (int node : t) prism.push_back(base + node);
            geometry::splitSolid(geometry::Solid::Prism, prism, [&](const std::array<std::int64_t, 4>& part) {
                geometry::Tetrahedron& each = mesh.tetrahedra.emplace_back();
                for (std::size_t k = 0; k < 4; ++k) each[k] = static_cast<int>(part[k]);
            });
        }
    return mesh;
}

/// What holds the inner surface at a multiple of its radius, and where the outer one is then.
struct Inflated {
    double pressure = 0.0; ///< [Pa] on the inner surface
    double outer = 0.0;    ///< [m] radius
};

Inflated inflatedMesh(const ElasticLaw& law, double stretch, int quarter, int layers)
{
    const auto mesh = shared(hollowSphere(quarter, layers));
    SoftBodyDef def = freeBody(*mesh);
    def.material = FemMaterial{.youngModulus = kYoung, .poissonRatio = kNu, .law = law};
    def.solver = Cholesky{};
    def.attachments = {{.nodes = nodesWhere(*mesh, [](Vec3 p) { return length(p) < kInner + 1e-9; })}};
    Stage stage;
    stage.add(def);
    stage.step(0.0);
    const SoftModel& model = stage.model();
    std::vector<Vec3> x = model.rest;
    for (const double now : {0.5 * (1.0 + stretch), stretch}) {
        const double swept = std::pow(kInner, 3) * (std::pow(now, 3) - 1.0);
        for (std::size_t i = 0; i < x.size(); ++i) { // as if no volume were lost
            const double r = length(model.rest[i]);
            x[i] = std::cbrt(r * r * r + swept) / r * model.rest[i];
        }
        solveStatic(model, std::vector<Vec3>(x.size()), x, 1e-4);
    }
    double outward = 0.0;
    for (const FemElement& e : model.elements) {
        const Corners corners = cornersOf(e.nodes, x);
        const Corners pull = forcesOf(law, e, corners);
        for (std::size_t k = 0; k < 4; ++k)
            if (model.pins.hard[static_cast<std::size_t>(e.nodes[k])]) outward -= dot(pull[k], normalized(corners[k]));
    }
    Inflated out{.pressure = outward / (4.0 * std::numbers::pi * std::pow(stretch * kInner, 2))};
    double nodes = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i)
        if (length(model.rest[i]) > kOuter - 1e-9) out.outer += length(x[i]), nodes += 1.0;
    out.outer /= nodes;
    return out;
}

/// The same from the radial equation dP_r/dR + 2 (P_r - P_t) / R = 0, by shooting: the stretch r' at the inner surface
/// is sought for which the outer one is free. Runge-Kutta of order 4.
Inflated inflatedSphere(const ElasticLaw& law, double stretch)
{
    const Lame material = lame(kYoung, kNu);
    const auto stresses = [&](double radial, double hoop) {
        const Mat3 p = stressAt(law, material, {Mat3::diagonal({radial, hoop, hoop}), Mat3::identity()});
        return std::array{p[0].x, p[1].y};
    };
    // The radial stretch at which the radial stress is this, at a hoop stretch.
    const auto radialOf = [&](double stress, double hoop) {
        double low = 0.6, high = 3.0; // St Venant-Kirchhoff's law softens below 0.58
        for (int k = 0; k < 60; ++k) {
            const double middle = 0.5 * (low + high);
            (stresses(middle, hoop)[0] < stress ? low : high) = middle;
        }
        return 0.5 * (low + high);
    };
    struct Point {
        double radius = 0.0, stress = 0.0;
    };
    const auto slope = [&](double at, Point p) {
        const double hoop = p.radius / at, radial = radialOf(p.stress, hoop);
        const auto [pr, pt] = stresses(radial, hoop);
        return Point{radial, -2.0 * (pr - pt) / at};
    };
    const auto outside = [&](double innerStress) {
        constexpr int kSteps = 60;
        const double h = (kOuter - kInner) / kSteps;
        Point p{stretch * kInner, innerStress};
        for (int i = 0; i < kSteps; ++i) {
            const double at = kInner + i * h;
            const auto moved = [&](Point d, double by) {
                return Point{p.radius + by * d.radius, p.stress + by * d.stress};
            };
            const Point a = slope(at, p), b = slope(at + 0.5 * h, moved(a, 0.5 * h));
            const Point c = slope(at + 0.5 * h, moved(b, 0.5 * h)), d = slope(at + h, moved(c, h));
            p.radius += h / 6.0 * (a.radius + 2 * b.radius + 2 * c.radius + d.radius);
            p.stress += h / 6.0 * (a.stress + 2 * b.stress + 2 * c.stress + d.stress);
        }
        return p;
    };
    double low = -10.0 * kYoung, high = 0.0;
    for (int k = 0; k < 50; ++k) {
        const double middle = 0.5 * (low + high);
        (outside(middle).stress < 0.0 ? low : high) = middle;
    }
    return {.pressure = -low / (stretch * stretch), .outer = outside(low).radius}; // per present area
}

} // namespace

TEST_CASE("the pressure that inflates a thick hollow sphere converges to that of the radial equation, with every law")
{
    const double small = 1.0001; // Lame's solution
    const double b3 = std::pow(kOuter / kInner, 3);
    const double lameStretch = (1 - 2 * kNu + 0.5 * (1 + kNu) * b3) / (kYoung * (b3 - 1));
    verify("radial equation against Lame's solution at small strain, relative error",
           std::abs(inflatedSphere(NeoHookean{}, small).pressure * lameStretch / (small - 1.0) - 1.0), 1e-3);
    for (const auto& [name, law] : everyLaw())
        verify(
            text("thick sphere, inner radius 1.2 times, 1,536 tetrahedra, ", name, ", relative error of the pressure"),
            std::abs(inflatedMesh(law, 1.2, 4, 4).pressure / inflatedSphere(law, 1.2).pressure - 1.0), 0.1);
    const Inflated expected = inflatedSphere(NeoHookean{}, 1.2);
    const Inflated coarse = inflatedMesh(NeoHookean{}, 1.2, 3, 3), fine = inflatedMesh(NeoHookean{}, 1.2, 6, 6);
    tell("the same, NeoHookean, 5,184 tetrahedra", std::abs(fine.pressure / expected.pressure - 1.0));
    tell("the same, outer radius over its change, less one", (fine.outer - expected.outer) / (expected.outer - kOuter));
    verifyWithin("the same, ratio of the errors of the outer radius when edges are halved",
                 (coarse.outer - expected.outer) / (fine.outer - expected.outer), 3.0, 5.0);
}

TEST_CASE("the moment that bends a bar converges to Young's modulus times curvature times the moment of its section")
{
    // Every node of the surface is moved as in pure bending without a Poisson effect: u = k (x z, 0, -x^2 / 2).
    const Vec3 size{0.08, 0.02, 0.02};
    const double curvature = 0.01, section = size.y * std::pow(size.z, 3) / 12.0;
    std::vector<double> errors;
    for (const int n : {2, 4, 8}) {
        geometry::TetMesh mesh = *shapes::block(size, {4 * n, n, n});
        const auto onEnd = [&](Vec3 p) { return std::abs(p.x) > 0.5 * size.x - 1e-9; };
        SoftBodyDef def = freeBody(mesh);
        def.material = FemMaterial{.youngModulus = kYoung, .poissonRatio = 0.0};
        def.solver = Cholesky{};
        def.attachments = {{.nodes = nodesWhere(mesh, onEnd)}};
        Stage stage;
        stage.add(def);
        stage.step(0.0);
        const SoftModel& model = stage.model();
        std::vector<Vec3> x = model.rest;
        for (Vec3& p : x) p += curvature * Vec3{p.x * p.z, 0.0, -0.5 * p.x * p.x};
        solveStatic(model, std::vector<Vec3>(x.size()), x, 1e-9);
        double moment = 0.0;
        for (const FemElement& e : model.elements) {
            const Corners corners = cornersOf(e.nodes, x);
            const Corners pull = forcesOf(NeoHookean{}, e, corners);
            for (std::size_t k = 0; k < 4; ++k) {
                const Vec3 rest = model.rest[static_cast<std::size_t>(e.nodes[k])];
                if (rest.x > 0.0 && onEnd(rest)) moment -= pull[k].x * rest.z;
            }
        }
        errors.push_back(moment / (kYoung * curvature * section) - 1.0);
        tell(text("bar in pure bending, ", n, " cells through its height, moment over E I k, less one"), errors.back());
    }
    for (std::size_t k = 1; k < errors.size(); ++k)
        verifyWithin("the same, ratio of the errors when edges are halved", errors[k - 1] / errors[k], 3.0, 5.0);
}

} // namespace inflation_test
