#include "filasofia/engine/native_engine.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/physics/physics_server.h"

#include "engine/stage.h"

#include <limits>

namespace cutting_refused_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TriangleMeshSource rectangle(double width, double height)
{
    const double y = 0.5 * width;
    return std::make_shared<const geometry::TriangleMesh>(
        geometry::TriangleMesh{.vertices = {{0, -y, 0}, {0, y, 0}, {0, y, height}, {0, -y, height}},
                               .triangles = {{0, 1, 2}, {0, 2, 3}},
                               .uv = {}});
}

/// A block of 5 x 4 x 3 cm whose diagonal is 7 cm, and a blade above it.
struct TestScene {
    Stage stage;
    BodyId tissue, blade;
    std::size_t nodes = 0, elements = 0;

    explicit TestScene(TriangleMeshSource mesh, bool dynamicTopology = true)
    {
        tissue = stage.add(SoftBodyDef{.mesh = shared(boxMesh({5, 4, 3}, {0.05, 0.04, 0.03}, 0.2)),
                                       .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1, 1e-6}}}},
                                       .dynamicTopology = dynamicTopology});
        blade = stage.add(RigidBodyDef{.elements = {at(0.04)},
                                       .collision = {{.mesh = std::move(mesh), .proximity = 0, .cutting = true}}});
        stage.step(0.0);
        nodes = stage.model().rest.size();
        elements = stage.model().elements.size();
    }
    static Pose at(double z) { return {.position = {0.0262, 0.02, z}}; }
    TopologyReport move(double from, double to, int steps)
    {
        TopologyReport all;
        for (int i = 0; i <= steps; ++i) {
            stage.post(SetPose{blade, 0, at(from + (to - from) * i / steps)});
            add(stage.step(1e-3), all);
        }
        return all;
    }
    static void add(const StepReport& report, TopologyReport& all)
    {
        CHECK(report.flags == 0);
        all.bladeNotFinite += report.topology.bladeNotFinite;
        all.bladeNoLength += report.topology.bladeNoLength;
        all.bladeJump += report.topology.bladeJump;
        all.bladeTooFast += report.topology.bladeTooFast;
    }
    void checkUnchanged()
    {
        CHECK(stage.model().rest.size() == nodes);
        CHECK(stage.model().elements.size() == elements);
        frame::Frame frame;
        stage.world.capture(frame);
        CHECK((!frame.softBodies[0].boundary || frame.softBodies[0].boundary->revision == 0));
        check(stage.model(), stage.soft());
    }
};

} // namespace

TEST_CASE("a blade hardly longer than a point cuts nothing and is counted")
{
    TestScene scene(rectangle(1e-12, 1e-12));
    CHECK(scene.move(0.035, 0.001, 40).bladeNoLength > 0);
    scene.checkUnchanged();
}

TEST_CASE("a blade whose position is not finite cuts nothing and changes nothing")
{
    TestScene scene(rectangle(0.06, 0.05));
    scene.move(0.035, 0.031, 4);
    scene.stage.world.scene().rigid[0].state.poses[0].position.x = kNaN; // a server would not allow this
    TopologyReport all;
    for (int i = 0; i < 3; ++i) {
        const StepReport report = scene.stage.step(1e-3);
        all.bladeNotFinite += report.topology.bladeNotFinite;
    }
    CHECK(all.bladeNotFinite == 3);
    scene.checkUnchanged();
    for (const Vec3& x : scene.stage.soft().x) CHECK(isFinite(x));
}

TEST_CASE("a blade that moves further in one step than the body's diagonal cuts nothing and is counted")
{
    TestScene scene(rectangle(0.06, 0.05));
    TopologyReport all;
    scene.move(0.04, 0.035, 5);
    for (double z : {0.031, -0.069}) { // the second one goes 10 cm through the block, within the allowed speed
        scene.stage.post(SetPose{scene.blade, 0, TestScene::at(z)});
        TestScene::add(scene.stage.step(z < 0 ? 2e-2 : 1e-3), all);
    }
    CHECK(all.bladeJump == 1);
    CHECK(all.bladeTooFast == 0);
    scene.checkUnchanged();
}

TEST_CASE("a blade commanded to jump is counted only if it would have cut")
{
    const auto jump = [](Pose from, Pose to, double dt, bool dynamicTopology = true) {
        TestScene scene(rectangle(0.06, 0.05), dynamicTopology);
        TopologyReport there, all;
        for (const Pose& pose : {from, to, to}) {
            scene.stage.post(SetPose{scene.blade, 0, pose});
            TestScene::add(scene.stage.step(dt), pose == from ? there : all);
        }
        scene.checkUnchanged();
        return all;
    };
    const Pose above = TestScene::at(0.035), below = TestScene::at(-0.06), far = TestScene::at(1.0),
               farther = TestScene::at(2.0);
    CHECK(jump(above, below, 1e-3).bladeTooFast == 1); // 95 m/s, across the block
    CHECK(jump(above, below, 1e-3).refused() == 1);
    CHECK(jump(above, below, 1e-3, false).refused() == 0);
    CHECK(jump(far, farther, 1e-3).refused() == 0); // no body is there
    Pose turned = above; // rotates down through the block about its lower edge: slow enough except for the rotation
    turned.orientation = axisAngle({0, 1, 0}, 2.0);
    CHECK(jump(above, turned, 1e-3).bladeTooFast == 1);
    turned.orientation = axisAngle({0, 1, 0}, 0.2);
    CHECK(jump(above, turned, 1e-3).bladeTooFast == 0);
}

TEST_CASE("a pose that is not finite is refused by the server with one error, and the blade goes on cutting")
{
    PhysicsServer server{makeNativeEngine({.threads = 1})};
    const BodyId tissue = server.add(SoftBodyDef{.name = "tissue",
                                                 .mesh = shared(boxMesh({5, 4, 3}, {0.05, 0.04, 0.03}, 0.2)),
                                                 .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1, 1e-6}}}},
                                                 .dynamicTopology = true});
    const BodyId blade =
        server.add(RigidBodyDef{.name = "scalpel",
                                .elements = {TestScene::at(0.035)},
                                .collision = {{.mesh = rectangle(0.06, 0.05), .proximity = 0, .cutting = true}}});
    for (int i = 0; i < 3; ++i) server.step(1e-3);
    const std::uint64_t hash = server.hash();

    Pose nowhere = TestScene::at(0.03), nohow = TestScene::at(0.03);
    nowhere.position.x = kNaN;
    nohow.orientation.y = kNaN;
    CHECK_THROWS_WITH(server.setPose(blade, nowhere), Catch::Contains("scalpel") && Catch::Contains("position.x") &&
                                                          Catch::Contains("must be finite") &&
                                                          Catch::Contains("got nan"));
    CHECK_THROWS_WITH(server.setPose(blade, nohow),
                      Catch::Contains("scalpel") && Catch::Contains("orientation.y") && Catch::Contains("got nan"));
    server.pause(true);
    CHECK(server.step(1e-3).topology.refused() == 0);
    CHECK(server.hash() == hash);
    server.pause(false);

    int opened = 0;
    for (int i = 0; i <= 40; ++i) {
        server.setPose(blade, TestScene::at(0.035 - 5e-4 * i));
        const StepReport report = server.step(1e-3);
        CHECK(report.flags == 0);
        CHECK(report.topology.refused() == 0);
        opened += static_cast<int>(report.topology.ruptures.size());
    }
    CHECK(opened > 0);
    for (const Vec3& x : server.latest()->softBody(tissue)->positions) CHECK(isFinite(x));
}

TEST_CASE("cutting a body without dynamicTopology is no error and has no effect")
{
    TestScene scene(rectangle(0.06, 0.05), false);
    const TopologyReport all = scene.move(0.035, 0.0, 70);
    CHECK(all.refused() == 0);
    scene.checkUnchanged();
}

TEST_CASE("a tearing threshold of zero or without dynamicTopology is refused")
{
    const Stage stage;
    const auto built = [&](double threshold, bool dynamicTopology) {
        SoftBodyDef def{.name = "skin", .mesh = shared(boxMesh({2, 2, 2}, {0.01, 0.01, 0.01}))};
        def.material = FemMaterial{.tearingThreshold = threshold};
        def.dynamicTopology = dynamicTopology;
        return stage.world.build(def);
    };
    for (double threshold : {0.0, -1.0, kNaN})
        CHECK_THROWS_WITH(built(threshold, true), Catch::Contains("tearingThreshold"));
    CHECK_THROWS_WITH(built(1000.0, false), Catch::Contains("dynamicTopology"));
    CHECK_NOTHROW(built(1000.0, true));
}

} // namespace cutting_refused_test
