#include "verification/verification.h"

#include "filasofia/geometry/shapes.h"

#include <numeric>

namespace cutting_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

/// A rectangle in the plane x = 0 with its lower edge along y through the origin.
TriangleMeshSource bladeMesh(double width, double height)
{
    const double y = 0.5 * width;
    return std::make_shared<const geometry::TriangleMesh>(
        geometry::TriangleMesh{.vertices = {{0, -y, 0}, {0, y, 0}, {0, y, height}, {0, -y, height}},
                               .triangles = {{0, 1, 2}, {0, 2, 3}},
                               .uv = {}});
}

RigidBodyDef blade(double width, double height, Pose at)
{
    return {.name = "blade",
            .elements = {at},
            .collision = {{.mesh = bladeMesh(width, height), .proximity = 0, .cutting = true}}};
}

/// Moves a tool from one place to another in `steps` steps of 1 ms.
StepReport sweep(Stage& stage, BodyId tool, Quat turn, Vec3 from, Vec3 to, int steps)
{
    StepReport all;
    stage.post(SetPose{tool, 0, {from, turn}}); // a jump: it cuts nothing
    stage.step(1e-3);
    for (int i = 1; i <= steps; ++i) {
        stage.post(SetPose{tool, 0, {from + static_cast<double>(i) / steps * (to - from), turn}});
        const StepReport report = stage.step(1e-3);
        all.flags |= report.flags;
        for (const Rupture& rupture : report.topology.ruptures) all.topology.ruptures.push_back(rupture);
    }
    return all;
}

double areaOf(const StepReport& report)
{
    double sum = 0.0;
    for (const Rupture& rupture : report.topology.ruptures) sum += rupture.area;
    return sum;
}

double massOf(const SoftModel& model) { return std::accumulate(model.masses.begin(), model.masses.end(), 0.0); }

/// The nodes of all elements connected to this one, ascending. Pieces share no nodes.
std::vector<int> connectedNodes(const SoftModel& model, int element)
{
    std::vector<char> reached(model.rest.size());
    for (int node : model.elements[static_cast<std::size_t>(element)].nodes)
        reached[static_cast<std::size_t>(node)] = 1;
    for (bool more = true; more;) {
        more = false;
        for (const FemElement& each : model.elements) {
            const auto isReached = [&](int node) { return reached[static_cast<std::size_t>(node)] != 0; };
            if (std::ranges::none_of(each.nodes, isReached) || std::ranges::all_of(each.nodes, isReached)) continue;
            for (int node : each.nodes) reached[static_cast<std::size_t>(node)] = 1;
            more = true;
        }
    }
    std::vector<int> nodes;
    for (std::size_t i = 0; i < reached.size(); ++i)
        if (reached[i] != 0) nodes.push_back(static_cast<int>(i));
    return nodes;
}

/// A free block of tissue on a floor, with gravity that can swing.
struct FloorScene {
    Stage stage;
    BodyId tissue, tool;
    std::uint32_t flags = 0;
    double opened = 0.0; ///< [m^2]
    int through = 0;     ///< number of pieces that came off

    explicit FloorScene(bool selfOnceCut = false)
    {
        constexpr Vec3 size{0.05, 0.04, 0.03};
        geometry::TetMesh mesh = boxMesh({9, 7, 5}, size, 0.2);
        for (Vec3& p : mesh.nodes) p += Vec3{-0.5 * size.x, -0.5 * size.y, 1e-4};
        tissue = stage.add(SoftBodyDef{.mesh = shared(std::move(mesh)),
                                       .material = FemMaterial{.youngModulus = 1e4},
                                       .collision = {{.selfOnceCut = selfOnceCut}},
                                       .dynamicTopology = true});
        stage.add(RigidBodyDef{.name = "floor",
                               .elements = {Pose{{0, 0, -0.01}, {}}},
                               .mesh = geometry::shapes::box({0.4, 0.4, 0.02}),
                               .collision = {{}}});
        tool = stage.add(blade(0.12, 0.12, {{0, 0, 1}, {}}));
        stage.post(SetGravity{{0, 0, -9.81}});
        stage.step(0.0);
        rest(200);
    }
    void rest(int steps)
    {
        for (int i = 0; i < steps; ++i) flags |= stage.step(1e-3).flags;
    }
    /// [-] Mean number of iterations over `steps` steps of swinging gravity.
    double swing(int steps)
    {
        double sum = 0.0;
        for (int i = 0; i < steps; ++i) {
            const double angle = 2.0 * 3.14159265358979 * 4e-3 * i;
            stage.post(SetGravity{{std::sin(angle), 0.5 * std::sin(2.0 * angle), -9.81}});
            const StepReport report = stage.step(1e-3);
            flags |= report.flags;
            sum += report.solves[0].iterations;
        }
        stage.post(SetGravity{{0, 0, -9.81}});
        return sum / steps;
    }
    /// One cut, two or three, also across each other; every second body is cut through.
    void cutAtRandom(int number, std::mt19937& random)
    {
        const auto uniform = [&](double low, double high) { // the same numbers on every machine
            return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
        };
        for (int again = 0; again < 1 + number % 3; ++again) {
            // Drawn one after the other, because the order in which arguments are evaluated depends on the compiler.
            const double lean = uniform(-0.5, 0.5), about = uniform(0, 3.14);
            const Quat turn = axisAngle({0, 0, 1}, about) * axisAngle({0, 1, 0}, lean);
            const double x = uniform(-0.015, 0.015), y = uniform(-0.01, 0.01);
            const bool whole = again == 0 && number % 2 == 0;
            const StepReport report =
                sweep(stage, tool, turn, {x, y, 0.045}, {x, y, whole ? -0.04 : uniform(0.0, 0.02)}, 100);
            opened += areaOf(report);
            for (const Rupture& rupture : report.topology.ruptures)
                through += static_cast<int>(rupture.detached.size());
            flags |= report.flags;
            stage.post(SetPose{tool, 0, {{0, 0, 1}, turn}});
            rest(20);
        }
    }
};

} // namespace

TEST_CASE("after any cut a body survives 500 steps of gravity and contact, with about as many iterations")
{
    constexpr int kCuts = 20, kSteps = 500;
    std::mt19937 random(5);
    std::vector<double> ratios;
    double drift = 0.0, volumeDrift = 0.0, opened = 0.0;
    int through = 0;
    for (int cut = 0; cut < kCuts; ++cut) {
        CAPTURE(cut);
        FloorScene scene;
        const double mass = massOf(scene.stage.model()),
                     volume = meshVolume(scene.stage.model(), scene.stage.model().rest);
        const double before = scene.swing(kSteps);
        scene.cutAtRandom(cut, random);
        opened += scene.opened;
        through += scene.through;
        const double after = scene.swing(kSteps);
        ratios.push_back(after / before);
        // Both sides of a cut may swing through each other: the body does not collide with itself.
        CHECK((scene.flags & ~static_cast<std::uint32_t>(StepFlag::Intersecting)) == 0);
        check(scene.stage.model(), scene.stage.soft());
        for (const Vec3& x : scene.stage.soft().x) CHECK((isFinite(x) && length(x) < 1.0));
        drift = std::max(drift, std::abs(massOf(scene.stage.model()) / mass - 1.0));
        volumeDrift =
            std::max(volumeDrift, std::abs(meshVolume(scene.stage.model(), scene.stage.model().rest) / volume - 1.0));
    }
    double worstOfOne = 0.0;
    for (int cut = 0; cut < kCuts; cut += 3) worstOfOne = std::max(worstOfOne, ratios[static_cast<std::size_t>(cut)]);
    std::ranges::sort(ratios);
    CHECK(opened > 0.01);
    CHECK(through >= 5);
    verify("cutting, change of mass by up to three cuts, relative", drift, 1e-3);
    verify("cutting, change of volume by up to three cuts, relative", volumeDrift, 1e-3);
    verify("cutting, iterations after a cut over those before, median of 20 bodies", ratios[kCuts / 2], 1.3);
    verify("cutting, iterations after a cut over those before, worst of 7 bodies with one cut", worstOfOne, 1.4);
    verify("cutting, iterations after up to three cuts over those before, worst but one of 20 bodies",
           ratios[kCuts - 2], 3.3);
    // The bounds are about a tenth above what was measured: 1.17, 1.27, 3.00 and 3.91. The aim is 3 after any cut,
    // which one body misses after two cuts: flaps of a few elements can tie the coarse level.
    verify("cutting, iterations after up to three cuts over those before, worst of 20 bodies", ratios.back(), 4.5);
}

TEST_CASE("bodies that collide with themselves once cut swing without passing through themselves or turning inside out")
{
    // A point outside one face of a thin flap was taken to be inside the other one, and the lips of a cut passed
    // through each other before they met: 2.5 times the iterations of whole bodies in the median, 16 times in the
    // worst, and elements inside out in four of twenty.
    constexpr int kBodies = 6, kSteps = 250;
    std::mt19937 random(5);
    std::vector<double> ratios;
    for (int cut = 0; cut < kBodies; ++cut) {
        CAPTURE(cut);
        FloorScene scene(true);
        const double before = scene.swing(50);
        scene.cutAtRandom(cut, random);
        ratios.push_back(scene.swing(kSteps) / before);
        CHECK(scene.flags == 0);
        check(scene.stage.model(), scene.stage.soft());
    }
    std::ranges::sort(ratios);
    verify("cutting, iterations after cuts whose sides collide over those before, median of 6 bodies",
           ratios[kBodies / 2], 2.5);
    verify("cutting, the same, worst of 6 bodies", ratios.back(), 5.0);
}

TEST_CASE("a piece cut free keeps its momentum during the edits, and falls freely")
{
    // Alone in space, tumbling: nothing but the edits could change the total momentum. The solver is direct, because an
    // iterative one leaves a residual in each step's change of momentum.
    Stage stage;
    SoftBodyDef def = freeBody(boxMesh({10, 4, 4}, {0.1, 0.04, 0.04}, 0.2));
    def.material = FemMaterial{.youngModulus = 2e4};
    def.solver = Cholesky{};
    def.dynamicTopology = true;
    stage.add(def);
    const BodyId tool = stage.add(blade(0.2, 0.2, {{0.052, 0.02, 1}, {}}));
    stage.step(0.0);
    for (std::size_t i = 0; i < stage.soft().v.size(); ++i)
        stage.soft().v[i] = Vec3{0.1, 0.02, 0.03} + cross(Vec3{0, 0.3, 0.2}, stage.soft().x[i]);
    const auto momentum = [&](const std::vector<int>& nodes) {
        Vec3 sum;
        for (int node : nodes) {
            const auto i = static_cast<std::size_t>(node);
            sum += stage.model().masses[i] * stage.soft().v[i];
        }
        return sum;
    };
    const auto all = [&] {
        std::vector<int> nodes(stage.soft().v.size());
        std::iota(nodes.begin(), nodes.end(), 0);
        return nodes;
    };
    const Vec3 start = momentum(all());
    std::vector<int> piece;
    LoosePiece reported;
    double worst = 0.0;
    for (int i = 1; i <= 200; ++i) {
        stage.post(SetPose{tool, 0, {{0.052, 0.02, 0.06 - 5e-4 * i}, {}}});
        const StepReport report = stage.step(1e-3);
        CHECK(report.flags == 0);
        worst = std::max(worst, length(momentum(all()) - start) / length(start));
        for (const Rupture& rupture : report.topology.ruptures)
            for (const LoosePiece& loose : rupture.detached) piece = (reported = loose).elements;
    }
    REQUIRE_FALSE(piece.empty());
    verify("cutting, change of momentum by a cut across a flying bar, relative", worst, 1e-9);

    // The blade is moved away, or it would continue to cut the piece that moves through it.
    stage.post(SetPose{tool, 0, {{0.052, 0.02, 1}, {}}});
    stage.step(1e-3);
    stage.step(1e-3);
    const std::vector<int> nodes = connectedNodes(stage.model(), piece.front());
    double mass = 0.0;
    for (int node : nodes) mass += stage.model().masses[static_cast<std::size_t>(node)];
    CHECK(mass == Approx(0.48 * massOf(stage.model())).epsilon(0.1));
    CHECK(reported.mass == Approx(mass).epsilon(1e-3));
    CHECK(std::abs(reported.place.x - 0.052) > 0.01); // on one side of the cut, and well away from it
    CHECK_FALSE(reported.held);

    // The same piece in gravity.
    stage.model().gravity = true;
    stage.post(SetGravity{{0, 0, -9.81}});
    double error = 0.0;
    for (int i = 0; i < 100; ++i) {
        const Vec3 before = momentum(nodes);
        stage.step(1e-3);
        const Vec3 gained = (momentum(nodes) - before) / (1e-3 * mass);
        error = std::max(error, length(gained - Vec3{0, 0, -9.81}) / 9.81);
    }
    verify("cutting, acceleration of the free piece against g, relative", error, 1e-9);
}

} // namespace cutting_test
