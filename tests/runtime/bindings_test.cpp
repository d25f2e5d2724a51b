#include "filasofia/runtime/bindings.h"

#include "filasofia/core/error.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/geometry/mesh_file.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/geometry/surface.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/physics/physics_server.h"
#include "filasofia/runtime/assets.h"
#include "filasofia/visual/visual_server.h"

namespace bindings_test {

using namespace filasofia;
using namespace filasofia::runtime;

namespace {

/// A physics server, a null visual server and the bindings between them.
struct Stage {
    physics::PhysicsServer physics{engine::makeNativeEngine()};
    Bindings bindings;
    visual::VisualServer visual{{.backend = visual::Backend::Null}};

    BodyId addBunny(const Pose& pose = {})
    {
        return physics.add(physics::SoftBodyDef{.mesh = asset("meshes/bunny_756.msh"), .pose = pose});
    }
    void map()
    {
        bindings.addPending(visual);
        if (const auto frame = physics.latest()) bindings.update(*frame, physics, visual);
    }
    int drawn() { return visual.statistics().bodies; }
};

SurfaceSource sharedBunny()
{
    return std::make_shared<const geometry::TriangleMesh>(geometry::loadTriangleMesh(asset("meshes/bunny.obj")));
}

} // namespace

TEST_CASE("a skin stays on its body, also where the orientation given was not of unit length")
{
    Stage stage;
    const Pose pose{{0.1, 0, 0}, {1, 0, 1, 0}}; // length sqrt 2
    const BodyId id = stage.addBunny(pose);
    const geometry::TetMesh mesh = geometry::loadTetMesh(asset("meshes/bunny_756.msh"));
    const auto boundary = std::make_shared<const geometry::TriangleMesh>(geometry::extractSurface(mesh).mesh);
    stage.bindings.show(id, {.surface = boundary}, stage.physics);
    const geometry::Box skin = stage.bindings.bounds();
    stage.physics.setGravity({});
    stage.physics.step(1e-3);
    geometry::Box body;
    for (const Vec3& p : stage.physics.latest()->softBody(id)->positions) body = merged(body, p);
    CHECK(distance(skin.low, body.low) < 1e-8); // an engine that computes in float moves a body at rest by 1e-10 m
    CHECK(distance(skin.high, body.high) < 1e-8);
}

TEST_CASE("the bounds hold rigid bodies where they start")
{
    Stage stage;
    const BodyId id = stage.physics.add(physics::RigidBodyDef{.elements = {Pose{{5, 6, 7}, {}}}});
    stage.bindings.show(id, {.surface = sharedBunny()}, stage.physics);
    CHECK(distance(stage.bindings.bounds().low, {5, 6, 7}) < 0.3);
}

TEST_CASE("what is drawn of a soft body moves with its nodes, of a rigid one with its pose")
{
    Stage stage;
    const BodyId soft = stage.addBunny(), rigid = stage.physics.add(physics::RigidBodyDef{});
    stage.bindings.show(soft, {}, stage.physics);
    stage.bindings.show(rigid, {.surface = sharedBunny()}, stage.physics);
    stage.physics.setPose(rigid, {{1, 2, 3}, {}});
    stage.physics.step(0.01);
    stage.map();
    const long before = stage.visual.statistics().vertexUpdates;
    stage.physics.step(0.01);
    stage.map();
    CHECK(stage.drawn() == 2);
    CHECK(stage.visual.statistics().vertexUpdates == before + 1); // only the soft body; the rigid one has a pose
}

TEST_CASE("a shell is drawn as its triangles or as a surface of its nodes, and any other surface is refused")
{
    Stage stage;
    const auto sheet = geometry::shapes::sheet(0.1, 0.1, {4, 4});
    const BodyId id = stage.physics.add(physics::SoftBodyDef{
        .name = "peritoneum", .mesh = sheet, .pose = {{0, 0.2, 0}, {}}, .material = physics::ShellMaterial{}});
    stage.bindings.show(id, {}, stage.physics);
    stage.bindings.show(id, {.surface = sheet}, stage.physics);
    CHECK_THROWS_WITH(stage.bindings.show(id, {.surface = geometry::shapes::sheet(0.1, 0.1, {8, 8})}, stage.physics),
                      Catch::Contains("peritoneum") && Catch::Contains("vertices at nodes of the shell"));
    CHECK(stage.bindings.bounds().low.y == Approx(0.2));
    stage.physics.step(1e-2);
    stage.map();
    CHECK(stage.drawn() == 2);
    const long before = stage.visual.statistics().vertexUpdates;
    stage.physics.step(1e-2);
    stage.map();
    CHECK(stage.visual.statistics().vertexUpdates == before + 2);
}

TEST_CASE("a removed body is no longer drawn")
{
    Stage stage;
    const BodyId id = stage.addBunny();
    stage.bindings.show(id, {}, stage.physics);
    stage.physics.step(0.01);
    stage.map();
    CHECK(stage.drawn() == 1);
    stage.physics.remove(id);
    stage.physics.step(0.01);
    stage.map();
    CHECK(stage.drawn() == 0);
}

TEST_CASE("a body that was removed before it was ever drawn leaves no ghost")
{
    Stage stage;
    const BodyId id = stage.addBunny();
    stage.bindings.show(id, {}, stage.physics);
    stage.physics.remove(id);
    stage.physics.step(0.01);
    stage.map();
    CHECK(stage.drawn() == 0);
}

TEST_CASE("a body that was shown before its first step is waited for")
{
    Stage stage;
    stage.physics.step(0.01);
    const BodyId id = stage.addBunny();
    stage.bindings.show(id, {}, stage.physics);
    stage.map(); // the frame is older than the body
    CHECK(stage.drawn() == 1);
    stage.physics.step(0.01);
    stage.map();
    CHECK(stage.drawn() == 1);
}

TEST_CASE("what a visual server refuses stays pending, with all that comes after it")
{
    Stage stage;
    const BodyId id = stage.addBunny();
    // Three triangles on one edge: valid as it is, but it cannot be subdivided.
    auto fin = std::make_shared<geometry::TriangleMesh>();
    fin->vertices = {{0, 0, 0}, {0, 0, 0.1}, {0.1, 0, 0}, {-0.1, 0, 0}, {0, 0.1, 0}};
    fin->triangles = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}};
    stage.bindings.show(id, {}, stage.physics);
    stage.bindings.show(id, {.surface = fin, .subdivision = 1}, stage.physics);
    stage.bindings.show(id, {}, stage.physics);
    CHECK_THROWS_AS(stage.bindings.addPending(stage.visual), Error);
    CHECK(stage.drawn() == 1);
    CHECK_THROWS_AS(stage.bindings.addPending(stage.visual), Error); // nothing twice, nothing lost
    CHECK(stage.drawn() == 1);
}

TEST_CASE("a rigid body without a surface is drawn as its own mesh, every element of it")
{
    Stage stage;
    const auto box = geometry::shapes::box({0.02, 0.04, 0.06});
    const BodyId id = stage.physics.add(physics::RigidBodyDef{
        .elements = {Pose{{1, 0, 0}, {}}, Pose{{2, 0, 0}, {}}, Pose{{3, 0, 0}, {}}}, .mesh = box});
    stage.bindings.show(id, {}, stage.physics);
    CHECK(stage.bindings.bounds() == geometry::Box{{0.99, -0.02, -0.03}, {3.01, 0.02, 0.03}});
    stage.physics.step(0.01);
    stage.map();
    CHECK(stage.drawn() == 3);
    stage.physics.remove(id);
    stage.physics.step(0.01);
    stage.map();
    CHECK(stage.drawn() == 0);
}

TEST_CASE("a rigid body that has no mesh, or an element that is asked for without a surface, cannot be shown")
{
    Stage stage;
    const std::vector<Pose> poses(2);
    const BodyId bare = stage.physics.add(physics::RigidBodyDef{.name = "probe", .elements = poses});
    CHECK_THROWS_WITH(
        stage.bindings.show(bare, {}, stage.physics),
        "show rigid body 'probe': surface must name a file or be a surface, as the body has no mesh of its "
        "own");
    const BodyId boxes = stage.physics.add(
        physics::RigidBodyDef{.name = "boxes", .elements = poses, .mesh = geometry::shapes::box({0.02, 0.04, 0.06})});
    CHECK_THROWS_WITH(stage.bindings.show(boxes, {.element = 1}, stage.physics),
                      "show rigid body 'boxes': element needs a surface (without one every element is drawn), got 1");
    CHECK_THROWS_WITH(stage.bindings.show(boxes, {.element = 2}, stage.physics), Catch::Contains("must be in [0, 2)"));
}

} // namespace bindings_test
