// Wrong use, on every backend of this build: an Error each time, and the server goes on.
#include "little_scene.h"

#include "filasofia/core/error.h"

namespace wrong_use_test {

using namespace filasofia;
using namespace filasofia::visual;
using Catch::Contains;

namespace {

const double kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<Backend> backends()
{
    std::vector<Backend> all{Backend::Null};
    if (hasBackend(Backend::Headless)) all.push_back(Backend::Headless);
    return all;
}

/// A Def after one change.
template <class Def, class Change> Def with(Def def, Change&& change)
{
    change(def);
    return def;
}

} // namespace

TEST_CASE("a server without a size is an error")
{
    for (Backend backend : backends()) {
        CHECK_THROWS_WITH(VisualServer({.backend = backend, .width = 0}), Contains("width"));
        CHECK_THROWS_WITH(VisualServer({.backend = backend, .height = -5}), Contains("height"));
        CHECK_THROWS_AS(VisualServer({.backend = backend, .width = 100000}), Error);
        LittleScene scene(backend);
        CHECK_THROWS_WITH(scene.server.resize(0, 10), Contains("width"));
        CHECK_THROWS_WITH(scene.server.resize(10, 0), Contains("height"));
        CHECK(scene.server.capture().width == 320);
    }
}

TEST_CASE("a wrong body is an error that names it")
{
    for (Backend backend : backends()) {
        LittleScene scene(backend);
        const auto refused = [&](const char* what, auto&& change) {
            CHECK_THROWS_WITH(scene.server.add(with(sphereDef(), change)), Contains("ball") && Contains(what));
        };
        refused("", [](VisualBodyDef& d) { d.mesh.triangles[0][1] = 1000000; });
        refused("", [](VisualBodyDef& d) { d.mesh.triangles[0][1] = -1; });
        refused("", [](VisualBodyDef& d) { d.mesh.triangles.clear(); });
        refused("", [](VisualBodyDef& d) { d.mesh = {}; });
        refused("vertex 7", [](VisualBodyDef& d) { d.mesh.vertices[7].y = kNan; });
        refused("vertex 7", [](VisualBodyDef& d) { d.mesh.vertices[7].y = 1e30; });
        refused("subdivision", [](VisualBodyDef& d) { d.subdivision = 4; });
        refused("subdivision", [](VisualBodyDef& d) { d.subdivision = -1; });
        refused("roughness", [](VisualBodyDef& d) { d.material = TissueMaterial{.roughness = 0.0}; });
        refused("wetness", [](VisualBodyDef& d) { d.material = TissueMaterial{.wetness = kNan}; });
        refused("red", [](VisualBodyDef& d) { d.material = MetalMaterial{.baseColor = {1.5, 0, 0}}; });
        CHECK(scene.server.statistics().bodies == 1);
        CHECK(scene.server.render());
    }
}

TEST_CASE("wrong vertices are an error, and the old shape stays")
{
    for (Backend backend : backends()) {
        LittleScene scene(backend);
        const Image before = scene.server.capture();
        const std::vector<Vec3> good(scene.body.vertices().begin(), scene.body.vertices().end());
        std::vector<Vec3> bad = good;
        bad[3].z = kNan;
        CHECK_THROWS_WITH(scene.body.setVertices(bad), Contains("ball") && Contains("vertex 3"));
        bad[3].z = std::numeric_limits<double>::infinity();
        CHECK_THROWS_AS(scene.body.setVertices(bad), Error);
        bad.pop_back();
        CHECK_THROWS_AS(scene.body.setVertices(bad), Error);
        CHECK_THROWS_AS(scene.body.setVertices({}), Error);
        CHECK_THROWS_AS(scene.body.setSurfaceState({}), Error);
        CHECK_THROWS_AS(scene.body.setSurfaceState(std::vector<SurfaceState>(good.size(), {2.0, 0, 0})), Error);
        CHECK_THROWS_AS(scene.body.setSurfaceState(std::vector<SurfaceState>(good.size(), {kNan, 0, 0})), Error);
        CHECK_THROWS_WITH(scene.body.setMaterial(MetalMaterial{.roughness = 7}), Contains("roughness"));

        geometry::TriangleMesh mesh = sphere(0.05, 2);
        CHECK_THROWS_AS(scene.body.setMesh(mesh, {}), Error);
        mesh.triangles[0][0] = 99999;
        CHECK_THROWS_WITH(scene.body.setMesh(mesh, good), Contains("ball"));
        CHECK(scene.server.capture() == before);
    }
}

TEST_CASE("wrong lights, cameras, views and surroundings are errors that name the field")
{
    for (Backend backend : backends()) {
        LittleScene scene(backend);
        VisualServer& server = scene.server;
        CHECK_THROWS_WITH(server.add(LightDef{.name = "lamp", .kind = SpotLight{.intensity = 0}}),
                          Contains("lamp") && Contains("intensity"));
        CHECK_THROWS_WITH(server.add(LightDef{.kind = SpotLight{.innerAngle = 0.5, .outerAngle = 0.4}}),
                          Contains("innerAngle"));
        CHECK_THROWS_WITH(server.add(LightDef{.kind = PointLight{.range = -1}}), Contains("range"));
        CHECK_THROWS_WITH(server.add(LightDef{.color = {0, 0, kNan}}), Contains("blue"));
        CHECK_THROWS_WITH(server.add(CameraDef{.name = "eye", .near = 0}), Contains("eye") && Contains("near"));
        CHECK_THROWS_WITH(server.add(CameraDef{.near = 1, .far = 0.5}), Contains("far"));
        CHECK_THROWS_WITH(server.add(CameraDef{.verticalFieldOfView = 3.2}), Contains("verticalFieldOfView"));
        CHECK_THROWS_WITH(server.add(ViewDef{.viewport = {.width = 0}}, *scene.look.camera), Contains("width"));
        CHECK_THROWS_WITH(server.add(ViewDef{.viewport = {.left = 0.6, .width = 0.6}}, *scene.look.camera),
                          Contains("left"));
        CHECK_THROWS_WITH(server.setEnvironment({.lampDirection = {}}), Contains("lampDirection"));
        CHECK_THROWS_WITH(server.setEnvironment({.intensity = -1}), Contains("intensity"));
        CHECK_THROWS_AS(addEndoscopeLook(server, geometry::Box{}), Error);
        CHECK_THROWS_AS(addEndoscopeLook(server, geometry::Box{{0, 0, 0}, {kNan, 1, 1}}), Error);
        CHECK_THROWS_AS(boundsOf({}), Error);
        CHECK(server.render());
    }
}

TEST_CASE("a third spot light with shadows and a second directional light are errors")
{
    LittleScene scene(Backend::Null); // has one spot light with shadows
    Light& second = scene.server.add(LightDef{.name = "second"});
    CHECK_THROWS_WITH(scene.server.add(LightDef{.name = "third"}), Contains("third") && Contains("shadow"));
    Light& third = scene.server.add(LightDef{.name = "third", .castShadows = false});
    CHECK_THROWS_AS(third.set(LightDef{.name = "third"}), Error);
    CHECK_NOTHROW(second.set(second.def())); // it replaces itself
    scene.server.remove(second);
    CHECK_NOTHROW(third.set(LightDef{.name = "third"}));
    scene.server.add(LightDef{.kind = DirectionalLight{}});
    CHECK_THROWS_WITH(scene.server.add(LightDef{.kind = DirectionalLight{}}), Contains("directional"));
}

TEST_CASE("entities in use or of another server cannot be removed or shown")
{
    for (Backend backend : backends()) {
        LittleScene mine(backend), other(backend);
        CHECK_THROWS_WITH(mine.server.remove(*mine.look.camera), Contains("endoscope view"));
        CHECK_THROWS_AS(mine.server.remove(other.body), Error);
        CHECK_THROWS_AS(mine.server.remove(*other.look.view), Error);
        CHECK_THROWS_AS(mine.server.add(ViewDef{}, *other.look.camera), Error);
        CHECK_THROWS_AS(mine.look.view->setCamera(*other.look.camera), Error);
        Transform stray("stray");
        CHECK_THROWS_WITH(mine.server.remove(stray), Contains("stray"));
        CHECK(mine.server.render());
    }
}

TEST_CASE("a backend that this build or this machine does not have is an error")
{
    CHECK(hasBackend(Backend::Null));
    CHECK_THROWS_AS(VisualServer({.backend = Backend::Window, .nativeWindow = nullptr}), Error);
}

} // namespace wrong_use_test
