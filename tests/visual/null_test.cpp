#include "little_scene.h"

#include "filasofia/visual/native.h"
#include "filasofia/visual/null_backend.h"
#include "filasofia/visual/scene.h"

#include <csignal>
#include <sys/wait.h>
#include <unistd.h>

namespace null_test {

using namespace filasofia;
using namespace filasofia::visual;

namespace {

const NullBackend& backendOf(VisualBody& body) { return dynamic_cast<const NullBackend&>(*body.impl().scene.backend); }
const NullBackend::Body& bodyOf(VisualBody& body) { return backendOf(body).bodies.at(body.impl().slot); }

} // namespace

TEST_CASE("the null backend gets every vertex of a body, and new ones when it deforms")
{
    VisualServer server({.backend = Backend::Null});
    VisualBody& body = server.add(sphereDef(0.05, 1));
    const auto& kept = bodyOf(body);
    REQUIRE(kept.geometry.vertices.positions.size() == body.vertices().size());
    CHECK(server.statistics().vertexUpdates == 1);

    std::vector<Vec3> moved(body.vertices().begin(), body.vertices().end());
    for (Vec3& v : moved) v += Vec3{1, 2, 3};
    body.setVertices(moved);
    CHECK(kept.vertexCalls == 1);
    CHECK(server.statistics().vertexUpdates == 2);
    CHECK(body.vertices()[5] == moved[5]);
    CHECK(kept.geometry.vertices.positions[5] == toFloat3(moved[5]));
    CHECK(kept.geometry.vertices.low.x == Approx(0.95));
    CHECK(kept.geometry.vertices.high.z == Approx(3.05));
    // The pattern stays with the shape at rest.
    CHECK(kept.geometry.rest[5] == toFloat3(moved[5] - Vec3{1, 2, 3}));
}

TEST_CASE("a subdivided body sends its refined vertices and surface state")
{
    VisualServer server({.backend = Backend::Null});
    VisualBodyDef def = sphereDef(0.05, 1);
    def.subdivision = 2;
    VisualBody& body = server.add(def);
    const auto& kept = bodyOf(body);
    CHECK(kept.geometry.indices.size() == 3 * def.mesh.triangles.size() * 16);
    CHECK(kept.geometry.rest.size() == kept.geometry.vertices.positions.size());
    CHECK(kept.geometry.rest.size() > std::size_t(body.vertexCount()));

    body.setSurfaceState(std::vector<SurfaceState>(std::size_t(body.vertexCount()), {1.0, 0.5, 0.0}));
    for (const PackedState& state : kept.states) {
        CHECK(state[0] == 255);
        CHECK(int(state[1]) >= 127);
        CHECK(int(state[1]) <= 128);
        CHECK(state[2] == 0);
    }
}

TEST_CASE("seam and heat go beside the surface state, and new triangles have none of them")
{
    VisualServer server({.backend = Backend::Null});
    VisualBody& body = server.add(sphereDef(0.05, 1));
    const auto& kept = bodyOf(body);
    const auto count = std::size_t(body.vertexCount());
    body.setHeat(std::vector<float>(count, 0.0F));
    body.setSurfaceState(std::vector<SurfaceState>(count, {1.0, 0.0, 0.2}));
    std::vector<std::uint8_t> rim(count, 0);
    rim[3] = 1;
    body.setSeam(rim);
    CHECK(kept.states[3] == PackedState{255, 0, 51, 255, 64});
    CHECK(kept.states[4] == PackedState{255, 0, 51, 0, 64});
    body.setHeat(std::vector<float>(count, 3.0F));
    CHECK(kept.states[3] == PackedState{255, 0, 51, 255, 255});

    CHECK_THROWS_WITH(body.setSeam(std::vector<std::uint8_t>(2)),
                      text("body 'ball': needs one seam flag for each of its ", count, " vertices, got 2"));
    CHECK_THROWS_WITH(body.setHeat({}),
                      text("body 'ball': needs one level of heat for each of its ", count, " vertices, got 0"));
    std::vector<float> wrong(count, 0.0F);
    for (const float bad : {3.5F, -1.1F, std::nanf("")}) {
        wrong[2] = bad;
        CHECK_THROWS_WITH(body.setHeat(wrong),
                          Catch::Contains("body 'ball': the heat of vertex 2 must be in [-1, 3], got "));
    }
    CHECK(kept.states[3] == PackedState{255, 0, 51, 255, 255});

    const geometry::TriangleMesh mesh = sphere(0.05, 1);
    body.setMesh(mesh, mesh.vertices);
    body.setHeat(std::vector<float>(count, -1.0F));
    CHECK(kept.states[3] == PackedState{});
}

TEST_CASE("a cut body gets new triangles and keeps its rest shape")
{
    VisualServer server({.backend = Backend::Null});
    VisualBody& body = server.add(sphereDef(0.05, 1));
    geometry::TriangleMesh cut = sphere(0.05, 1);
    const std::vector<Vec3> rest = cut.vertices;
    cut.triangles.resize(20);
    for (Vec3& v : cut.vertices) v.y += 1.0;
    body.setMesh(cut, rest);
    const auto& kept = bodyOf(body);
    CHECK(kept.geometryCalls == 1);
    CHECK(kept.geometry.indices.size() == 60);
    CHECK(kept.geometry.rest[3] == toFloat3(rest[3]));
    CHECK(kept.geometry.vertices.positions[3] == toFloat3(cut.vertices[3]));
    CHECK(body.triangles().size() == 20);
}

TEST_CASE("world poses, not relative ones, reach the backend")
{
    VisualServer server({.backend = Backend::Null});
    VisualBody& body = server.add(sphereDef());
    Transform& rig = server.addTransform("rig");
    rig.setPose({{1, 0, 0}, axisAngle({0, 0, 1}, std::acos(0.0))});
    body.attachTo(rig);
    body.setPose({{0.5, 0, 0}, {}});
    server.render();
    CHECK(distance(bodyOf(body).pose.position, {1, 0.5, 0}) < 1e-12);
    server.remove(rig);
    server.render();
    CHECK(distance(bodyOf(body).pose.position, {1, 0.5, 0}) < 1e-12);
}

TEST_CASE("the server counts what it has and what it drew")
{
    LittleScene scene(Backend::Null);
    const NullBackend& backend = backendOf(scene.body);
    for (int i = 0; i < 3; ++i) CHECK(scene.server.render());
    const Image image = scene.server.capture();
    CHECK(image.width == 320);
    CHECK(image.height == 240);
    CHECK(brightness(image) == 0.0);
    const VisualStatistics now = scene.server.statistics();
    CHECK(now.framesDrawn == 4);
    CHECK(now.framesSkipped == 0);
    CHECK(now.bodies == 1);
    CHECK(now.lights == 1);
    CHECK(now.cameras == 1);
    CHECK(now.views == 1);

    scene.server.remove(*scene.look.view);
    scene.server.remove(*scene.look.camera);
    scene.server.remove(*scene.look.light);
    scene.server.remove(scene.body);
    CHECK(scene.server.statistics().bodies == 0);
    CHECK(scene.server.statistics().cameras == 0);
    CHECK(backend.bodies.empty());
    CHECK(backend.placed.empty());
}

TEST_CASE("a resized server gives pictures of the new size")
{
    LittleScene scene(Backend::Null);
    scene.server.resize(100, 50);
    CHECK(scene.server.width() == 100);
    CHECK(scene.server.capture().height == 50);
}

TEST_CASE("material, visibility, light and camera can be changed")
{
    LittleScene scene(Backend::Null);
    scene.body.setMaterial(MetalMaterial{.roughness = 0.1});
    scene.body.setVisible(false);
    scene.server.render();
    CHECK_FALSE(scene.body.visible());
    CHECK_FALSE(bodyOf(scene.body).visible);
    CHECK(std::get<MetalMaterial>(bodyOf(scene.body).material).roughness == 0.1);
    LightDef light = scene.look.light->def();
    light.kind = PointLight{.intensity = 3.0};
    scene.look.light->set(light);
    CHECK(std::get<PointLight>(scene.look.light->def().kind).intensity == 3.0);
    CameraDef camera = scene.look.camera->def();
    camera.exposure = 5.0;
    scene.look.camera->set(camera);
    CHECK(scene.look.camera->def().exposure == 5.0);
}

TEST_CASE("the null backend has no native objects")
{
    LittleScene scene(Backend::Null);
    CHECK(native::engine(scene.server) == nullptr);
    CHECK(native::renderer(scene.server) == nullptr);
    CHECK(native::scene(scene.server) == nullptr);
    CHECK(native::view(*scene.look.view) == nullptr);
}

TEST_CASE("a server stops the program when another thread draws")
{
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        std::signal(SIGABRT, SIG_DFL); // instead of the test framework's handler
        close(STDERR_FILENO);
        VisualServer server({.backend = Backend::Null});
        std::thread([&] { server.render(); }).join();
        _exit(0); // not reached
    }
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    REQUIRE(WIFSIGNALED(status));
    CHECK(WTERMSIG(status) == SIGABRT);
}

} // namespace null_test
