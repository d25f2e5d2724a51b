#include "filasofia/engine/rupture/check_topology.h"
#include "filasofia/engine/scene/check_scene.h"

#include "filasofia/core/log.h"
#include "filasofia/geometry/shapes.h"

#include "effort.h"
#include "engine/elastic/laws.h"
#include "engine/stage.h"

#include <iostream>
#include <numbers>
#include <numeric>
#include <set>
#include <tuple>

namespace cutting_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

/// A rectangle in the plane x = 0, from z = 0 up, with `width` along y.
TriangleMeshSource bladeMesh(double width, double height)
{
    const double y = 0.5 * width;
    return std::make_shared<const geometry::TriangleMesh>(
        geometry::TriangleMesh{.vertices = {{0, -y, 0}, {0, y, 0}, {0, y, height}, {0, -y, height}},
                               .triangles = {{0, 1, 2}, {0, 2, 3}},
                               .uv = {}});
}

/// A block of tissue with its low corner at the origin, and a blade above it that comes down in the plane x = `at`.
struct CutScene {
    Stage stage;
    BodyId tissue, blade;
    double at;

    explicit CutScene(SoftBodyDef def, double x, double width = 0.1, NativeEngineDef engine = {.threads = 1})
        : stage(engine), at(x)
    {
        tissue = stage.add(def);
        blade =
            stage.add(RigidBodyDef{.name = "blade",
                                   .elements = {poseAt(1.0)},
                                   .collision = {{.mesh = bladeMesh(width, 0.05), .proximity = 0, .cutting = true}}});
        stage.step(0.0);
    }
    [[nodiscard]] Pose poseAt(double z) const { return {.position = {at, 0.02, z}}; }

    /// Moves the blade from one z to another at `speed` [m/s].
    StepReport move(double from, double to, double speed = 0.1, double dt = 1e-3)
    {
        StepReport all;
        stage.post(SetPose{blade, 0, poseAt(from)});
        stage.step(dt);
        const int steps = static_cast<int>(std::abs(to - from) / (speed * dt));
        for (int i = 1; i <= steps; ++i) {
            stage.post(SetPose{blade, 0, poseAt(from + (to - from) * i / steps)});
            const StepReport report = stage.step(dt);
            for (const Rupture& rupture : report.topology.ruptures) all.topology.ruptures.push_back(rupture);
            all.topology.bladeJump += report.topology.bladeJump;
            all.flags |= report.flags;
        }
        return all;
    }
};

SoftBodyDef tissueBlock()
{
    return {.mesh = shared(boxMesh({10, 8, 6}, {0.05, 0.04, 0.03}, 0.2)),
            .material = FemMaterial{.youngModulus = 5e3},
            .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1, 1e-6}}}},
            .dynamicTopology = true};
}

double massOf(const SoftModel& model) { return std::accumulate(model.masses.begin(), model.masses.end(), 0.0); }

int detachedOf(const StepReport& report)
{
    int count = 0;
    for (const Rupture& rupture : report.topology.ruptures) count += static_cast<int>(rupture.detached.size());
    return count;
}

} // namespace

TEST_CASE("a blade that goes through a body leaves two pieces, and no mass is lost")
{
    SoftBodyDef def = tissueBlock();
    def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1e-6, 1, 1}}}};
    CutScene scene(def, 0.0262);
    const double mass = massOf(scene.stage.model());
    const StepReport report = scene.move(0.04, -0.01);
    CHECK(report.flags == 0);
    CHECK(detachedOf(report) == 1);
    double area = 0.0;
    for (const Rupture& rupture : report.topology.ruptures) {
        area += rupture.area;
        CHECK(rupture.kind == Rupture::Kind::Cut);
        CHECK(rupture.body == scene.tissue);
        CHECK(std::abs(rupture.place.x - 0.0262) < 0.005);
    }
    CHECK(area == Approx(0.04 * 0.03).epsilon(0.05));
    CHECK(massOf(scene.stage.model()) == Approx(mass).epsilon(1e-3));
    check(scene.stage.model(), scene.stage.soft());
}

namespace {

/// An open tube of n sides around the z axis.
TriangleMeshSource tubeMesh(int n, double radius, double height)
{
    geometry::TriangleMesh mesh;
    for (int i = 0; i < n; ++i) {
        const double a = 2.0 * std::numbers::pi * i / n;
        mesh.vertices.push_back({radius * std::cos(a), radius * std::sin(a), 0});
        mesh.vertices.push_back({radius * std::cos(a), radius * std::sin(a), height});
        const int next = (i + 1) % n;
        mesh.triangles.push_back({2 * i, 2 * next, 2 * i + 1});
        mesh.triangles.push_back({2 * i + 1, 2 * next, 2 * next + 1});
    }
    return std::make_shared<const geometry::TriangleMesh>(std::move(mesh));
}

struct Punched {
    StepReport report;
    double area = 0.0;          ///< [m^2]
    std::vector<double> masses; ///< [kg] the pieces that came loose
};

/// Pushes a tube right through a slab of 60 x 60 x 12 mm that is pinned at two ends or lies on a floor.
Punched punch(int sides, double radius, double speed, bool pinned)
{
    constexpr double dt = 1e-3;
    Stage stage;
    SoftBodyDef slab{.mesh = shared(boxMesh({20, 20, 4}, {0.06, 0.06, 0.012}, 0.2)),
                     .material = FemMaterial{.youngModulus = 2e4},
                     .collision = {{.selfOnceCut = false}},
                     .dynamicTopology = true};
    if (pinned)
        slab.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1e-6, 1, 1}}},
                            {.box = geometry::Box{{0.06 - 1e-6, -1, -1}, {1, 1, 1}}}};
    else
        slab.pose.position.z = 1e-3;
    stage.add(slab);
    if (!pinned)
        stage.add(RigidBodyDef{.name = "floor",
                               .elements = {Pose{{0.03, 0.03, -0.05}}},
                               .mesh = geometry::shapes::box({0.2, 0.2, 0.1}),
                               .collision = {CollisionDef{}}});
    const auto poseAt = [](double z) { return Pose{.position = {0.0303, 0.0304, z}}; };
    const BodyId tube = stage.add(RigidBodyDef{
        .name = "tube",
        .elements = {poseAt(0.02)},
        .collision = {{.mesh = tubeMesh(sides, radius, 0.05), .proximity = 0, .group = 0, .cutting = true}}});
    stage.post(SetGravity{{0, 0, -9.81}});
    Punched done;
    for (double z = 0.02; z > -0.006; z -= speed * dt) {
        stage.post(SetPose{tube, 0, poseAt(z)});
        const StepReport step = stage.step(dt);
        done.report.flags |= step.flags;
        for (const Rupture& rupture : step.topology.ruptures) {
            done.area += rupture.area;
            for (const LoosePiece& piece : rupture.detached) done.masses.push_back(piece.mass);
        }
    }
    return done;
}

} // namespace

TEST_CASE("a punch that goes through a slab frees its core, on a floor and pinned, slowly and fast")
{
    for (const bool pinned : {false, true})
        for (const auto& [sides, radius, speed] : {std::tuple(24, 0.012, 0.1), std::tuple(24, 0.02, 0.5),
                                                   std::tuple(48, 0.008, 0.3), std::tuple(8, 0.015, 0.2)}) {
            CAPTURE(pinned, sides, radius, speed);
            const Punched done = punch(sides, radius, speed, pinned);
            const double angle = 2.0 * std::numbers::pi / sides;
            const double base = 0.5 * sides * radius * radius * std::sin(angle);
            CHECK(done.area == Approx(2.0 * sides * radius * std::sin(0.5 * angle) * 0.012).epsilon(0.08));
            REQUIRE(done.masses.size() == 1);
            CHECK(done.masses[0] == Approx(1000.0 * base * 0.012).epsilon(0.06));
        }
}

TEST_CASE("a body is stepped after a cut with about as many iterations")
{
    CutScene scene(tissueBlock(), 0.0262);
    scene.stage.post(SetGravity{{0, 0, -9.81}});
    const auto iterations = [&](int steps) {
        int sum = 0;
        for (int i = 0; i < steps; ++i) {
            const StepReport report = scene.stage.step(1e-3);
            CHECK(report.flags == 0);
            sum += report.solves[0].iterations;
        }
        return static_cast<double>(sum) / steps;
    };
    scene.stage.run(300, 1e-3);
    const double before = iterations(50);
    scene.move(0.04, 0.012); // not through
    const double after = iterations(50);
    scene.stage.run(450, 1e-3);
    std::cout << "iterations per step before a cut " << before << ", after it " << after << ", later " << iterations(50)
              << '\n';
    CHECK(after < 3.0 * before);
}

TEST_CASE("a cut gives the same bits for any number of threads")
{
    std::vector<std::uint64_t> hashes;
    for (int threads : {1, 2, 5}) {
        CutScene scene(tissueBlock(), 0.0262, 0.02, {.threads = threads});
        scene.move(0.04, 0.005);
        hashes.push_back(scene.stage.world.hash());
    }
    CHECK(hashes[0] == hashes[1]);
    CHECK(hashes[0] == hashes[2]);
}

TEST_CASE("a body without dynamicTopology or in another group is not cut")
{
    SoftBodyDef whole = tissueBlock();
    whole.dynamicTopology = false;
    SoftBodyDef other = tissueBlock();
    other.collision = {{.group = 3}};
    for (const SoftBodyDef& def : {whole, other}) {
        CutScene scene(def, 0.0262);
        const std::size_t elements = scene.stage.model().elements.size();
        scene.move(0.04, 0.0);
        CHECK(scene.stage.model().elements.size() == elements);
    }
}

TEST_CASE("a blade that jumps over the body cuts nothing and is counted")
{
    CutScene scene(tissueBlock(), 0.0262);
    const std::size_t elements = scene.stage.model().elements.size();
    scene.stage.post(SetPose{scene.blade, 0, scene.poseAt(0.04)});
    scene.stage.step(1e-3);
    scene.stage.post(SetPose{scene.blade, 0, scene.poseAt(-0.05)}); // 90 m/s: too fast to have a path
    const TopologyReport report = scene.stage.step(1e-3).topology;
    CHECK(report.bladeTooFast == 1);
    CHECK(report.refused() == 1);
    CHECK(scene.stage.model().elements.size() == elements);
    CHECK(scene.stage.step(1e-3).topology.refused() == 0); // it has arrived
}

TEST_CASE("a reset restores a cut body")
{
    CutScene scene(tissueBlock(), 0.0262);
    const std::size_t nodes = scene.stage.model().rest.size();
    const std::uint64_t revision = 0;
    scene.move(0.04, 0.01);
    CHECK(scene.stage.model().rest.size() > nodes);
    scene.stage.post(Reset{});
    scene.stage.step(1e-3);
    CHECK(scene.stage.model().rest.size() == nodes);
    frame::Frame frame;
    scene.stage.world.capture(frame);
    CHECK(frame.softBodies[0].boundary->revision == revision);
    check(scene.stage.model(), scene.stage.soft());
}

TEST_CASE("attachments and collision meshes that ride on a body follow a cut")
{
    SoftBodyDef def = tissueBlock();
    def.collision = {{.proximity = 0.5e-3}};
    CutScene scene(def, 0.0262);
    AttachmentDef hold{.nodes = {}, .box = geometry::Box{{0.02, -1, 0.029}, {0.031, 1, 1}}, .stiffness = 10.0};
    scene.stage.post(Attach{AttachmentId{50}, scene.tissue, hold});
    const StepReport report = scene.move(0.04, 0.005);
    CHECK(report.flags == 0);
    CHECK(scene.stage.soft().x.size() == scene.stage.model().rest.size());
    const CollisionModel& surface = scene.stage.model().collision[0];
    CHECK(surface.shape->triangles.size() == scene.stage.model().surface.size());
    CHECK(surface.shape->closed);
    checkAttachments(scene.stage.world.scene());
}

TEST_CASE("a loose piece can be removed and the rest goes on, and an invalid piece is counted")
{
    SoftBodyDef def = tissueBlock();
    def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1e-6, 1, 1}}}};
    def.collision = {{.proximity = 0.5e-3}};
    CutScene scene(def, 0.0262);
    const StepReport cut = scene.move(0.04, -0.01);
    int piece = -1;
    for (const Rupture& rupture : cut.topology.ruptures)
        for (const LoosePiece& loose : rupture.detached) piece = loose.piece;
    REQUIRE(piece > 0);
    scene.stage.post(SetGravity{{0, 0, -9.81}});
    scene.stage.run(20, 1e-3);

    const std::size_t triangles = scene.stage.model().surface.size();
    scene.stage.post(RemovePiece{scene.tissue, piece + 7});
    CHECK(scene.stage.step(1e-3).topology.noPiece == 1);
    CHECK(scene.stage.model().surface.size() == triangles);
    scene.stage.post(RemovePiece{scene.tissue, piece});
    const StepReport report = scene.stage.step(1e-3);
    CHECK(report.topology.noPiece == 0);
    CHECK(scene.stage.model().surface.size() < 0.7 * static_cast<double>(triangles));
    CHECK(scene.stage.model().collision[0].shape->triangles.size() == scene.stage.model().surface.size());
    CHECK(scene.stage.run(100, 1e-3).flags == 0);
    check(scene.stage.model(), scene.stage.soft());
    frame::Frame frame;
    scene.stage.world.capture(frame);
    for (const geometry::Triangle& triangle : frame.softBodies[0].boundary->triangles)
        for (int node : triangle) CHECK(length(frame.softBodies[0].positions[static_cast<std::size_t>(node)]) < 1.0);
    scene.stage.post(RemovePiece{scene.tissue, 0}); // all that is left of the body
    CHECK(scene.stage.step(1e-3).topology.noPiece == 1);
    scene.stage.post(RemovePiece{scene.tissue, piece}); // removed already
    CHECK(scene.stage.step(1e-3).topology.noPiece == 1);
    CHECK(scene.move(0.04, 0.02).flags == 0); // blades find no edge of it
    scene.stage.post(Reset{});
    scene.stage.step(1e-3);
    CHECK(scene.stage.model().removed.empty());
}

TEST_CASE("two jaws of scissors that close on a strip cut it through")
{
    Stage stage;
    SoftBodyDef strip{.mesh = shared(boxMesh({16, 4, 4}, {0.04, 0.01, 0.01}, 0.2)),
                      .gravity = false,
                      .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1e-6, 1, 1}}}},
                      .dynamicTopology = true};
    const BodyId tissue = stage.add(strip);
    const TriangleMeshSource jaw = bladeMesh(0.03, 0.02); // extends upwards from its edge; the other one is turned over
    const auto poseOf = [](int side, double gap) {
        return Pose{.position = {0.0193, 0.005, 0.005 + (side == 0 ? gap : -gap)},
                    .orientation = side == 0 ? Quat{} : axisAngle({0, 1, 0}, std::numbers::pi)};
    };
    const BodyId scissors =
        stage.add(RigidBodyDef{.name = "scissors",
                               .elements = {poseOf(0, 0.01), poseOf(1, 0.01)},
                               .collision = {{.mesh = jaw, .proximity = 0, .cutting = true},
                                             {.mesh = jaw, .element = 1, .proximity = 0, .cutting = true}}});
    stage.step(1e-3);
    int detached = 0;
    for (int i = 1; i <= 260; ++i) { // they close until they overlap by 3 mm
        for (int side : {0, 1}) stage.post(SetPose{scissors, side, poseOf(side, 0.01 - 0.05e-3 * i)});
        const StepReport report = stage.step(1e-3);
        CHECK(report.flags == 0);
        detached += detachedOf(report);
    }
    for (int side : {0, 1}) stage.post(SetPose{scissors, side, poseOf(side, 1.0)});
    detached += detachedOf(stage.run(5, 1e-3));
    CHECK(detached == 1);
    CHECK(tissue.value == 1);
}

/// Two boxes that share the nodes at which both have a corner.
geometry::TetMesh touchingBoxes(Vec3 shift)
{
    geometry::TetMesh mesh = boxMesh({1, 1, 1}, {1, 1, 1});
    const geometry::TetMesh other = mesh;
    std::vector<int> numbers;
    for (const Vec3& node : other.nodes) {
        const auto same = std::ranges::find_if(other.nodes, [&](Vec3 p) { return distance(p, node + shift) < 1e-9; });
        numbers.push_back(static_cast<int>(same - other.nodes.begin()));
        if (same != other.nodes.end()) continue;
        numbers.back() = static_cast<int>(mesh.nodes.size());
        mesh.nodes.push_back(node + shift);
    }
    for (geometry::Tetrahedron t : other.tetrahedra) {
        for (int& node : t) node = numbers[node];
        mesh.tetrahedra.push_back(t);
    }
    return mesh;
}

TEST_CASE("parts that touch in an edge or a node only come apart in a body that may be cut, and keep their mass")
{
    for (const auto& [shift, common] : {std::pair{Vec3{1, 1, 0}, 2}, {Vec3{1, 1, 1}, 1}}) {
        const geometry::TetMesh touching = touchingBoxes(shift);
        const auto count = static_cast<int>(touching.nodes.size());
        REQUIRE(count == 16 - common);
        std::string warnings;
        setLogSink([&](LogLevel, std::string_view line) { warnings += text(line, "\n"); });
        Stage stage;
        SoftBodyDef def{.name = "twins", .mesh = shared(touching), .mass = Density{1000.0}};
        stage.add(loaded(def));
        stage.step(1e-3);
        CHECK(stage.model().rest.size() == touching.nodes.size()); // nobody cuts it: it stays as it is
        def.dynamicTopology = true;
        Stage cut;
        cut.add(loaded(def));
        cut.step(1e-3);
        setLogSink({});
        CHECK_THAT(warnings,
                   Catch::Contains(text("soft body 'twins': ", common)) && Catch::Contains("touch in an edge"));
        const SoftModel& model = cut.model();
        CHECK(model.rest.size() == 16);
        CHECK(std::equal(touching.nodes.begin(), touching.nodes.end(), model.rest.begin())); // copies come last
        CHECK(std::accumulate(model.masses.begin(), model.masses.end(), 0.0) == Approx(2000.0));
    }
}

TEST_CASE("a body that may be cut needs a manifold surface, and a tune cannot change its mesh")
{
    // A block of 3 cells along each edge without two of them that touch in an edge inside: their hollows meet there.
    geometry::TetMesh hollow = boxMesh({3, 3, 3}, {3, 3, 3});
    const auto in = [&](const geometry::Tetrahedron& t, Vec3 low) {
        Vec3 centre;
        for (const int node : t) centre += 0.25 * hollow.nodes[node];
        const Vec3 p = centre - hollow.nodes[0] - low;
        return p.x > 0 && p.x < 1 && p.y > 0 && p.y < 1 && p.z > 0 && p.z < 1;
    };
    std::erase_if(hollow.tetrahedra, [&](const auto& t) { return in(t, {0, 1, 1}) || in(t, {1, 2, 1}); });
    Stage stage;
    SoftBodyDef def{.name = "hollow", .mesh = shared(hollow), .dynamicTopology = true};
    CHECK_THROWS_WITH(stage.add(def), Catch::Contains("hollow") && Catch::Contains("manifold") &&
                                          Catch::Contains("'filasofia mesh FILE -o FILE.msh --size 4mm' meshes it"));
    def.dynamicTopology = false;
    CHECK_NOTHROW(stage.add(def));

    Stage tuned;
    tuned.add(tissueBlock());
    tuned.step(1e-3);
    const auto rest = tuned.model().rest;
    tuned.post(
        Tune{[](PhysicsEngine& engine) { static_cast<World&>(engine).scene().soft[0].model.rest[7].x += 1e-4; }});
    CHECK(tuned.step(1e-3).has(StepFlag::TuneRejected));
    CHECK(tuned.model().rest == rest);
    tuned.post(
        Tune{[](PhysicsEngine& engine) { static_cast<World&>(engine).scene().soft[0].model.dynamicTopology = false; }});
    CHECK(tuned.step(1e-3).has(StepFlag::TuneRejected));
}

TEST_CASE("bodies of springs, with explicit steps and with a direct solver are cut as well")
{
    SoftBodyDef springs = tissueBlock(), direct = tissueBlock(), steps = tissueBlock();
    springs.material = MassSpringMaterial{.stiffness = 20.0, .damping = 0.05};
    direct.solver = Cholesky{};
    direct.mesh = shared(boxMesh({6, 5, 4}, {0.05, 0.04, 0.03}, 0.2));
    steps.integrator = ExplicitEuler{.symplectic = true};
    steps.material = FemMaterial{.youngModulus = 500.0, .poissonRatio = 0.3};
    steps.rayleigh.stiffness = 1e-4; // damping bounds an explicit step as well
    for (const auto& [def, dt] : {std::pair{springs, 1e-3}, {direct, 1e-3}, {steps, 1e-4}}) {
        CutScene scene(def, 0.0262);
        const StepReport report = scene.move(0.034, 0.02, 0.2, dt);
        CHECK(report.flags == 0);
        CHECK(report.topology.ruptures.size() > 0);
        CHECK(scene.stage.run(100, dt).flags == 0);
        check(scene.stage.model(), scene.stage.soft());
    }
}

TEST_CASE("a cut updates the volumes of nodes of nearly incompressible tissue as a new solver would have them")
{
    SoftBodyDef def = tissueBlock();
    def.material = FemMaterial{.youngModulus = 5e3, .poissonRatio = 0.49};
    def.solver = ConjugateGradient{.maxIterations = 3000, .tolerance = 1e-6};
    CutScene followed(def, 0.0262), rebuilt(def, 0.0262);
    for (CutScene* scene : {&followed, &rebuilt}) CHECK(scene->move(0.034, 0.02, 0.2).topology.ruptures.size() > 0);
    REQUIRE(followed.stage.world.hash() == rebuilt.stage.world.hash());
    const std::vector<Vec3> before = followed.stage.soft().x;
    rebuilt.stage.post(Tune{[](PhysicsEngine&) {}}); // builds the solver anew
    for (CutScene* scene : {&followed, &rebuilt}) {
        scene->stage.post(SetGravity{{0, 5, -9.81}});
        scene->stage.run(30, 1e-3);
    }
    const double moved = relativeDistance(followed.stage.soft().x, before, 1.0);
    CHECK(moved > 1e-5);
    CHECK(relativeDistance(followed.stage.soft().x, rebuilt.stage.soft().x, moved) < 1e-3);
}

TEST_CASE("nearly incompressible tissue is cut through its pinned face, whose new nodes share their volumes")
{
    SoftBodyDef def = tissueBlock();
    def.material = FemMaterial{.youngModulus = 5e3, .poissonRatio = 0.49};
    CutScene scene(def, 0.0262);
    const std::size_t pinned = static_cast<std::size_t>(std::ranges::count(scene.stage.model().pins.hard, true));
    CHECK(scene.move(0.034, -0.005, 0.5).topology.ruptures.size() > 0);
    CHECK(static_cast<std::size_t>(std::ranges::count(scene.stage.model().pins.hard, true)) > pinned + 5);
    scene.stage.post(SetGravity{{0, 5, -9.81}});
    CHECK_FALSE(scene.stage.run(50, 1e-3).has(StepFlag::Undone));
    check(scene.stage.model(), scene.stage.soft());
}

TEST_CASE("a reset keeps a material and pins that were set meanwhile, with their ids")
{
    CutScene scene(tissueBlock(), 0.0262);
    scene.move(0.04, 0.01);
    scene.stage.post(SetMaterial{scene.tissue, FemMaterial{.youngModulus = 9e3}, nullptr});
    scene.stage.post(Reset{});
    scene.stage.step(1e-3);
    CHECK(scene.stage.model().elements.front().youngModulus == 9e3);
    REQUIRE(scene.stage.model().pins.groups.size() == 1);
    const AttachmentId pins = scene.stage.model().pins.groups[0].id;
    CHECK(pins.value == 1);
    scene.stage.post(Release{pins});
    scene.stage.post(SetGravity{{0, 0, -9.81}});
    scene.stage.run(20, 1e-3);
    CHECK(scene.stage.soft().v[0].z < -0.1); // it falls
    scene.stage.post(Reset{});
    scene.stage.run(20, 1e-3);
    CHECK(scene.stage.soft().v[0].z < -0.1); // and is not pinned again
}

TEST_CASE("a pin's spring slides with its node")
{
    SoftBodyDef def = tissueBlock();
    def.gravity = false;
    def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1, 1}}, .stiffness = 50.0}};
    CutScene scene(def, 0.0262);
    scene.move(0.04, -0.01, 0.2);
    scene.stage.run(200, 1e-3);
    const SoftModel& model = scene.stage.model();
    for (const PinSpring& pin : model.pins.springs)
        CHECK(length(pin.anchor - model.rest[static_cast<std::size_t>(pin.node)]) < 1e-12);
}

TEST_CASE("a piece that fell out of the scene is removed once, and the rest goes on")
{
    SoftBodyDef def = tissueBlock();
    def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1e-6, 1, 1}}}};
    CutScene scene(def, 0.0262);
    const std::vector<double>& masses = scene.stage.model().masses;
    const double whole = std::accumulate(masses.begin(), masses.end(), 0.0);
    const StepReport cut = scene.move(0.04, -0.01);
    CHECK(detachedOf(cut) == 1);
    physics::LoosePiece loose;
    for (const physics::Rupture& each : cut.topology.ruptures)
        if (!each.detached.empty()) loose = each.detached.front();
    scene.stage.post(SetPose{scene.blade, 0, scene.poseAt(1.0)});
    REQUIRE(scene.stage.model().pieces.size() == 2);
    for (const int node : scene.stage.model().pieces[1].nodes)
        scene.stage.soft().v[static_cast<std::size_t>(node)] = {0, 0, -300.0};
    StepReport all;
    for (int i = 0; i < 600; ++i) {
        const StepReport report = scene.stage.step(1e-3);
        all.flags |= report.flags;
        all.topology.lost += report.topology.lost;
        for (const physics::LostPiece& each : report.topology.lostPieces) all.topology.lostPieces.push_back(each);
    }
    CHECK(all.flags == 0);
    CHECK(all.topology.lost == 1);
    REQUIRE(all.topology.lostPieces.size() == 1);
    const physics::LostPiece& lost = all.topology.lostPieces.front();
    CHECK(lost.body == scene.stage.model().id);
    CHECK(lost.mass == Approx(loose.mass));
    CHECK(lost.share == Approx(loose.mass / whole));
    check(scene.stage.model(), scene.stage.soft());
}

TEST_CASE(
    "every law, with fibres, relaxation and regions: a cut passes on what its elements are made of, with the same "
    "bits for 1, 2 and 8 threads")
{
    geometry::TetMesh mesh = boxMesh({6, 5, 4}, {0.05, 0.04, 0.03}, 0.2);
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) mesh.labels.push_back(static_cast<int>(t % 3));
    for (const auto& [name, law] : everyLaw()) {
        FemMaterial material{.youngModulus = 5e3, .law = law};
        material.fibres = {
            {.stiffness = 2e3, .activeStress = 100.0, .direction = Along{{1, 0, 1}}, .where = Labelled{.label = 1}}};
        material.relaxation = {{.share = 0.5, .time = 0.02}};
        material.regions = {{.where = Labelled{.label = 2}, .youngModulus = 9e3, .restScale = 0.98}};
        SoftBodyDef def = tissueBlock();
        def.mesh = shared(mesh);
        def.material = material;
        std::set<std::uint64_t> hashes;
        for (int threads : {1, kManyThreads}) {
            INFO(name << ", " << threads << " threads");
            CutScene scene(def, 0.023, 0.1, {.threads = threads});
            const StepReport report = scene.move(0.035, 0.012, 0.2);
            CHECK(!report.has(StepFlag::Undone));
            CHECK(!report.topology.ruptures.empty());
            const SoftModel& model = scene.stage.model();
            CHECK(model.elements.size() > mesh.tetrahedra.size());
            check(model, scene.stage.soft());
            int different = 0;
            for (std::size_t e = 0; e < model.elements.size(); ++e) {
                const int label = mesh.labels[static_cast<std::size_t>(model.elements[e].tetrahedron)];
                different += (model.fibres[0][e] != Vec3{}) != (label == 1);
                different += model.elements[e].youngModulus != (label == 2 ? 9e3 : 5e3);
                different += model.elements[e].restScale != (label == 2 ? 0.98 : 1.0);
            }
            CHECK(different == 0);
            hashes.insert(scene.stage.world.hash());
        }
        CHECK(hashes.size() == 1);
    }
}

} // namespace cutting_test
