#include "apps/filasofia/bench/cut_run.h"

#include "apps/filasofia/bench/load.h"
#include "filasofia/geometry/shapes.h"

#include <ctime>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace filasofia::app {
namespace {

namespace shapes = geometry::shapes;

constexpr double kEdge = 0.06, kHeight = 0.048; ///< [m] edge and height of the block
constexpr double kAside = 1.03e-3; ///< [m] offset from the middle: the blade passes through cells, not between them
constexpr double kStart = 0.2;     ///< [s] rest; iterations before the cut are those of its second half
/// [-] sideways gravity relative to g, [Hz]; a body at rest would need no iterations
constexpr double kSwing = 0.1, kSwings = 4.0;
constexpr double kWait = 5e-3; ///< [m] distance of the blade from the block before and after the cut

constexpr double kWide = 0.01, kTall = 0.08; ///< [m] size of the blade

/// A block whose inner nodes are moved by up to 15 % of a cell. In the regular lattice, a blade along one of its planes
/// would cut whole faces only.
std::shared_ptr<const geometry::TetMesh> shaken(const geometry::TetMesh& block, double cell)
{
    geometry::TetMesh mesh = block;
    std::uint32_t random = 1;
    const auto next = [&] { // Lehmer's generator
        random = static_cast<std::uint32_t>(random * std::uint64_t{48271} % 2147483647);
        return 0.3 * (random / 2147483647.0 - 0.5) * cell;
    };
    for (Vec3& p : mesh.nodes) {
        const Vec3 shift{next(), next(), next()};
        const auto inside = [](double x, double half) { return std::abs(x) < half - 1e-6; };
        if (inside(p.x, 0.5 * kEdge) && inside(p.y, 0.5 * kHeight) && inside(p.z, 0.5 * kEdge)) p += shift;
    }
    return std::make_shared<const geometry::TetMesh>(std::move(mesh));
}

/// A blade in the plane x = 0, upright, with its lower edge at the origin.
std::shared_ptr<const geometry::TriangleMesh> wideBlade()
{
    return std::make_shared<const geometry::TriangleMesh>(
        geometry::TriangleMesh{.vertices = {{0, 0, 0}, {0, 0, kWide}, {0, kTall, kWide}, {0, kTall, 0}},
                               .triangles = {{0, 1, 2}, {0, 2, 3}},
                               .uv = {}});
}

constexpr double kWay = kEdge + 2.0 * kWait + kWide; ///< [m] path of the blade

/// [ns] processor time of this thread; the time that other programs take is not part of it.
std::int64_t threadTime()
{
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1'000'000'000LL * time.tv_sec + time.tv_nsec;
}

double timeOfCut(double speed) { return kWay / speed; }

void count(const physics::StepReport& report, double wall, CutTimes& times)
{
    times.topology.push_back(report.times.topology);
    times.contacts.push_back(report.times.contacts);
    times.advance.push_back(report.times.advance);
    times.steps.push_back(wall);
    times.during.push_back(iterationsOf(report));
}

void cutOnce(const CutScene& scene, bool first, CutTimes& times)
{
    ContactRun run(scene.make(), 1);
    const physics::StepBudget budget{.now = threadTime};
    const int rest = static_cast<int>(std::lround(kStart / kContactStep));
    const int cutting = static_cast<int>(std::lround(timeOfCut(scene.speed) / kContactStep));
    const OthersLoad others;
    for (int i = 0; i < 2 * rest + cutting; ++i) {
        const std::int64_t begun = threadTime();
        const physics::StepReport report = run.step(&budget);
        const double wall = 1e-9 * static_cast<double>(threadTime() - begun);
        times.flags |= report.flags;
        if (i >= rest && i < rest + cutting) count(report, wall, times);
        if (i >= rest / 2 && i < rest) times.before.push_back(iterationsOf(report));
        if (i >= rest + cutting) times.after.push_back(iterationsOf(report));
        for (const physics::Rupture& rupture : report.topology.ruptures) {
            if (!first) continue;
            times.area += rupture.area;
            times.pieces += static_cast<int>(rupture.detached.size());
            ++times.edits;
        }
    }
    times.others.push_back(others.cores());
}

} // namespace

ContactScene CutScene::make() const
{
    const int tall = cells * 4 / 5 + 1;
    physics::SoftBodyDef tissue{
        .name = "tissue",
        .mesh = shaken(*shapes::block({kEdge, kHeight, kEdge}, {cells, tall, cells}), kEdge / cells),
        .material = physics::FemMaterial{.youngModulus = 5e3},
        .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, -0.5 * kHeight + 1e-6, 1}}}},
        .dynamicTopology = true};
    if (touched) tissue.collision = {{.proximity = 0.5e-3}};

    const Vec3 start{kAside, (0.5 - share) * kHeight, -0.5 * kEdge - kWait - kWide};
    physics::RigidBodyDef blade{.name = "blade", .elements = {{start, {}}}};
    blade.collision = {{.mesh = wideBlade(), .proximity = 0, .cutting = true}};
    ContactScene scene{.name = name, .body = "block", .bodies = {tissue, blade}};
    scene.path = [start, way = speed](double time) {
        const double gone = std::clamp(way * (time - kStart), 0.0, kWay);
        return std::vector{std::pair{BodyId{2}, Pose{start + Vec3{0, 0, gone}, {}}}};
    };
    // Gravity swings only while the blade is out: with the blade inside, the block would saw itself.
    scene.gravity = [end = kStart + timeOfCut(speed)](double time) {
        const double angle = 2.0 * std::numbers::pi * kSwings * time;
        const double swing = time < kStart || time > end ? kSwing : 0.0;
        return 9.81 * Vec3{swing * std::cos(angle), -1.0, swing * std::sin(angle)};
    };
    if (touched) { // a bar attached to the tissue's upper side, across the cut
        physics::SoftBodyDef bar{.name = "bar",
                                 .mesh = shapes::block({0.04, 0.006, 0.01}, {8, 2, 2}),
                                 .pose = {{0, 0.5 * kHeight + 0.0035, 0}, {}},
                                 .attachments = {{.within = 1e-3, .stiffness = 20.0, .to = BodyId{1}}}};
        scene.bodies.emplace_back(bar);
    }
    return scene;
}

CutTimes timeCut(const CutScene& scene)
{
    CutTimes times{.scene = scene, .tetrahedra = 6 * scene.cells * scene.cells * (scene.cells * 4 / 5 + 1)};
    for (int r = 0; r < scene.repetitions; ++r) cutOnce(scene, r == 0, times);
    return times;
}

} // namespace filasofia::app
