#include "filasofia/engine/rupture/check_topology.h"
#include "filasofia/engine/scene/check_scene.h"

#include "effort.h"
#include "engine/sheets.h"
#include "engine/stage.h"

#include <numbers>
#include <numeric>

namespace shell_cutting_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

constexpr double kSide = 0.06; ///< [m]

/// A square sheet in the plane z = 0 from the origin on, pinned at x = 0.
SoftBodyDef cuttable(int cells, const ShellMaterial& material = {.youngModulus = 50e3, .thickness = 0.5e-3})
{
    return {.name = "sheet",
            .mesh = shared(sheetMesh({cells, cells}, kSide, kSide, 0.2, true)),
            .material = material,
            .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1e-6, 1, 1}}}},
            .dynamicTopology = true};
}

/// A body, and a blade whose edge stands along z in x = y = 0 of its pose, 20 mm long.
struct ShellScene {
    Stage stage;
    BodyId body, blade;
    StepReport all;

    explicit ShellScene(const SoftBodyDef& def, const NativeEngineDef& engine = {.threads = 1}) : stage(engine)
    {
        body = stage.add(def);
        auto mesh = std::make_shared<const geometry::TriangleMesh>(
            geometry::TriangleMesh{.vertices = {{0, 0, -0.01}, {0, 0, 0.01}, {0, -0.02, 0.01}, {0, -0.02, -0.01}},
                                   .triangles = {{0, 1, 2}, {0, 2, 3}},
                                   .uv = {}});
        blade = stage.add(RigidBodyDef{.name = "blade",
                                       .elements = {Pose{.position = {0, -1, 0}}},
                                       .collision = {{.mesh = mesh, .proximity = 0, .cutting = true}}});
        stage.step(0.0);
    }
    void step(double dt = 1e-3)
    {
        const StepReport report = stage.step(dt);
        all.flags |= report.flags;
        for (const Rupture& each : report.topology.ruptures) all.topology.ruptures.push_back(each);
    }
    /// Moves the blade, which may be anywhere before, by `speed` [m/s].
    void move(Vec3 from, Vec3 to, double speed = 0.2, double dt = 1e-3)
    {
        stage.post(SetPose{blade, 0, Pose{.position = from}});
        step(dt);
        const int steps = std::max(1, static_cast<int>(distance(from, to) / (speed * dt)));
        for (int i = 1; i <= steps; ++i) {
            stage.post(SetPose{blade, 0, Pose{.position = from + (static_cast<double>(i) / steps) * (to - from)}});
            step(dt);
        }
    }
    void away() { stage.post(SetPose{blade, 0, Pose{.position = {0, -1, 0}}}); }
    /// Cuts along y at this x, up to this y.
    void cut(double x, double to = kSide + 0.01, double dt = 1e-3)
    {
        move({x, -0.01, 0}, {x, to, 0}, 0.2, dt);
        away();
        for (int i = 0; i < 3; ++i) step(dt);
    }
    [[nodiscard]] double opened() const
    {
        double area = 0.0;
        for (const Rupture& each : all.topology.ruptures) area += each.area;
        return area;
    }
    [[nodiscard]] std::vector<LoosePiece> loose() const
    {
        std::vector<LoosePiece> list;
        for (const Rupture& each : all.topology.ruptures)
            list.insert(list.end(), each.detached.begin(), each.detached.end());
        return list;
    }
    [[nodiscard]] std::string faults(double quality = 0.25)
    {
        const EditableMesh& mesh = *stage.world.scene().soft[0].topology.mesh;
        std::string text;
        for (const TopologyViolation& v : checkSheetTopology(
                 mesh.data(), {.quality = quality, .volume = mesh.startVolume(), .volumeTolerance = 1e-9}))
            text += std::string(name(v.fault)) + ": " + v.where + "; ";
        return text;
    }
};

double massOf(const SoftModel& model) { return std::accumulate(model.masses.begin(), model.masses.end(), 0.0); }

double fastest(const SoftState& state)
{
    double most = 0.0;
    for (const Vec3& each : state.v) most = std::max(most, length(each));
    return most;
}

} // namespace

TEST_CASE("a sheet that is cut through falls apart into two pieces of the right masses")
{
    ShellScene scene(cuttable(16));
    const double mass = massOf(scene.stage.model());
    scene.cut(0.0237);
    CHECK(scene.all.flags == 0);
    CHECK(scene.faults().empty());
    check(scene.stage.model(), scene.stage.soft());
    CHECK(massOf(scene.stage.model()) == Approx(mass).epsilon(1e-12));
    CHECK(scene.opened() == Approx(kSide * 0.5e-3).epsilon(0.05)); // length times thickness
    const std::vector<LoosePiece> loose = scene.loose();
    REQUIRE(loose.size() == 1);
    // The larger part keeps the body's number, whether it is held or not.
    CHECK(loose[0].held);
    CHECK(loose[0].mass == Approx(mass * 0.0237 / kSide).epsilon(0.01));
    CHECK(loose[0].place.x == Approx(0.5 * 0.0237).epsilon(0.02));
    scene.stage.post(SetGravity{{0, 0, -9.81}});
    CHECK(scene.stage.run(100, 1e-3).flags == 0);
    for (const BodyPiece& piece : scene.stage.model().pieces) {
        const Vec3 v = scene.stage.soft().v[static_cast<std::size_t>(piece.nodes.back())];
        CHECK(piece.held == (piece.number == 1));
        if (!piece.held) CHECK(v.z == Approx(-0.981).epsilon(0.02)); // in free fall
    }
}

TEST_CASE("a sheet that was cut is as thick in contact as before")
{
    SoftBodyDef def = cuttable(16, {.youngModulus = 50e3, .thickness = 0.6e-3});
    def.collision = {{.proximity = 0.5e-3}};
    ShellScene scene(def);
    const std::size_t before = scene.stage.soft().x.size();
    scene.cut(0.0237);
    const CollisionModel& model = scene.stage.model().collision[0];
    CHECK(scene.stage.soft().x.size() > before);
    CHECK(model.inset.depth.size() == scene.stage.soft().x.size());
    for (const double depth : model.inset.depth) CHECK(depth == 0.3e-3);
    CHECK(model.shape->proximity == Approx(0.8e-3));
}

TEST_CASE("a cut changes neither momentum nor mass of a sheet that flies and shakes")
{
    SoftBodyDef def = cuttable(12);
    def.attachments = {};
    def.gravity = false;
    def.rayleigh = {0.0, 0.0};
    def.solver = ConjugateGradient{.maxIterations = 3000, .tolerance = 1e-7};
    ShellScene scene(def);
    SoftState& state = scene.stage.soft();
    for (std::size_t i = 0; i < state.v.size(); ++i)
        state.v[i] = {0.02 * std::sin(200.0 * state.x[i].y), 0.05, 0.1 * std::cos(150.0 * state.x[i].x)};
    const auto momentum = [&] {
        Vec3 sum;
        for (std::size_t i = 0; i < scene.stage.soft().v.size(); ++i)
            sum += scene.stage.model().masses[i] * scene.stage.soft().v[i];
        return sum;
    };
    const double mass = massOf(scene.stage.model());
    const Vec3 before = momentum();
    scene.cut(0.0237, 0.05);
    CHECK(scene.opened() > 0.03 * 0.5e-3);
    CHECK(massOf(scene.stage.model()) == Approx(mass).epsilon(1e-12));
    CHECK(length(momentum() - before) < 1e-6 * length(before)); // what the solver leaves in 300 steps
}

TEST_CASE("a curved shell that is cut without a load stays at rest: its parts keep their shape")
{
    SoftBodyDef def = cuttable(1, {.youngModulus = 200e3, .thickness = 1e-3});
    def.mesh = shared(tubeMesh(20, 16, 0.008, 0.05));
    def.gravity = false;
    ShellScene scene(def);
    scene.move({0.021, -0.02, 0}, {0.021, 0.02, 0});
    CHECK(scene.opened() > 0.03 * 1e-3);
    scene.move({0.03, -0.02, 0.006}, {0.06, -0.007, 0.006}); // a slit along it
    CHECK(scene.faults().empty());
    CHECK(scene.all.flags == 0);
    CHECK(fastest(scene.stage.soft()) < 1e-6);
    double moved = 0.0;
    for (std::size_t i = 0; i < scene.stage.soft().x.size(); ++i)
        moved = std::max(moved, distance(scene.stage.soft().x[i], scene.stage.model().rest[i]));
    CHECK(moved < 1e-6); // what accelerations below kSmallAlone (solve_limits.cpp) leave
}

TEST_CASE("the default solver follows a cut as a new one and as Cholesky would have it")
{
    for (double bending : {1.0, 0.0}) {
        CAPTURE(bending);
        SoftBodyDef def = cuttable(10, {.youngModulus = 50e3, .thickness = 1e-3, .bendingScale = bending});
        def.solver = ConjugateGradient{.maxIterations = 4000, .tolerance = 1e-7};
        SoftBodyDef direct = def;
        direct.solver = Cholesky{};
        ShellScene followed(def), rebuilt(def), exact(direct);
        for (ShellScene* scene : {&followed, &rebuilt, &exact}) {
            scene->cut(0.0237, 0.047);
            scene->cut(0.041);
            CHECK(scene->all.flags == 0);
            CHECK(scene->opened() > 0.09 * 1e-3);
            scene->stage.post(SetGravity{{0, 0, -9.81}});
        }
        rebuilt.stage.world.scene().soft[0].system.outdated = true;
        const int steps = bending > 0.0 ? 40 : 12; // a membrane that crumples multiplies roundings
        for (ShellScene* scene : {&followed, &rebuilt, &exact}) CHECK(scene->stage.run(steps, 2e-3).flags == 0);
        CHECK(followed.stage.world.scene().soft[0].system.matrixFree);
        double worst = 0.0, fromExact = 0.0, moved = 0.0;
        for (std::size_t i = 0; i < followed.stage.soft().x.size(); ++i) {
            const Vec3 x = followed.stage.soft().x[i];
            worst = std::max(worst, distance(x, rebuilt.stage.soft().x[i]));
            fromExact = std::max(fromExact, distance(x, exact.stage.soft().x[i]));
            moved = std::max(moved, distance(x, followed.stage.model().rest[i]));
        }
        CHECK(moved > 1e-3);
        CHECK(worst < 1e-5 * moved);
        CHECK(fromExact < 1e-5 * moved);
    }
}

TEST_CASE("a cut shell is the same for any number of threads, and after a saved state is restored")
{
    std::vector<std::uint64_t> hashes;
    for (int threads : {1, kManyThreads}) {
        ShellScene scene(cuttable(40), {.threads = threads});
        scene.stage.post(SetGravity{{0, 0, -0.1}});
        scene.move({0.0237, -0.01, 0}, {0.0237, 0.03, 0});
        const std::shared_ptr<const EngineState> middle = scene.stage.world.save();
        const auto rest = [&] {
            scene.move({0.0237, 0.0302, 0}, {0.0237, 0.07, 0});
            scene.stage.run(10, 1e-3);
            return scene.stage.world.hash();
        };
        hashes.push_back(rest());
        if (threads == 1) continue;
        scene.stage.world.restore(*middle);
        const std::size_t nodes = scene.stage.model().rest.size();
        hashes.push_back(rest());
        CHECK(scene.stage.model().rest.size() > nodes);
        CHECK(scene.faults().empty());
    }
    CHECK(std::ranges::count(hashes, hashes[0]) == 3);
}

TEST_CASE("a closed shell that is cut loses its pressure, and a reset closes it again")
{
    SoftBodyDef def = cuttable(1, {.youngModulus = 100e3, .thickness = 0.5e-3});
    def.mesh = geometry::shapes::sphere(0.01, 6);
    def.pressure = -200.0; // blown up
    def.attachments = {};
    def.gravity = false;
    def.rayleigh.mass = 20.0;
    def.collision = {{}};
    ShellScene scene(def);
    scene.stage.run(200, 1e-3);
    const auto radius = [&] {
        double most = 0.0;
        for (Vec3 x : scene.stage.soft().x) most = std::max(most, length(x));
        return most;
    };
    const double blown = radius();
    CHECK(blown > 0.0101);
    CHECK_FALSE(scene.stage.model().leaks);
    scene.move({0.002, -0.02, 0.008}, {0.002, 0.004, 0.008});
    scene.away();
    CHECK(scene.opened() > 0.0);
    CHECK(scene.faults().empty());
    CHECK(scene.stage.model().leaks);
    CHECK(scene.stage.run(600, 1e-3).flags == 0);
    CHECK(radius() < 0.01 + 0.1 * (blown - 0.01));
    scene.stage.post(Reset{});
    scene.stage.run(200, 1e-3);
    CHECK_FALSE(scene.stage.model().leaks);
    CHECK(radius() == Approx(blown).epsilon(1e-3));
}

TEST_CASE("attachments, pins, forces and the collision surface of a shell follow its cuts")
{
    SoftBodyDef def = cuttable(12);
    def.collision = {{.self = true}};
    def.gravity = false;
    ShellScene scene(def);
    AttachmentDef hold{.nodes = {}, .box = geometry::Box{{0.018, 0.02, -1}, {0.03, 0.04, 1}}, .stiffness = 10.0};
    scene.stage.post(Attach{AttachmentId{50}, scene.body, hold});
    const BodyId hand = scene.stage.add(RigidBodyDef{.name = "hand"});
    scene.stage.post(
        Attach{AttachmentId{51}, scene.body, {.ball = Ball{{0.024, 0.03, 0}, 0.008}, .stiffness = 20.0, .to = hand}});
    scene.cut(0.0237);
    CHECK(scene.all.flags == 0);
    CHECK(scene.faults().empty());
    checkAttachments(scene.stage.world.scene());
    check(scene.stage.model(), scene.stage.soft());
    CHECK(scene.stage.model().collision[0].shape->triangles.size() == scene.stage.model().surface.size());
    CHECK(scene.stage.model().surface.size() == scene.stage.model().shell.membranes.size());
    // A cut from the rim that is held, by both upright edges of the blade: new nodes between pinned ones are pinned.
    scene.move({-0.01, 0.0326, 0}, {0.02, 0.0326, 0});
    std::size_t held = 0;
    for (std::size_t i = 0; i < scene.stage.model().rest.size(); ++i)
        if (scene.stage.model().rest[i].x < 1e-9) {
            CHECK(scene.stage.model().pins.hard[i]);
            ++held;
        }
    CHECK(held == 13 + 4);
    CHECK(scene.stage.model().pins.groups[0].nodes.size() == held);
}

TEST_CASE("pieces of a shell are removed, and its material can change after a cut")
{
    SoftBodyDef def = cuttable(12);
    def.collision = {{}};
    ShellScene scene(def);
    scene.cut(0.0337);
    REQUIRE(scene.loose().size() == 1);
    const std::size_t triangles = scene.stage.model().surface.size();
    const ShellMaterial bare{.youngModulus = 30e3, .thickness = 0.5e-3, .bendingScale = 0.0};
    for (const ShellMaterial& material : {bare, ShellMaterial{.youngModulus = 40e3, .thickness = 0.5e-3}}) {
        scene.stage.post(SetMaterial{scene.body, material});
        CHECK(scene.stage.run(5, 1e-3).flags == 0);
        const Shell& shell = scene.stage.model().shell;
        CHECK(shell.bends.size() == (material.bendingScale > 0.0 ? triangles : 0));
        check(scene.stage.model(), scene.stage.soft());
    }
    scene.cut(0.0137, 0.03);
    CHECK(scene.faults().empty());
    scene.stage.post(RemovePiece{scene.body, scene.loose()[0].piece});
    CHECK(scene.stage.step(1e-3).topology.noPiece == 0);
    CHECK(scene.stage.model().surface.size() < 0.7 * static_cast<double>(triangles));
    CHECK(scene.stage.model().collision[0].shape->triangles.size() == scene.stage.model().surface.size());
    CHECK(scene.stage.run(50, 1e-3).flags == 0);
    frame::Frame frame;
    scene.stage.world.capture(frame);
    CHECK(frame.softBodies[0].boundary->triangles.size() == scene.stage.model().surface.size());
    scene.stage.post(Reset{});
    CHECK(scene.stage.run(3, 1e-3).flags == 0);
    CHECK(scene.stage.model().rest.size() == 13 * 13);
}

TEST_CASE("two jaws of scissors, one above and one below a sheet, cut it through where they close")
{
    Stage stage;
    SoftBodyDef def = cuttable(12);
    def.gravity = false;
    stage.add(def);
    const TriangleMeshSource jaw = std::make_shared<const geometry::TriangleMesh>(
        geometry::TriangleMesh{.vertices = {{0, 0, 0}, {0, 0.05, 0}, {0, 0.05, 0.01}, {0, 0, 0.01}},
                               .triangles = {{0, 1, 2}, {0, 2, 3}},
                               .uv = {}});
    // They turn about a pivot before the rim of the sheet; the lower one is the upper one turned over.
    const auto poseOf = [](int side, double angle) {
        const Quat open = axisAngle({1, 0, 0}, side == 0 ? angle : -angle);
        return Pose{.position = {0.0237, -0.004, 0},
                    .orientation = side == 0 ? open : open * axisAngle({0, 1, 0}, std::numbers::pi)};
    };
    const BodyId scissors =
        stage.add(RigidBodyDef{.name = "scissors",
                               .elements = {poseOf(0, 0.5), poseOf(1, 0.5)},
                               .collision = {{.mesh = jaw, .proximity = 0, .cutting = true},
                                             {.mesh = jaw, .element = 1, .proximity = 0, .cutting = true}}});
    stage.step(0.0);
    double opened = 0.0;
    for (int i = 0; i <= 220; ++i) { // they pass each other by 0.05 rad
        for (int side : {0, 1}) stage.post(SetPose{scissors, side, poseOf(side, 0.5 - 2.5e-3 * i)});
        for (const Rupture& each : stage.step(1e-3).topology.ruptures) opened += each.area;
    }
    CHECK(opened == Approx(0.046 * 0.5e-3).epsilon(0.15)); // the jaws reach 46 mm into the sheet
    CHECK(stage.model().pieces.size() < 2);
    check(stage.model(), stage.soft());
}

TEST_CASE("many small cuts leave a valid shell, also in fragments that fly")
{
    SoftBodyDef def = cuttable(10);
    def.gravity = false;
    ShellScene scene(def);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> any(0.0, kSide);
    for (int i = 0; i < 12; ++i) {
        const Vec3 from{any(random), any(random), 0}, to{any(random), any(random), 0};
        scene.move(from, to, 0.3);
        scene.away();
        for (int k = 0; k < 3; ++k) scene.step();
        REQUIRE(scene.faults().empty());
    }
    CHECK(scene.stage.run(200, 1e-3).flags == 0);
    check(scene.stage.model(), scene.stage.soft());
    CHECK(fastest(scene.stage.soft()) < 0.05);
}

TEST_CASE("shells that cannot be cut or torn are refused with what is wrong")
{
    Stage stage;
    SoftBodyDef def = cuttable(2, {.tearingThreshold = 1e3});
    def.dynamicTopology = false;
    CHECK_THROWS_WITH(stage.add(def), Catch::Contains("sheet") && Catch::Contains("tearingThreshold must be infinite"));
    def.dynamicTopology = true;
    std::get<ShellMaterial>(def.material).tearingThreshold = 0.0;
    CHECK_THROWS_WITH(stage.add(def), Catch::Contains("sheet") && Catch::Contains("tearingThreshold must be > 0"));
    geometry::TriangleMesh tie{.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}},
                               .triangles = {{0, 1, 2}, {0, 3, 4}},
                               .uv = {}};
    def = cuttable(2);
    def.mesh = shared(tie);
    CHECK_THROWS_WITH(stage.add(def),
                      Catch::Contains("sheet") && Catch::Contains("one fan") && Catch::Contains("node 0"));
    def.dynamicTopology = false;
    CHECK_NOTHROW(stage.add(def));
}

} // namespace shell_cutting_test
