#include "little_scene.h"

#include "filasofia/visual/gpu.h"
#include "filasofia/visual/native.h"

#include "filasofia/core/error.h"

namespace headless_test {

using namespace filasofia;
using namespace filasofia::visual;

TEST_CASE("the machine can draw without a screen")
{
    const GpuReport gpu = probeGpu();
    INFO(gpu.problem);
    REQUIRE(gpu.available);
    CHECK_FALSE(gpu.renderer.empty());
    CHECK_FALSE(gpu.version.empty());
    CHECK(gpu.problem.empty());
    CHECK(probeGpu().renderer == gpu.renderer);
}

TEST_CASE("the body is lit, the background is dark")
{
    LittleScene scene;
    const Image image = scene.server.capture();
    CHECK(brightnessAt(image, 160, 120) > 40);
    for (int x : {0, 319})
        for (int y : {0, 239}) CHECK(brightnessAt(image, x, y) <= 2);
    const auto middle = image.pixel(160, 120);
    CHECK(middle[0] > middle[1]); // tissue is red
    CHECK(middle[0] > middle[2]);
    CHECK(middle[3] == 255);
}

TEST_CASE("the same scene gives the same picture, again and in another server")
{
    for (Quality quality : {Quality::Low, Quality::High}) {
        LittleScene first(Backend::Headless, quality);
        const Image image = first.server.capture();
        first.server.render();
        CHECK(first.server.capture() == image);
        LittleScene second(Backend::Headless, quality);
        CHECK(second.server.capture() == image);
    }
}

TEST_CASE("servers one after another work and end cleanly")
{
    for (int i = 0; i < 4; ++i) {
        LittleScene scene;
        CHECK(brightness(scene.server.capture()) > 3.0);
    }
    LittleScene one, two; // two servers at once
    CHECK(one.server.capture() == two.server.capture());
}

TEST_CASE("a picture's first row is the top")
{
    LittleScene scene;
    scene.body.setPose({{0.0, 0.06, 0.0}, {}});
    lookFromFront(scene);
    const Image image = scene.server.capture();
    CHECK(brightnessAt(image, 160, 78) > brightnessAt(image, 160, 162) + 20);
}

TEST_CASE("a body that moves moves in the picture")
{
    LittleScene scene;
    lookFromFront(scene);
    const Image before = scene.server.capture();
    scene.body.setPose({{0.08, 0, 0}, {}});
    const Image after = scene.server.capture();
    CHECK(difference(before, after) > 40);
    CHECK(brightnessAt(after, 250, 120) > brightnessAt(before, 250, 120) + 20);
    scene.body.setPose({});
    CHECK(scene.server.capture() == before);
}

TEST_CASE("a body that deforms deforms in the picture, and its pattern goes with it")
{
    LittleScene scene;
    const Image before = scene.server.capture();
    std::vector<Vec3> wide(scene.body.vertices().begin(), scene.body.vertices().end());
    const std::vector<Vec3> rest = wide;
    for (Vec3& v : wide) v.x *= 1.5;
    scene.body.setVertices(wide);
    CHECK(difference(scene.server.capture(), before) > 40);
    scene.body.setVertices(rest);
    CHECK(scene.server.capture() == before);
    // All vertices displaced and the body moved back: the pattern belongs to the rest shape, so nothing changes except
    // by rounding.
    std::vector<Vec3> shifted = rest;
    for (Vec3& v : shifted) v += Vec3{0.25, 0, 0};
    scene.body.setVertices(shifted);
    scene.body.setPose({{-0.25, 0, 0}, {}});
    const Image again = scene.server.capture();
    int changed = 0;
    for (std::size_t i = 0; i < again.rgba.size(); ++i) changed += std::abs(again.rgba[i] - before.rgba[i]) > 8;
    CHECK(changed < 200); // out of 307200 bytes; silhouettes may fall on the other side of a pixel
}

TEST_CASE("a hidden or removed body disappears, and a shown one comes back")
{
    LittleScene scene;
    const Image before = scene.server.capture();
    scene.body.setVisible(false);
    CHECK(brightness(scene.server.capture()) == 0.0);
    scene.body.setVisible(true);
    CHECK(scene.server.capture() == before);
    scene.server.remove(scene.body);
    CHECK(brightness(scene.server.capture()) == 0.0);
}

TEST_CASE("a body leaves the picture where triangles are cut away")
{
    LittleScene scene;
    const Image before = scene.server.capture();
    geometry::TriangleMesh cut = sphere(0.05, 2);
    const std::vector<Vec3> rest = cut.vertices;
    std::erase_if(cut.triangles, [&](const auto& t) { return rest[std::size_t(t[0])].x > 0.0; });
    scene.body.setMesh(cut, rest);
    const Image after = scene.server.capture();
    CHECK(difference(before, after) > 40);
    scene.body.setMesh(sphere(0.05, 2), rest);
    CHECK(scene.server.capture() == before);
}

TEST_CASE("blood, burns and other materials are seen")
{
    LittleScene scene;
    const Image tissue = scene.server.capture();
    const auto count = std::size_t(scene.body.vertexCount());
    scene.body.setSurfaceState(std::vector<SurfaceState>(count, {.burn = 1.0}));
    CHECK(brightness(scene.server.capture()) < 0.7 * brightness(tissue));
    scene.body.setSurfaceState(std::vector<SurfaceState>(count, {.blood = 1.0}));
    const Image blood = scene.server.capture();
    CHECK(difference(blood, tissue) > 40);
    scene.body.setMaterial(MetalMaterial{});
    const Image metal = scene.server.capture();
    CHECK(difference(metal, blood) > 40);
    scene.body.setMaterial(TissueMaterial{});
    scene.body.setSurfaceState(std::vector<SurfaceState>(count));
    CHECK(scene.server.capture() == tissue);
}

TEST_CASE("a resized server draws in the new size")
{
    LittleScene scene;
    const Image before = scene.server.capture();
    scene.server.resize(200, 300);
    const Image tall = scene.server.capture();
    CHECK(tall.width == 200);
    CHECK(tall.height == 300);
    CHECK(brightnessAt(tall, 100, 150) > 40);
    scene.server.resize(320, 240);
    CHECK(scene.server.capture() == before);
}

TEST_CASE("two views share the window, each with its own camera")
{
    LittleScene scene;
    scene.look.view->set({.name = "left", .viewport = {.width = 0.5}, .quality = Quality::Low});
    Camera& away = scene.server.add(CameraDef{.name = "away"});
    away.setPose(lookAt({0, 0, 1}, {0, 0, 2})); // sees nothing
    View& right =
        scene.server.add({.name = "right", .viewport = {.left = 0.5, .width = 0.5}, .quality = Quality::Low}, away);
    const Image half = scene.server.capture();
    CHECK(brightnessAt(half, 80, 120) > 40);
    CHECK(brightnessAt(half, 240, 120) <= 2);
    right.setCamera(*scene.look.camera);
    const Image both = scene.server.capture();
    CHECK(brightnessAt(both, 80, 120) > 40);
    CHECK(brightnessAt(both, 240, 120) > 40);
    scene.server.remove(right);
    scene.server.remove(away);
    CHECK(brightnessAt(scene.server.capture(), 240, 120) <= 2);
}

TEST_CASE("exposure and lamps change the brightness")
{
    LittleScene scene;
    const double before = brightness(scene.server.capture());
    CameraDef camera = scene.look.camera->def();
    camera.exposure += 2.0;
    scene.look.camera->set(camera);
    CHECK(brightness(scene.server.capture()) < 0.7 * before);
    camera.exposure -= 2.0;
    scene.look.camera->set(camera);
    scene.server.remove(*scene.look.light);
    CHECK(brightness(scene.server.capture()) < 0.5 * before);
    scene.server.add(LightDef{.kind = PointLight{.intensity = 300}}).setPose({{0, 0.2, 0.2}, {}});
    CHECK(brightness(scene.server.capture()) > 0.5 * before);
    scene.server.add(LightDef{.kind = DirectionalLight{.illuminance = 20000}});
    CHECK(brightness(scene.server.capture()) > before);
}

TEST_CASE("more light at a correspondingly higher exposure value gives the same picture, over all exposures")
{
    LittleScene scene;
    scene.look.light->set(LightDef{.kind = SpotLight{.intensity = 60.0}});
    scene.server.setEnvironment({.intensity = 200.0});
    const Image before = scene.server.capture();
    for (double exposure : {-10.0, -4.0, 5.0, 14.5, 18.0}) {
        const double light = std::exp2(exposure - 11.0);
        CameraDef camera = scene.look.camera->def();
        camera.exposure = exposure;
        scene.look.camera->set(camera);
        scene.look.light->set(LightDef{.kind = SpotLight{.intensity = 60.0 * light}});
        scene.server.setEnvironment({.intensity = 200.0 * light});
        INFO(exposure);
        CHECK(difference(scene.server.capture(), before) <= 2);
    }
}

TEST_CASE("one body casts its shadow on another")
{
    LittleScene scene(Backend::Headless, Quality::Medium);
    geometry::TriangleMesh wall;
    wall.vertices = {{-1, -1, -0.1}, {1, -1, -0.1}, {1, 1, -0.1}, {-1, 1, -0.1}};
    wall.triangles = {{0, 1, 2}, {0, 2, 3}};
    scene.server.add(VisualBodyDef{.name = "wall", .mesh = wall});
    lookFromFront(scene);
    scene.look.light->setPose(lookAt({0.15, 0, 0}, {0, 0, -0.3})); // from the side, so that the camera sees the shadow
    const Image shaded = scene.server.capture();
    LightDef light = scene.look.light->def();
    light.castShadows = false;
    scene.look.light->set(light);
    const Image lit = scene.server.capture();
    CHECK(brightnessAt(lit, 113, 120) > brightnessAt(shaded, 113, 120) + 5); // left of the ball, on the wall
    CHECK(brightnessAt(lit, 250, 120) == brightnessAt(shaded, 250, 120));
}

TEST_CASE("native.h gives access to the library's objects")
{
    LittleScene scene;
    CHECK(native::engine(scene.server) != nullptr);
    CHECK(native::renderer(scene.server) != nullptr);
    CHECK(native::scene(scene.server) != nullptr);
    CHECK(native::view(*scene.look.view) != nullptr);
}

} // namespace headless_test
