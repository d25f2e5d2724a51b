#include "filasofia/engine/body/pins.h"
#include "filasofia/engine/build/build_body.h"

#include "engine/sheets.h"
#include "verification/verification.h"

namespace shell_verification_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

SoftModel modelOf(const geometry::TriangleMesh& mesh, const ShellMaterial& material, const std::vector<int>& pinned)
{
    SoftBodyDef def{.mesh = shared(mesh), .material = material, .rayleigh = {0.0, 0.0}, .solver = Cholesky{}};
    if (!pinned.empty()) def.attachments = {{.nodes = pinned}};
    const auto built = buildBody(def, 1e-3);
    return std::move(dynamic_cast<BuiltSoftBody&>(*built).body.model);
}

/// Where a shell is at rest under loads that may depend on its shape [N]. Long steps, in which inertia only holds the
/// motions that nothing else holds, each from rest: Newton's method with the step's tangent.
template <class Loads> std::vector<Vec3> restOf(const SoftModel& model, const Loads& loads, double dt = 100.0)
{
    AssembledSystem system(model);
    SoftState state = stateAtStart(model);
    std::vector<Vec3> dv(model.rest.size());
    double first = 0.0;
    for (int iteration = 0; iteration < 400; ++iteration) {
        std::fill(dv.begin(), dv.end(), Vec3{});
        assembleMatrix(model, loads(state.x), dt, 1.0, state, system);
        solve(model, dt, 1.0, state.v, system, dv);
        double change = 0.0;
        for (std::size_t i = 0; i < dv.size(); ++i) {
            state.x[i] += dt * dv[i];
            change = std::max(change, dt * length(dv[i]));
        }
        first = std::max(first, change);
        if (change < 1e-8 * first) return state.x;
    }
    FAIL("no state of rest was found");
    return {};
}

/// A plate of millimetres whose first `columns` columns are held, and the sinking of its free end under a force there,
/// relative to that of a beam.
double cantilever(int cells, double nu, double width, double jitter, bool mixed)
{
    constexpr double length = 0.1, thickness = 1e-3, young = 1e6, force = 1e-7;
    const double cell = length / cells;
    const int across = std::max(2, static_cast<int>(std::lround(width / cell)));
    geometry::TriangleMesh mesh = sheetMesh({cells + 1, across}, length + cell, width, jitter, mixed);
    std::vector<int> held;
    for (int i = 0; i < 2 * (across + 1); ++i) {
        held.push_back(i);
        mesh.vertices[static_cast<std::size_t>(i)].x = i <= across ? 0.0 : cell;
        mesh.vertices[static_cast<std::size_t>(i)].y = i % (across + 1) * width / across;
    }
    const SoftModel model = modelOf(mesh, {.youngModulus = young, .poissonRatio = nu, .thickness = thickness}, held);
    std::vector<Vec3> loads(mesh.vertices.size());
    double sum = 0.0;
    const std::size_t end = mesh.vertices.size() - static_cast<std::size_t>(across) - 1;
    for (std::size_t i = end; i < loads.size(); ++i)
        loads[i].z = (i == end || i + 1 == loads.size() ? 0.5 : 1.0) * force / across;
    const std::vector<Vec3> x = restOf(model, [&](const std::vector<Vec3>&) { return loads; });
    for (std::size_t i = end; i < loads.size(); ++i) sum += loads[i].z / force * x[i].z;
    const double inertia = width * std::pow(thickness, 3) / 12.0;
    return sum / (force * std::pow(length, 3) / (3.0 * young * inertia));
}

/// The sinking of the middle of a round plate under a uniform load, relative to Kirchhoff's. `clamped`: the rim cannot
/// turn; otherwise it is supported.
double roundPlate(int rings, double nu, bool clamped, double jitter)
{
    constexpr double radius = 0.05, thickness = 1e-3, young = 1e6, pressure = 1e-4;
    const int all = rings + (clamped ? 1 : 0);
    geometry::TriangleMesh mesh = discMesh(all, radius * all / rings);
    std::mt19937 random(3);
    std::vector<int> held;
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        const Vec3 shift = jitter * radius / rings * randomVec3(random, 1.0);
        if (length(mesh.vertices[i]) > radius * (1.0 - 0.5 / rings))
            held.push_back(static_cast<int>(i));
        else if (i > 0)
            mesh.vertices[i] += Vec3{shift.x, shift.y, 0.0};
    }
    const SoftModel model = modelOf(mesh, {.youngModulus = young, .poissonRatio = nu, .thickness = thickness}, held);
    std::vector<Vec3> loads(mesh.vertices.size());
    for (const MembraneElement& each : model.shell.membranes)
        for (int node : each.nodes) loads[static_cast<std::size_t>(node)].z += pressure * each.area / 3.0;
    const std::vector<Vec3> x = restOf(model, [&](const std::vector<Vec3>&) { return loads; });
    const double exact = pressure * std::pow(radius, 4) / (64.0 * plateRigidity(young, nu, thickness)) *
                         (clamped ? 1.0 : (5.0 + nu) / (1.0 + nu));
    return x[0].z / exact;
}

} // namespace

TEST_CASE("a strip of membrane under tension stretches and narrows as a neo-Hookean strip, to a stretch of two")
{
    constexpr double young = 30e3, thickness = 0.5e-3, width = 0.02;
    double worst = 0.0;
    for (double nu : {0.0, 0.3, 0.49}) {
        const geometry::TriangleMesh mesh = sheetMesh({10, 4}, 0.05, width, 0.2, true);
        const SoftModel model =
            modelOf(mesh, {.youngModulus = young, .poissonRatio = nu, .thickness = thickness, .bendingScale = 0.0}, {});
        const double mu = young / (2.0 * (1.0 + nu)), q = 1.0 - 2.0 * nu;
        for (double stretch : {1.2, 2.0}) {
            // No stress across: a2 = ((1 + q) s - q) / s^2 is the square of the narrowing, and P = mu (s - a2 / s).
            const double narrow2 = ((1.0 + q) * stretch - q) / (stretch * stretch);
            const double force = mu * (stretch - narrow2 / stretch) * thickness * width;
            std::vector<Vec3> loads(mesh.vertices.size());
            for (std::size_t k = 0; k < 5; ++k) {
                const double share = (k == 0 || k == 4 ? 0.5 : 1.0) * force / 4.0;
                loads[k].x = -share;
                loads[loads.size() - 5 + k].x = share;
            }
            const std::vector<Vec3> x = restOf(model, [&](const std::vector<Vec3>&) { return loads; });
            const double along = distance(x[0], x[x.size() - 5]) / 0.05, across = distance(x[0], x[4]) / width;
            worst = std::max({worst, std::abs(along / stretch - 1.0), std::abs(across / std::sqrt(narrow2) - 1.0)});
        }
    }
    verify("shell: strip of membrane, stretch of 2: relative error of length and width", worst, 1e-3);
}

TEST_CASE("an irregular membrane that is stretched at its rim alike in both directions is stretched so everywhere")
{
    geometry::TriangleMesh mesh = sheetMesh({6, 6}, 0.1, 0.1, 0.3, true);
    std::vector<int> rim;
    for (int i = 0; i < 49; ++i)
        if (i / 7 == 0 || i / 7 == 6 || i % 7 == 0 || i % 7 == 6) rim.push_back(i);
    SoftModel model = modelOf(mesh, {}, rim);
    std::vector<Vec3> expected = mesh.vertices;
    for (Vec3& each : expected) each = 1.7 * each + Vec3{0, 0, 0.3 * each.x};
    AssembledSystem system(model);
    SoftState state = stateAtStart(model);
    for (int node : rim) state.x[static_cast<std::size_t>(node)] = expected[static_cast<std::size_t>(node)];
    std::vector<Vec3> dv(state.x.size());
    const std::vector<Vec3> none(state.x.size());
    for (int iteration = 0; iteration < 100; ++iteration) {
        std::fill(dv.begin(), dv.end(), Vec3{});
        assembleMatrix(model, none, 100.0, 1.0, state, system);
        solve(model, 100.0, 1.0, state.v, system, dv);
        for (std::size_t i = 0; i < dv.size(); ++i) state.x[i] += 100.0 * dv[i];
    }
    double worst = 0.0;
    for (std::size_t i = 0; i < expected.size(); ++i) worst = std::max(worst, distance(state.x[i], expected[i]));
    verify("shell: patch test, stretched by 1.7 and tilted: largest error over the size of the sheet", worst / 0.1,
           1e-9);
}

TEST_CASE("an inflated spherical membrane obeys Laplace's law at large stretch")
{
    constexpr double young = 30e3, thickness = 0.3e-3, radius = 0.03;
    double worst = 0.0;
    for (double nu : {0.3}) {
        const geometry::TriangleMesh mesh = *geometry::shapes::sphere(radius, 24);
        const SoftModel model =
            modelOf(mesh, {.youngModulus = young, .poissonRatio = nu, .thickness = thickness, .bendingScale = 0.0}, {});
        const double mu = young / (2.0 * (1.0 + nu)), q = 1.0 - 2.0 * nu, stretch = 1.25;
        const double growth = (1.0 + q) / (q + std::pow(stretch, 4));
        const double stress = mu * (1.0 - growth * growth * stretch * stretch); // second Piola-Kirchhoff
        const double pressure = 2.0 * thickness * stress / (stretch * radius);  // p = 2 t S / (s R)
        const auto loads = [&](const std::vector<Vec3>& x) {
            std::vector<Vec3> forces(x.size());
            for (const auto& [a, b, c] : model.surface) {
                const Vec3 push = pressure / 6.0 * cross(x[b] - x[a], x[c] - x[a]);
                for (int node : {a, b, c}) forces[static_cast<std::size_t>(node)] += push;
            }
            return forces;
        };
        const std::vector<Vec3> x = restOf(model, loads, 0.1);
        double mean = 0.0;
        for (const Vec3& each : x) mean += length(each) / radius / static_cast<double>(x.size());
        worst = std::max(worst, std::abs(mean / stretch - 1.0));
    }
    verify("shell: inflated sphere, stretch of 1.25: relative error of the stretch", worst, 2e-3);
}

// Slopes belong to triangles, so a plate is held half a cell before its free part: an error of the first order, which
// two meshes tell. Irregular meshes also bend too stiffly, however fine they are.
TEST_CASE("a cantilever plate converges to the closed form, and on irregular meshes to nearly that")
{
    for (double jitter : {0.0, 0.25}) {
        const double coarse = cantilever(20, 0.0, 0.03, jitter, false), fine = cantilever(40, 0.0, 0.03, jitter, false);
        const std::string mesh = jitter > 0.0 ? "irregular, " : "";
        tell("shell: cantilever, " + mesh + "20 cells: sinking over that of a beam", coarse);
        tell("shell: cantilever, " + mesh + "40 cells: sinking over that of a beam", fine);
        verify("shell: cantilever, " + mesh + "extrapolated: relative error", std::abs(2.0 * fine - coarse - 1.0),
               jitter > 0.0 ? 0.2 : 2e-3);
    }
    tell("shell: cantilever of alternating, irregular diagonals, 40 cells: sinking over that of a beam",
         cantilever(40, 0.0, 0.03, 0.25, true));
    verify("shell: narrow cantilever of nu = 0.45, 60 cells: relative error",
           std::abs(cantilever(60, 0.45, 0.01, 0.0, false) - 1.0), 0.05);
}

TEST_CASE("a round plate under a uniform load converges to Kirchhoff's closed form, clamped and supported")
{
    for (bool clamped : {true, false})
        for (double jitter : {0.0, 0.25}) {
            const double coarse = roundPlate(8, 0.3, clamped, jitter), fine = roundPlate(16, 0.3, clamped, jitter);
            const std::string plate =
                text("shell: round plate, ", clamped ? "clamped" : "supported", jitter > 0.0 ? ", irregular" : "");
            tell(plate + ", 8 rings: sinking over Kirchhoff's", coarse);
            tell(plate + ", 16 rings: sinking over Kirchhoff's", fine);
            verify(plate + ", extrapolated: relative error", std::abs((clamped ? 2.0 * fine - coarse : fine) - 1.0),
                   jitter > 0.0 ? 0.15 : 0.01);
        }
}

} // namespace shell_verification_test
