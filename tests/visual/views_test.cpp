// Effects, off-screen views, scale and visibility, and long runs: what works and what is an Error.
#include "little_scene.h"
#include "organs.h"

#include "filasofia/core/error.h"
#include "filasofia/visual/null_backend.h"
#include "filasofia/visual/scene.h"

#include "skip.h"

namespace views_test {

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

const NullBackend& backendOf(VisualBody& body) { return dynamic_cast<const NullBackend&>(*body.impl().scene.backend); }

VisualBodyDef monitorDef(const std::string& view)
{
    return {.name = "monitor", .mesh = screen(0.1, 0.1), .material = UnlitMaterial{.texture = ViewPicture{view}}};
}

} // namespace

TEST_CASE("a preset's effects are those that its view gets")
{
    CHECK(effectsOf(Quality::Low) == Effects{.shadows = false, .antialiasing = Antialiasing::None});
    CHECK(effectsOf(Quality::Medium).vignette.has_value());
    CHECK_FALSE(effectsOf(Quality::Medium).bloom.has_value());
    CHECK(effectsOf(Quality::High, 0.02).ambientOcclusion == AmbientOcclusion{.radius = 0.02});
}

TEST_CASE("a preset's picture is that of its effects, given one by one")
{
    if (skipIf(!hasBackend(Backend::Headless), "this build draws nothing")) return;
    for (Quality quality : {Quality::Low, Quality::Medium, Quality::High}) {
        LittleScene scene(Backend::Headless, quality);
        const Image preset = scene.server.capture();
        ViewDef def = scene.look.view->def();
        def.effects = effectsOf(quality, def.occlusionRadius);
        def.quality = Quality::Low;
        scene.look.view->set(def);
        CHECK(scene.server.capture() == preset);
    }
}

TEST_CASE("wrong effects are errors that name the view and the field")
{
    for (Backend backend : backends()) {
        LittleScene scene(backend);
        const auto refused = [&](const char* what, auto&& change) {
            ViewDef def = scene.look.view->def();
            def.effects.emplace();
            change(*def.effects);
            CHECK_THROWS_WITH(scene.look.view->set(def), Contains("endoscope view") && Contains(what));
        };
        refused("ambientOcclusion.radius", [](Effects& e) { e.ambientOcclusion = AmbientOcclusion{.radius = 0.0}; });
        refused("bloom.strength", [](Effects& e) { e.bloom = Bloom{.strength = 2.0}; });
        refused("depthOfField.strength", [](Effects& e) { e.depthOfField = DepthOfField{.strength = kNan}; });
        refused("vignette.feather", [](Effects& e) { e.vignette = Vignette{.feather = -1.0}; });
        refused("fog.density", [](Effects& e) { e.fog = Fog{.density = 0.0}; });
        refused("fog.color.red", [](Effects& e) { e.fog = Fog{.color = {kNan, 0, 0}}; });
        refused("endoscope.maskRadius", [](Effects& e) { e.endoscope = EndoscopeOptics{.maskRadius = 0.0}; });
        refused("endoscope.distortion", [](Effects& e) { e.endoscope = EndoscopeOptics{.distortion = 1.5}; });
        refused("endoscope.rimBlur", [](Effects& e) { e.endoscope = EndoscopeOptics{.rimBlur = kNan}; });
        CHECK_THROWS_WITH(scene.server.add(CameraDef{.name = "eye", .focusDistance = 0.0}), Contains("focusDistance"));
        CHECK_THROWS_WITH(scene.server.add(CameraDef{.name = "eye", .aperture = kNan}), Contains("aperture"));
        CHECK_FALSE(scene.look.view->def().effects.has_value());
        CHECK(scene.server.render());
    }
}

TEST_CASE("an off-screen view has a picture of its own size, which follows a change of size")
{
    for (Backend backend : backends()) {
        LittleScene scene(backend);
        View& view = scene.server.add(ViewDef{.name = "side", .quality = Quality::Low, .target = OffScreen{200, 100}},
                                      *scene.look.camera);
        const Image picture = view.capture();
        CHECK(picture.width == 200);
        CHECK(picture.height == 100);
        if (backend == Backend::Headless) {
            CHECK(brightnessAt(picture, 100, 50) > 40);
            CHECK(brightnessAt(picture, 1, 1) <= 2);
            CHECK(view.capture() == picture);
        }
        const Image window = scene.server.capture();
        ViewDef def = view.def();
        def.target = OffScreen{64, 64};
        view.set(def);
        CHECK(view.capture().width == 64);
        CHECK(scene.server.capture() == window); // the window is not affected
        def.target = InWindow{};
        view.set(def);
        CHECK_THROWS_WITH(view.capture(), Contains("side") && Contains("window"));
        def.target = OffScreen{200, 100};
        view.set(def);
        CHECK(view.capture() == picture);
    }
}

TEST_CASE("an off-screen view shows the same as the window does")
{
    if (skipIf(!hasBackend(Backend::Headless), "this build draws nothing")) return;
    for (const bool lens : {false, true}) {
        LittleScene scene;
        lookFromFront(scene);
        scene.body.setPose({{0.02, 0.03, 0.0}, {}});
        ViewDef def = scene.look.view->def();
        def.effects = effectsOf(Quality::High, 0.01);
        if (lens) def.effects->endoscope = EndoscopeOptics{};
        scene.look.view->set(def);
        const Image window = scene.server.capture();
        def.name = "other";
        def.target = OffScreen{320, 240};
        View& view = scene.server.add(def, *scene.look.camera);
        CHECK(difference(view.capture(), window) <= 1);
    }
}

TEST_CASE("endoscope optics: black outside the mask, whatever its shape, the first frame already")
{
    if (skipIf(!hasBackend(Backend::Headless), "this build draws nothing")) return;
    LittleScene scene;
    EnvironmentDef white; // everything in the picture is white
    white.background = {1, 1, 1};
    scene.server.setEnvironment(white);
    scene.server.remove(scene.body);
    ViewDef def = scene.look.view->def();
    for (const EndoscopeOptics& optics :
         {EndoscopeOptics{.maskRadius = 0.9, .maskSoftness = 0, .vignette = 0},
          EndoscopeOptics{.maskRadius = 1.2, .maskSoftness = 0.1, .distortion = 1.0, .vignette = 0, .rimBlur = 0.05},
          EndoscopeOptics{.maskRadius = 0.5, .maskSoftness = 0, .distortion = 0, .vignette = 0, .rimBlur = 0}}) {
        def.effects = Effects{};
        def.effects->endoscope = optics;
        scene.look.view->set(def);
        const Image image = scene.server.capture();
        const int inside = brightnessAt(image, 160, 120);
        CHECK(inside > 200);
        int wrong = 0;
        for (int y = 0; y < 240; ++y)
            for (int x = 0; x < 320; ++x) {
                const double r = std::hypot(x + 0.5 - 160, y + 0.5 - 120) / 120.0;
                if (r > optics.maskRadius + 0.01) wrong += brightnessAt(image, x, y) > 1;
                // A value from outside the picture would be darker here.
                if (r < optics.maskRadius - optics.maskSoftness - 0.02) wrong += brightnessAt(image, x, y) < inside - 1;
            }
        CHECK(wrong == 0);
    }
}

TEST_CASE(
    "endoscope optics: a clean lens changes nothing, fog takes contrast, and a smear covers its share in its colour")
{
    if (skipIf(!hasBackend(Backend::Headless), "this build draws nothing")) return;
    LittleScene scene;
    ViewDef def = scene.look.view->def();
    const auto picture = [&](double mist, double smear) {
        def.effects = Effects{};
        def.effects->endoscope = EndoscopeOptics{.maskRadius = 2.0,
                                                 .maskSoftness = 0,
                                                 .distortion = 0,
                                                 .vignette = 0,
                                                 .rimBlur = 0,
                                                 .mist = mist,
                                                 .smear = smear,
                                                 .smearColor = {0.5, 0, 0}};
        scene.look.view->set(def);
        return scene.server.capture();
    };
    const auto contrast = [](const Image& image) {
        double sum = 0.0, squares = 0.0;
        for (int y = 0; y < 240; ++y)
            for (int x = 0; x < 320; ++x) {
                const double bright = brightnessAt(image, x, y);
                sum += bright;
                squares += bright * bright;
            }
        const double mean = sum / (320 * 240);
        return std::sqrt(squares / (320 * 240) - mean * mean);
    };
    const Image clean = picture(0.0, 0.0);
    CHECK(contrast(picture(0.3, 0.0)) < 0.9 * contrast(clean));
    CHECK(contrast(picture(1.0, 0.0)) < 0.4 * contrast(clean));
    // Where something lies on the lens, green is gone; the more, the larger the share.
    const auto covered = [&](double smear) {
        const Image image = picture(0.0, smear);
        int dark = 0, all = 0;
        for (std::size_t i = 0; i + 3 < clean.rgba.size(); i += 4) {
            if (clean.rgba[i + 1] < 40) continue;
            ++all;
            dark += image.rgba[i + 1] < clean.rgba[i + 1] / 2 ? 1 : 0;
        }
        return static_cast<double>(dark) / all;
    };
    CHECK(covered(0.0) == 0.0);
    const double some = covered(0.4), more = covered(0.7);
    CHECK(some > 0.02);
    CHECK(more > some + 0.1);
    CHECK(covered(1.0) > 0.9);
}

TEST_CASE("an unlit material shows the colour asked for, in spite of the tone mapping")
{
    if (skipIf(!hasBackend(Backend::Headless), "this build draws nothing")) return;
    VisualServer server({.width = 16, .height = 16});
    Camera& camera = server.add(CameraDef{});
    camera.setPose({{0, 0, 0.05}, {}});
    server.add(ViewDef{.quality = Quality::Low}, camera);
    VisualBody& body = server.add({.name = "plate", .mesh = screen(1, 1), .material = UnlitMaterial{}});
    const auto encoded = [](double linear) {
        return 255.0 * (linear < 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055);
    };
    const auto error = [&](const Color& color) {
        body.setMaterial(UnlitMaterial{.color = color});
        const auto shown = server.capture().pixel(8, 8);
        return std::max({std::abs(shown[0] - encoded(color.red)), std::abs(shown[1] - encoded(color.green)),
                         std::abs(shown[2] - encoded(color.blue))});
    };
    for (double grey : {0.01, 0.03, 0.1, 0.2, 0.4, 0.6, 0.8, 0.9}) CHECK(error({grey, grey, grey}) <= 2.0);
    CHECK(error({1, 1, 1}) <= 10.0);
    for (const Color& color : {Color{0.5, 0.2, 0.1}, Color{0.05, 0.6, 0.1}, Color{0.1, 0.2, 0.8}})
        CHECK(error(color) <= 8.0);
    CHECK(error({0.8, 0.05, 0.05}) <= 12.0);
    // Beyond what the tone mapping can show: less bright, but not bleached. Green was shown as (237, 247, 212).
    for (int corner = 1; corner < 7; ++corner) {
        const std::array<double, 3> asked{double(corner & 1), double(corner >> 1 & 1), double(corner >> 2 & 1)};
        body.setMaterial(UnlitMaterial{.color = {asked[0], asked[1], asked[2]}});
        const auto shown = server.capture().pixel(8, 8);
        for (std::size_t i = 0; i < 3; ++i) CHECK((asked[i] > 0.0 ? shown[i] >= 165 : shown[i] <= 125));
    }
}

TEST_CASE("wrong off-screen views are errors")
{
    for (Backend backend : backends()) {
        LittleScene scene(backend);
        Camera& camera = *scene.look.camera;
        CHECK_THROWS_WITH(scene.server.add(ViewDef{.name = "a", .target = OffScreen{0, 10}}, camera),
                          Contains("target.width"));
        CHECK_THROWS_WITH(scene.server.add(ViewDef{.name = "a", .target = OffScreen{10, -1}}, camera),
                          Contains("height"));
        CHECK_THROWS_WITH(scene.server.add(ViewDef{.name = "a", .target = OffScreen{10, 9000}}, camera),
                          Contains("8192"));
        CHECK_THROWS_WITH(
            scene.server.add(ViewDef{.name = "a", .viewport = {.width = 0.5}, .target = OffScreen{}}, camera),
            Contains("viewport"));
        CHECK_THROWS_WITH(scene.look.view->capture(), Contains("endoscope view"));
        CHECK_THROWS_WITH(scene.server.add(monitorDef("a")), Contains("monitor") && Contains("'a'"));
        View& view = scene.server.add(ViewDef{.name = "a", .target = OffScreen{8, 8}}, camera);
        CHECK_THROWS_WITH(scene.server.add(ViewDef{.name = "a", .target = OffScreen{}}, camera),
                          Contains("name already"));
        CHECK_NOTHROW(view.set(view.def()));
        CHECK(scene.server.statistics().views == 2);
        CHECK(scene.server.render());
    }
}

TEST_CASE("a body that shows a removed, resized or renamed view lives on")
{
    for (Backend backend : backends()) {
        LittleScene scene(backend);
        Camera& front = scene.server.add(CameraDef{.name = "front"});
        front.setPose({{1, 0, 0.06}, {}});
        View* view = &scene.server.add(ViewDef{.name = "a", .quality = Quality::Low, .target = OffScreen{64, 64}},
                                       *scene.look.camera);
        scene.server.add(monitorDef("a")).setPose({{1, 0, 0}, {}});
        scene.look.view->setCamera(front);
        const Image shown = scene.server.capture();
        scene.server.remove(*view);
        CHECK(scene.server.render());
        const Image gone = scene.server.capture();
        view = &scene.server.add(ViewDef{.name = "a", .quality = Quality::Low, .target = OffScreen{64, 64}},
                                 *scene.look.camera);
        CHECK(scene.server.capture() == shown);
        ViewDef def = view->def();
        def.target = OffScreen{16, 16};
        view->set(def);
        const Image coarse = scene.server.capture();
        def.name = std::string("b"); // GCC 12 gives a false warning for the plain letter
        view->set(def);
        const Image renamed = scene.server.capture();
        if (backend == Backend::Headless) {
            CHECK(brightness(shown) > 3.0);
            CHECK(brightness(gone) == 0.0);
            CHECK(brightness(coarse) == Approx(brightness(shown)).epsilon(0.1));
            CHECK(coarse != shown);
            CHECK(brightness(renamed) == 0.0);
        }
    }
}

TEST_CASE("a view that shows itself on a screen is drawn")
{
    for (Backend backend : backends()) {
        LittleScene scene(backend);
        View& view = scene.server.add(ViewDef{.name = "self", .target = OffScreen{64, 64}}, *scene.look.camera);
        VisualBody& monitor = scene.server.add(monitorDef("self"));
        monitor.setPose(scene.look.camera->worldPose());
        for (int i = 0; i < 3; ++i) CHECK(scene.server.render());
        CHECK(view.capture().width == 64);
    }
}

TEST_CASE("a hidden view is not drawn, a hidden light does not shine")
{
    if (skipIf(!hasBackend(Backend::Headless), "this build draws nothing")) return;
    LittleScene scene;
    const Image before = scene.server.capture();
    scene.look.view->setVisible(false);
    CHECK_FALSE(scene.look.view->visible());
    CHECK(brightness(scene.server.capture()) == 0.0);
    scene.look.view->setVisible(true);
    scene.look.light->setVisible(false);
    CHECK(brightness(scene.server.capture()) < 0.5 * brightness(before));
    scene.look.light->setVisible(true);
    CHECK(scene.server.capture() == before);
}

TEST_CASE("children of a hidden transform are hidden, and come back with it")
{
    LittleScene scene(Backend::Null);
    Transform& rig = scene.server.addTransform("rig");
    Transform& arm = scene.server.addTransform("arm");
    arm.attachTo(rig);
    scene.body.attachTo(arm);
    const auto& kept = backendOf(scene.body).bodies.at(scene.body.impl().slot);
    rig.setVisible(false);
    scene.server.render();
    CHECK_FALSE(kept.visible);
    CHECK(scene.body.visible());
    CHECK_FALSE(scene.body.worldVisible());
    rig.setVisible(true);
    scene.server.render();
    CHECK(kept.visible);
}

TEST_CASE("a scale enlarges a body and its children, in size and in distance")
{
    LittleScene scene(Backend::Null);
    Transform& rig = scene.server.addTransform("rig");
    rig.setPose({{1, 0, 0}, axisAngle({0, 0, 1}, std::acos(0.0))});
    rig.setScale(2.0);
    scene.body.attachTo(rig);
    scene.body.setPose({{0.5, 0, 0}, {}});
    scene.body.setScale(3.0);
    CHECK(scene.body.worldScale() == 6.0);
    CHECK(distance(scene.body.worldPose().position, {1, 1, 0}) < 1e-12);
    scene.server.render();
    const auto& kept = backendOf(scene.body).bodies.at(scene.body.impl().slot);
    CHECK(kept.scale == 6.0);
    scene.body.detach();
    CHECK(scene.body.scale() == 6.0);
    CHECK(distance(scene.body.pose().position, {1, 1, 0}) < 1e-12);
    for (double wrong : {0.0, -1.0, 2e6, kNan, std::numeric_limits<double>::infinity()})
        CHECK_THROWS_WITH(scene.body.setScale(wrong), Contains("ball") && Contains("scale"));
    CHECK(scene.body.scale() == 6.0);
}

TEST_CASE("a body of half the size at twice the scale looks the same")
{
    if (skipIf(!hasBackend(Backend::Headless), "this build draws nothing")) return;
    LittleScene scene;
    scene.body.setMaterial(MetalMaterial{}); // tissue's pattern follows the mesh at rest
    const Image before = scene.server.capture();
    scene.server.remove(scene.body);
    VisualBodyDef def = sphereDef(0.025);
    def.material = MetalMaterial{};
    scene.server.add(def).setScale(2.0);
    CHECK(difference(scene.server.capture(), before) <= 1);
}

TEST_CASE("fifty servers one after another, with effects and textures, and one with a thousand bodies work")
{
    for (Backend backend : backends()) {
        for (int i = 0; i < 50; ++i) {
            VisualServer server({.backend = backend, .width = 16, .height = 16});
            server.add(sphereDef(0.05, 0));
            Camera& camera = server.add(CameraDef{});
            Effects effects = effectsOf(Quality::Low);
            effects.endoscope = EndoscopeOptics{};
            server.add(ViewDef{.effects = effects}, camera);
            server.add(ViewDef{.name = "off", .quality = Quality::Low, .target = OffScreen{8, 8}}, camera);
            server.add(monitorDef("off"));
            server.render();
        }
        LittleScene scene(backend);
        const Image before = scene.server.capture();
        for (int round = 0; round < 2; ++round) {
            std::vector<VisualBody*> bodies;
            for (int i = 0; i < 1000; ++i) {
                VisualBodyDef def = sphereDef(0.01, 0);
                if (i % 3 == 1) def.material = MetalMaterial{};
                if (i % 3 == 2) def.material = BoneMaterial{};
                bodies.push_back(&scene.server.add(def));
                bodies.back()->setPose({{0.02 * (i % 10), 0.02 * (i / 10 % 10), -0.02 * (i / 100)}, {}});
            }
            CHECK(scene.server.render());
            for (VisualBody* body : bodies) scene.server.remove(*body);
        }
        CHECK(scene.server.statistics().bodies == 1);
        CHECK(scene.server.capture() == before);
    }
}

TEST_CASE("one body too many is an error, and the server draws on")
{
    for (Backend backend : backends()) {
        LittleScene scene(backend);
        for (std::size_t i = 1; i < kMaxBodies; ++i) scene.server.add(sphereDef(0.01, 0));
        CHECK_THROWS_WITH(scene.server.add(sphereDef()), Contains("ball") && Contains("1400"));
        CHECK(scene.server.render());
    }
}

TEST_CASE("a body whose mesh, material or view changes very often does not exhaust the library's handles")
{
    for (Backend backend : backends()) {
        LittleScene scene(backend);
        for (int i = 0; i < 3000; ++i)
            scene.body.setMaterial(i % 2 ? Material(MetalMaterial{}) : Material(TissueMaterial{}));
        for (int i = 0; i < 1000; ++i) {
            ViewDef def = scene.look.view->def();
            def.effects.emplace();
            if (i % 2) def.effects->endoscope = EndoscopeOptics{};
            scene.look.view->set(def);
        }
        const geometry::TriangleMesh mesh = sphere(0.05, 0);
        for (int i = 0; i < 3000; ++i) scene.body.setMesh(mesh, mesh.vertices);
        CHECK(scene.server.render());
    }
}

} // namespace views_test
