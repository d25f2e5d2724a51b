#include "verification/verification.h"

namespace cut_cantilever_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

constexpr double kLength = 0.4, kHeight = 0.08, kWidth = 0.04, kLoad = 0.02; // [m] [m] [m] [N]
constexpr int kCells = 4;                                                    ///< through half of the height

/// A bar along x, pinned at x = 0, from y = `low` to kHeight.
SoftBodyDef bar(double low, double jitter)
{
    const double height = kHeight - low;
    const int tall = static_cast<int>(std::lround(2.0 * kCells * height / kHeight));
    geometry::TetMesh mesh = boxMesh({40, tall, 4}, {kLength, height, kWidth}, jitter);
    for (Vec3& p : mesh.nodes) p.y += low;
    SoftBodyDef def = freeBody(mesh);
    def.material = FemMaterial{.youngModulus = 1e5, .poissonRatio = 0.3};
    def.solver = Cholesky{};
    def.attachments = {{.nodes = nodesWhere(mesh, [](Vec3 p) { return p.x == 0.0; })}};
    def.dynamicTopology = true;
    return def;
}

/// [m] Deflection of the end of the part above y = `low` under a load there with the parabolic distribution that shear
/// has in a beam. Static, by Cholesky.
double deflection(const SoftModel& model, double low)
{
    std::vector<double> share(model.rest.size());
    const double height = kHeight - low;
    double sum = 0.0;
    for (const geometry::Triangle& t : model.surface) {
        const auto at = [&](int k) { return model.rest[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])]; };
        const Vec3 a = at(0), b = at(1), c = at(2), middle = 1.0 / 3.0 * (a + b + c);
        if (std::min({a.x, b.x, c.x}) < kLength - 1e-9 || middle.y < low) continue;
        const double y = 2.0 * (middle.y - low) / height - 1.0;
        const double traction = 0.5 * length(cross(b - a, c - a)) * (1.0 - y * y);
        for (int node : t) share[static_cast<std::size_t>(node)] += traction / 3.0;
        sum += traction;
    }
    std::vector<Vec3> loads, x = model.rest;
    for (double& each : share) loads.push_back({0, -kLoad * (each /= sum), 0});
    solveStatic(model, loads, x, 1e-6);
    double down = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) down += share[i] * (model.rest[i].y - x[i].y);
    return down;
}

SoftModel uncut(double low)
{
    Stage stage;
    stage.add(bar(low, 0.0));
    stage.step(0.0);
    return stage.model();
}

/// The model of a bar at rest after a blade has passed through all of it from end to end at y = `at`.
SoftModel cutAlong(double at, double jitter, int& pieces)
{
    Stage stage;
    SoftBodyDef def = bar(0.0, jitter);
    def.solver = ConjugateGradient{}; // at rest there is nothing to solve
    stage.add(def);
    // The blade stands upright across the bar with its edge ahead: a rectangle of 4 cm along x, wider than the bar
    // along z.
    const double z = 0.75 * kWidth;
    const TriangleMeshSource mesh = std::make_shared<const geometry::TriangleMesh>(
        geometry::TriangleMesh{.vertices = {{0, 0, -z}, {-0.04, 0, -z}, {-0.04, 0, z}, {0, 0, z}},
                               .triangles = {{0, 1, 2}, {0, 2, 3}},
                               .uv = {}});
    const auto poseAt = [&](double x) { return Pose{.position = {x, at, 0.5 * kWidth}}; };
    const BodyId blade = stage.add(
        RigidBodyDef{.elements = {poseAt(-0.05)}, .collision = {{.mesh = mesh, .proximity = 0, .cutting = true}}});
    pieces = 1;
    for (double x = -0.05; x < kLength + 0.1; x += 2e-3) {
        stage.post(SetPose{blade, 0, poseAt(x)});
        const StepReport report = stage.step(1e-3);
        CHECK(report.flags == 0);
        for (const Rupture& rupture : report.topology.ruptures) pieces += static_cast<int>(rupture.detached.size());
    }
    return stage.model();
}

} // namespace

TEST_CASE("a cantilever whose lower half was cut off bends as one of half the height")
{
    const double half = 0.5 * kHeight;
    const double expected = deflection(uncut(half), half);
    tell("cutting, cantilever of half the height, its deflection over that of the whole",
         expected / deflection(uncut(0.0), 0.0));
    for (const double jitter : {0.0, 0.2}) {
        int pieces = 0;
        const SoftModel cut = cutAlong(half, jitter, pieces);
        CHECK(pieces == 2);
        verify(text("cutting, cantilever cut in half along its length, deflection against an uncut one of half the "
                    "height, inner nodes moved by ",
                    jitter, " of a cell, relative"),
               std::abs(deflection(cut, half) / expected - 1.0), 0.05);
    }
}

} // namespace cut_cantilever_test
