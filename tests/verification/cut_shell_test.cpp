#include "engine/sheets.h"
#include "verification/verification.h"

#include <algorithm>
#include <ctime>

namespace cut_shell_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

constexpr double kLength = 0.08, kWidth = 0.02; // [m]
constexpr std::array<int, 2> kCells{32, 8};
constexpr double kCut = 0.55 * kWidth; ///< [m] between two rows of nodes

/// A strip along x from y = 0 on, clamped by its first two rows of nodes.
SoftBodyDef strip(double width, int across)
{
    const geometry::TriangleMesh mesh = sheetMesh({kCells[0], across}, kLength, width);
    SoftBodyDef def{.mesh = shared(mesh),
                    .material = ShellMaterial{.youngModulus = 100e3, .poissonRatio = 0.3, .thickness = 1e-3},
                    .rayleigh = {0.0, 0.0},
                    .gravity = false};
    def.attachments.push_back({});
    for (int i = 0; i < static_cast<int>(mesh.vertices.size()); ++i)
        if (mesh.vertices[static_cast<std::size_t>(i)].x < 1.5 * kLength / kCells[0])
            def.attachments[0].nodes.push_back(i);
    return def;
}

SoftModel uncut(double width, int across)
{
    Stage stage;
    stage.add(strip(width, across));
    stage.step(0.0);
    return stage.model();
}

/// The strip at rest after a blade has gone through it from end to end at y = kCut.
SoftModel cutAlong()
{
    Stage stage;
    SoftBodyDef def = strip(kWidth, kCells[1]);
    def.dynamicTopology = true;
    stage.add(def);
    const TriangleMeshSource mesh = std::make_shared<const geometry::TriangleMesh>(
        geometry::TriangleMesh{.vertices = {{0, 0, -0.01}, {0, 0, 0.01}, {-0.02, 0, 0.01}, {-0.02, 0, -0.01}},
                               .triangles = {{0, 1, 2}, {0, 2, 3}},
                               .uv = {}});
    const auto poseAt = [&](double x) { return Pose{.position = {x, kCut, 0}}; };
    const BodyId blade = stage.add(
        RigidBodyDef{.elements = {poseAt(-0.01)}, .collision = {{.mesh = mesh, .proximity = 0, .cutting = true}}});
    for (double x = -0.01; x < kLength + 0.04; x += 5e-4) {
        stage.post(SetPose{blade, 0, poseAt(x)});
        stage.step(1e-3);
    }
    return stage.model();
}

/// [m] How far the end of the part below y = `high` goes in a direction under a load there, by Newton's method and
/// Cholesky.
double deflection(const SoftModel& model, double high, Vec3 load)
{
    std::vector<double> share(model.rest.size());
    double sum = 0.0;
    for (const geometry::Triangle& t : model.surface)
        for (std::size_t k = 0; k < 3; ++k) {
            const auto a = static_cast<std::size_t>(t[k]), b = static_cast<std::size_t>(t[(k + 1) % 3]);
            const Vec3 p = model.rest[a], q = model.rest[b];
            const auto c = static_cast<std::size_t>(t[(k + 2) % 3]);
            if (std::min(p.x, q.x) < kLength - 1e-9 || std::max({p.y, q.y, model.rest[c].y}) > high + 0.1 * kWidth)
                continue;
            if (0.5 * (p.y + q.y) > high) continue;
            for (std::size_t node : {a, b}) share[node] += 0.5 * distance(p, q);
            sum += distance(p, q);
        }
    std::vector<Vec3> loads, x = model.rest;
    for (double& each : share) loads.push_back((each /= sum) * load);
    solveStatic(model, loads, x, 1e-8);
    double way = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) way += share[i] * dot(normalized(load), x[i] - model.rest[i]);
    return way;
}

} // namespace

TEST_CASE("the half of a strip that was cut along its length hangs and stretches as a strip of half the width")
{
    const SoftModel cut = cutAlong(), half = uncut(kCut, 4), whole = uncut(kWidth, kCells[1]);
    REQUIRE(cut.pieces.size() == 2);
    for (const auto& [what, load, least] :
         {std::tuple{"bends", Vec3{0, 0, -2e-5}, 1e-3}, {"stretches", Vec3{1e-2, 0, 0}, 1e-4}}) {
        const double narrow = deflection(half, kCut, load), wide = deflection(whole, kWidth, load);
        CHECK(narrow > least);
        verify(text("half of a cut strip ", what, ", relative to a strip of its width"),
               std::abs(deflection(cut, kCut, load) / narrow - 1.0), 0.06);
        CHECK(narrow / wide > 1.6); // the uncut strip of the whole width is another matter
    }
}

TEST_CASE("what a cut of a shell costs, printed")
{
    // The large one carries no load, as a test should be short.
    for (const auto& [cells, gravity] : {std::pair{std::array{30, 30}, -9.81}, {std::array{71, 71}, 0.0}}) {
        const double side = 0.06;
        Stage stage;
        SoftBodyDef def{.mesh = geometry::shapes::sheet(side, side, cells),
                        .material = ShellMaterial{.youngModulus = 50e3, .thickness = 0.5e-3},
                        .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1e-3 - side / 2, 1, 1}}},
                                        {.box = geometry::Box{{side / 2 - 1e-3, -1, -1}, {1, 1, 1}}}},
                        .collision = {{}},
                        .dynamicTopology = true};
        stage.add(def);
        const TriangleMeshSource mesh = std::make_shared<const geometry::TriangleMesh>(
            geometry::TriangleMesh{.vertices = {{0, -0.02, 0}, {0, 0.02, 0}, {0, 0.02, -0.02}, {0, -0.02, -0.02}},
                                   .triangles = {{0, 1, 2}, {0, 2, 3}},
                                   .uv = {}});
        const BodyId blade = stage.add(RigidBodyDef{.elements = {Pose{.position = {0.0015, 0, -0.035}}},
                                                    .collision = {{.mesh = mesh, .proximity = 0, .cutting = true}}});
        stage.post(SetGravity{{0, gravity, 0}});
        stage.step(0.0);
        const auto clock = [] {
            timespec now{};
            clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
            return std::int64_t{1000000000} * now.tv_sec + now.tv_nsec;
        };
        std::vector<double> whole, topology;
        const auto run = [&](int steps, double speed) {
            whole.clear();
            topology.clear();
            for (int i = 0; i < steps; ++i) {
                stage.post(SetPose{blade, 0, Pose{.position = {0.0015, 0, -0.035 + speed * i}}});
                const StepBudget budget{.now = clock};
                const StepInput in{.dt = 1e-3, .commands = stage.commands, .budget = &budget};
                const std::int64_t start = clock();
                topology.push_back(1e3 * stage.world.step(in).times.topology);
                whole.push_back(1e-6 * static_cast<double>(clock() - start));
                stage.commands.clear();
            }
        };
        const auto tellOf = [&](const std::string& name, std::vector<double> of) {
            std::ranges::sort(of);
            double sum = 0.0;
            for (double each : of) sum += each;
            tell(name + ", mean [ms]", sum / static_cast<double>(of.size()));
            tell(name + ", p99 [ms]", of[of.size() * 99 / 100]);
        };
        const std::string name =
            text(gravity == 0.0 ? "" : "hanging ", "shell of ", stage.model().surface.size(), " triangles: ");
        run(100, 0.0);
        tellOf(name + "whole step before the cut", whole);
        run(1400, 5e-5); // 5 cm/s, from before the sheet to behind it
        tellOf(name + "whole step while it is cut", whole);
        tellOf(name + "the cut and what follows it", topology);
        CHECK(stage.model().pieces.size() == 2);
        CHECK(stage.model().surface.size() > 1.02 * 2.0 * cells[0] * cells[1]);
    }
}

} // namespace cut_shell_test
