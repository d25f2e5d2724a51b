// Every material, light and effect as a picture, compared with a reference (see pictures.h).
#include "little_scene.h"
#include "organs.h"
#include "pictures.h"

#include "filasofia/core/text.h"

namespace pictures_test {

using namespace filasofia;
using namespace filasofia::visual;

namespace {

/// Low contrast around the object in the middle.
const TissueMaterial kGround{.wetness = 0.55, .noiseScale = 85.0, .mottling = 0.5, .vessels = 0.5, .bump = 0.15};

const TissueMaterial kOrgan{.bump = 0.35};
const MucosaMaterial kLining{.noiseScale = 110.0, .pits = 0.3, .bump = 0.55};

/// An operating field: folded tissue, an organ on it, a probe that touches it, and an endoscope's camera and light.
struct Scenery {
    explicit Scenery(const Material& material = kOrgan, geometry::TriangleMesh mesh = organ(0.032, 3))
    {
        server.add(VisualBodyDef{.name = "bed", .mesh = bed(0.34), .material = kGround})
            .setPose({{0, -0.032, -0.03}, {}});
        body = &server.add(
            VisualBodyDef{.name = "organ", .mesh = std::move(mesh), .subdivision = 1, .material = material});
        tool =
            &server.add(VisualBodyDef{.name = "probe", .mesh = probe(), .subdivision = 1, .material = MetalMaterial{}});
        tool->setPose(lookAlong({0.030, 0.022, 0.024}, {0.60, 0.48, 0.28}));
        rig = &server.addTransform("endoscope");
        camera = &server.add(CameraDef{.verticalFieldOfView = 52.0 * kPi / 180.0, .near = 0.01, .focusDistance = 0.10});
        lamp = &server.add(LightDef{.kind = SpotLight{.intensity = 88.0, .innerAngle = 0.35, .outerAngle = 1.0}});
        camera->attachTo(*rig);
        lamp->attachTo(*rig);
        lamp->setPose(lookAt({-0.026, 0.030, 0.0}, {0.0, 0.0, -0.14}));
        rig->setPose(lookAt({-0.012, 0.066, 0.100}, {0.005, -0.008, 0.0}));
        view = &server.add(ViewDef{.effects = effectsOf(Quality::High, 0.010)}, *camera);
        EnvironmentDef environment;
        environment.intensity = 700.0;
        environment.lampDirection = rotate(rig->pose().orientation, Vec3{0.45, 0.8, 0.6});
        server.setEnvironment(environment);
    }

    /// The pose whose +X axis points along `direction`.
    static Pose lookAlong(Vec3 from, Vec3 direction)
    {
        const Pose towards = lookAt(from, from + direction);
        return {from, towards.orientation * axisAngle({0, 1, 0}, kPi / 2)};
    }

    void expose(double exposure)
    {
        CameraDef def = camera->def();
        def.exposure = exposure;
        camera->set(def);
    }

    void set(const Effects& effects)
    {
        ViewDef def = view->def();
        def.effects = effects;
        view->set(def);
    }

    VisualServer server{{.width = 320, .height = 240}};
    VisualBody* body = nullptr;
    VisualBody* tool = nullptr;
    Transform* rig = nullptr;
    Camera* camera = nullptr;
    Light* lamp = nullptr;
    View* view = nullptr;
};

/// The view from inside a hollow organ.
struct Lumen {
    explicit Lumen(const Material& material = kLining, const Effects& effects = effectsOf(Quality::High, 0.006))
    {
        body = &server.add(VisualBodyDef{.name = "colon", .mesh = tubeInside(0.024, 0.30), .material = material});
        camera = &server.add(CameraDef{.verticalFieldOfView = 80.0 * kPi / 180.0, .near = 0.004});
        lamp = &server.add(LightDef{.kind = SpotLight{.intensity = 15.0, .innerAngle = 0.6, .outerAngle = 1.4}});
        lamp->attachTo(*camera);
        lamp->setPose({{-0.006, 0.007, 0.002}, {}});
        camera->setPose(lookAt({0.004, -0.003, 0.0}, {0.012, 0.006, -0.10}));
        view = &server.add(ViewDef{.effects = effects}, *camera);
        EnvironmentDef environment;
        environment.intensity = 350.0;
        server.setEnvironment(environment);
    }

    VisualServer server{{.width = 320, .height = 240}};
    VisualBody* body = nullptr;
    Camera* camera = nullptr;
    Light* lamp = nullptr;
    View* view = nullptr;
};

/// Blood over a wound, a burn beside it, liquid below, on an organ.
std::vector<SurfaceState> marks(std::span<const Vec3> vertices)
{
    std::vector<SurfaceState> states;
    const auto spot = [](Vec3 v, Vec3 at, double size) {
        return std::clamp(1.7 - 1.2 * distance(v, at) / size, 0.0, 1.0);
    };
    for (Vec3 v : vertices)
        states.push_back(
            {.blood = std::max(spot(v, {-0.010, 0.022, 0.022}, 0.014), spot(v, {-0.014, 0.004, 0.032}, 0.009)),
             .burn = spot(v, {0.020, 0.012, 0.026}, 0.0095),
             .wetness = spot(v, {0.0, -0.02, 0.02}, 0.02)});
    return states;
}

} // namespace

TEST_CASE("pictures that differ are found to differ")
{
    Image a{100, 10, std::vector<std::uint8_t>(4000, 100)};
    Image b = a;
    CHECK(differingShare(a, b) == 0.0);
    b.rgba[4] = 102; // within the tolerance
    b.rgba[11] = 0;  // alpha does not count
    CHECK(differingShare(a, b) == 0.0);
    b.rgba[2] = 103;
    b.rgba[400] = 0;
    CHECK(differingShare(a, b) == 0.002);
    b.height = 20;
    CHECK(differingShare(a, b) == 1.0);
}

TEST_CASE("picture: tissue") { checkPicture(Scenery().server.capture(), "tissue"); }
TEST_CASE("picture: mucosa") { checkPicture(Lumen().server.capture(), "mucosa"); }

TEST_CASE("picture: bone")
{
    Scenery scene(BoneMaterial{}, boneEnd());
    scene.server.remove(*scene.tool);
    scene.body->setPose({{-0.024, -0.002, 0.012}, axisAngle({0, 1, 0}, 0.45)});
    checkPicture(scene.server.capture(), "bone");
}

TEST_CASE("picture: metal")
{
    Scenery scene(MetalMaterial{}, probe(0.2, 0.007));
    scene.body->setPose(Scenery::lookAlong({-0.022, 0.002, 0.016}, {0.8, 0.42, 0.10}));
    scene.tool->setPose(Scenery::lookAlong({-0.030, -0.010, 0.046}, {-0.8, 0.30, -0.25}));
    EnvironmentDef environment; // lit tissue all around is reflected in it
    environment.intensity = 1100.0;
    environment.above = {0.85, 0.42, 0.36};
    environment.below = {0.80, 0.22, 0.17};
    environment.lampDirection = rotate(scene.rig->pose().orientation, Vec3{0.45, 0.8, 0.6});
    scene.server.setEnvironment(environment);
    checkPicture(scene.server.capture(), "metal");
}

TEST_CASE("picture: glass")
{
    Scenery scene;
    VisualBody& lens = scene.server.add(VisualBodyDef{
        .name = "lens", .mesh = drop(0.016), .subdivision = 1, .material = GlassMaterial{}, .castShadows = false});
    lens.setPose({{-0.012, 0.022, 0.046}, {}});
    checkPicture(scene.server.capture(), "glass");
}

TEST_CASE("picture: attribute painting on tissue, mucosa and bone")
{
    const std::array<std::pair<const char*, Material>, 3> kinds{
        {{"marks_tissue", TissueMaterial{}}, {"marks_mucosa", MucosaMaterial{}}, {"marks_bone", BoneMaterial{}}}};
    for (const auto& [name, material] : kinds) {
        Scenery scene(material);
        scene.server.remove(*scene.tool);
        const Image clean = scene.server.capture();
        scene.body->setSurfaceState(marks(scene.body->vertices()));
        const Image marked = scene.server.capture();
        CHECK(differingShare(clean, marked) > 0.03);
        checkPicture(marked, name);
    }
}

TEST_CASE("picture: unlit colour and a texture from a file")
{
    Scenery scene;
    Image chart{64, 48, {}}; // a test chart: bars, and a frame that shows where the corners are
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x) {
            const bool frame = x < 2 || y < 2 || x > 61 || y > 45;
            const int bar = x / 8;
            const auto channel = [&](int bit) {
                return std::uint8_t(frame ? 235 : (bar >> bit & 1) ? 200 - 2 * y : 30);
            };
            chart.rgba.insert(chart.rgba.end(), {channel(0), channel(1), channel(2), 255});
        }
    const std::string png = FILASOFIA_BINARY_DIR "/test_chart.png";
    savePng(chart, png);
    VisualBody& chartBody = scene.server.add(VisualBodyDef{
        .name = "chart", .mesh = screen(0.036, 0.027), .material = UnlitMaterial{.texture = TextureFile{png}}});
    chartBody.setPose(Pose{{0.042, 0.022, 0.012}, axisAngle({0, 1, 0}, -0.3) * axisAngle({1, 0, 0}, -0.45)});
    // Landmarks, as a navigation system shows them.
    for (Vec3 at : {Vec3{-0.030, 0.020, 0.020}, Vec3{-0.016, 0.004, 0.034}, Vec3{0.010, 0.002, 0.034}})
        scene.server
            .add(VisualBodyDef{
                .name = "landmark", .mesh = sphere(0.0022, 3), .material = UnlitMaterial{.color = {0.03, 0.55, 0.65}}})
            .setPose({at, {}});
    scene.server.remove(*scene.tool);
    checkPicture(scene.server.capture(), "unlit");
}

/// Writes a picture of `ground` with ink at each (u, v) in [0, 1] for which `inked` is true; (0, 0) is its lower left
/// corner. Returns the file.
template <class Inked>
TextureFile inkFile(const char* name, std::array<int, 3> ground, std::array<int, 3> ink, Inked&& inked)
{
    constexpr int kSize = 512;
    Image image{kSize, kSize, {}};
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            const std::array<int, 3>& c = inked((x + 0.5) / kSize, 1.0 - (y + 0.5) / kSize) ? ink : ground;
            image.rgba.insert(image.rgba.end(), {std::uint8_t(c[0]), std::uint8_t(c[1]), std::uint8_t(c[2]), 255});
        }
    const std::string png = std::string(FILASOFIA_BINARY_DIR "/") + name + ".png";
    savePng(image, png);
    return {png};
}

TEST_CASE("picture: textures on bone, tissue and metal: marker ink and depth rings")
{
    const auto dashes = [](double along) { return std::fmod(along, 1.0) < 0.62; };
    const TextureFile boneInk = inkFile("bone_ink", {226, 206, 172}, {52, 40, 120}, [&](double u, double v) {
        return (std::abs(u - 0.34) < 0.006 || std::abs(u - 0.46) < 0.006) && dashes(30.0 * v);
    });
    const TextureFile tissueInk = inkFile("tissue_ink", {190, 98, 88}, {44, 36, 110}, [&](double u, double v) {
        const double radius = std::hypot(u - 0.5, v - 0.5);
        return (std::abs(radius - 0.30) < 0.014 && dashes(18.0 * (std::atan2(v - 0.5, u - 0.5) / kPi + 1.0))) ||
               (radius < 0.07 && std::min(std::abs(u - v), std::abs(u + v - 1.0)) < 0.014);
    });
    const TextureFile rings = inkFile("rings", {226, 228, 232}, {26, 26, 30},
                                      [](double u, double) { return u > 0.66 && std::fmod(u, 0.08) < 0.04; });

    Scenery scene(BoneMaterial{.baseColorTexture = boneInk}, boneEnd());
    scene.body->setPose({{-0.036, 0.004, 0.000}, axisAngle({0, 1, 0}, 0.25)});
    scene.server
        .add(VisualBodyDef{.name = "flap",
                           .mesh = bed(0.06, 24),
                           .material = TissueMaterial{.wetness = 0.5, .bump = 0.2, .baseColorTexture = tissueInk}})
        .setPose({{0.0, -0.016, 0.050}, axisAngle({1, 0, 0}, 0.45)});
    scene.tool->setMaterial(MetalMaterial{.baseColorTexture = rings});
    scene.expose(11.6);
    scene.tool->setPose(Scenery::lookAlong({0.010, 0.012, 0.048}, {0.75, 0.42, -0.1}));
    checkPicture(scene.server.capture(), "textures");
}

TEST_CASE("picture: a material of the user's own")
{
    const std::string package = FILASOFIA_TEST_MATERIAL;
    Scenery scene(CustomMaterial{package,
                                 {{"color", Color{0.10, 0.42, 0.30}},
                                  {"stripes", 3},
                                  {"width", 0.35},
                                  {"axis", std::array<double, 4>{0.0, 60.0, 0.0, 0.2}},
                                  {"glossy", true}}});
    checkPicture(scene.server.capture(), "custom");
}

TEST_CASE("picture: each light alone")
{
    struct Lit {
        const char* name;
        decltype(LightDef::kind) kind;
    };
    for (const Lit& lit : {Lit{"light_spot", SpotLight{.intensity = 110.0, .innerAngle = 0.10, .outerAngle = 0.42}},
                           Lit{"light_point", PointLight{.intensity = 30.0}},
                           Lit{"light_directional", DirectionalLight{.illuminance = 6000.0}}}) {
        Scenery scene;
        LightDef def = scene.lamp->def();
        def.kind = lit.kind;
        scene.lamp->set(def);
        scene.lamp->detach();
        scene.lamp->setPose(lookAt({-0.07, 0.085, 0.055}, {0.0, 0.0, 0.01}));
        const Image on = scene.server.capture();
        scene.lamp->setVisible(false);
        CHECK(differingShare(on, scene.server.capture()) > 0.2);
        checkPicture(on, lit.name);
    }
}

TEST_CASE("picture: the surroundings alone")
{
    Scenery scene;
    scene.lamp->setVisible(false);
    EnvironmentDef environment;
    environment.intensity = 1200.0;
    environment.lampDirection = {-0.4, 0.9, 0.4};
    scene.server.setEnvironment(environment);
    checkPicture(scene.server.capture(), "light_surroundings");
}

TEST_CASE("picture: each effect is seen, and off it leaves the picture as it was")
{
    const Effects plain = {.shadows = false, .antialiasing = Antialiasing::None};
    struct Case {
        const char* name;
        double least; ///< fraction of the pixels that it changes
        Effects effects;
    };
    const auto with = [&](auto&& change) {
        Effects effects = plain;
        change(effects);
        return effects;
    };
    Scenery scene;
    CameraDef camera = scene.camera->def();
    camera.exposure = 12.0;
    camera.aperture = 4.0;
    camera.focusDistance = 0.105;
    scene.camera->set(camera);
    scene.set(plain);
    const Image off = scene.server.capture();
    checkPicture(off, "effects_off");
    for (const Case& each : {
             Case{"effect_shadows", 0.02, with([](Effects& e) { e.shadows = true; })},
             Case{"effect_ambient_occlusion", 0.10,
                  with([](Effects& e) { e.ambientOcclusion = AmbientOcclusion{.radius = 0.012, .strength = 1.5}; })},
             Case{"effect_bloom", 0.10,
                  with([](Effects& e) { e.bloom = Bloom{.strength = 0.35, .onlyHighlights = false}; })},
             Case{"effect_depth_of_field", 0.10, with([](Effects& e) { e.depthOfField = DepthOfField{}; })},
             Case{"effect_vignette", 0.20, with([](Effects& e) { e.vignette = Vignette{}; })},
             Case{"effect_fog", 0.50,
                  with([](Effects& e) { e.fog = Fog{.density = 7.0, .start = 0.06, .brightness = 0.5}; })},
             Case{"effect_fxaa", 0.005, with([](Effects& e) { e.antialiasing = Antialiasing::Fxaa; })},
             Case{"effect_msaa", 0.005, with([](Effects& e) { e.antialiasing = Antialiasing::Msaa; })},
         }) {
        INFO(each.name);
        scene.set(each.effects);
        const Image on = scene.server.capture();
        CHECK(differingShare(on, off) > each.least);
        checkPicture(on, each.name);
        scene.set(plain);
        CHECK(differingShare(scene.server.capture(), off) == 0.0);
    }
}

TEST_CASE("picture: temporal antialiasing after eight frames")
{
    Scenery scene;
    scene.expose(12.0);
    Effects effects = {.shadows = false, .antialiasing = Antialiasing::None};
    scene.set(effects);
    const Image off = scene.server.capture();
    effects.antialiasing = Antialiasing::Taa;
    scene.set(effects);
    for (int i = 0; i < 8; ++i) scene.server.render();
    const Image on = scene.server.capture();
    CHECK(differingShare(on, off) > 0.01);
    checkPicture(on, "effect_taa");
}

TEST_CASE("picture: endoscope optics, and nothing from outside the picture inside the mask")
{
    Effects effects = effectsOf(Quality::High, 0.006);
    effects.vignette.reset();
    Lumen scene(kLining, effects);
    CameraDef camera = scene.camera->def();
    camera.exposure = 10.3;
    scene.camera->set(camera);
    const Image plain = scene.server.capture();
    effects.endoscope = EndoscopeOptics{};
    ViewDef def = scene.view->def();
    def.effects = effects;
    scene.view->set(def);
    const Image round = scene.server.capture();
    CHECK(differingShare(round, plain) > 0.5);
    checkPicture(round, "endoscope");
}

TEST_CASE("picture: two viewports, the second with endoscope optics of its own")
{
    Scenery scene;
    ViewDef left = scene.view->def();
    left.viewport = {.width = 0.55};
    scene.view->set(left);
    Camera& close = scene.server.add(CameraDef{.name = "close", .near = 0.005});
    close.setPose(lookAt({0.064, 0.052, 0.070}, {0.012, 0.012, 0.010}));
    Effects effects = effectsOf(Quality::Medium);
    effects.endoscope = EndoscopeOptics{};
    scene.server.add({.name = "right", .viewport = {.left = 0.55, .width = 0.45}, .effects = effects}, close);
    checkPicture(scene.server.capture(), "two_viewports");
}

TEST_CASE("picture: picture-in-picture, in the window and on a screen in the scene")
{
    Scenery scene;
    Camera& above = scene.server.add(CameraDef{.name = "above", .near = 0.005});
    above.setPose(lookAt({0.0, 0.11, 0.02}, {0.0, 0.0, 0.0}, {0, 0, -1}));
    Effects noVignette = effectsOf(Quality::Medium);
    noVignette.vignette.reset();
    scene.server.add({.name = "monitor", .effects = noVignette, .target = OffScreen{160, 120}}, above);
    VisualBody& monitor = scene.server.add(VisualBodyDef{
        .name = "monitor", .mesh = screen(0.048, 0.036), .material = UnlitMaterial{.texture = ViewPicture{"monitor"}}});
    scene.body->setPose({{0.012, 0.0, 0.0}, {}});
    scene.expose(12.2);
    VisualBody& bezel = scene.server.add(VisualBodyDef{
        .name = "bezel", .mesh = screen(0.051, 0.039), .material = UnlitMaterial{.color = {0.015, 0.016, 0.018}}});
    bezel.attachTo(monitor);
    bezel.setPose({{0, 0, -0.0006}, {}});
    monitor.setPose(Pose{{-0.036, 0.012, 0.026}, axisAngle({0, 1, 0}, 0.30) * axisAngle({1, 0, 0}, -0.35)});
    scene.server.add({.name = "corner", .viewport = {0.72, 0.66, 0.26, 0.30}, .effects = noVignette}, above);
    checkPicture(scene.server.capture(), "picture_in_picture");
}

TEST_CASE("picture: subdivision 0, 1 and 2")
{
    for (int level = 0; level <= 2; ++level) {
        Scenery scene;
        scene.server.remove(*scene.body);
        scene.server.add(VisualBodyDef{.name = "organ", .mesh = organ(0.032, 2), .subdivision = level});
        checkPicture(scene.server.capture(), text("subdivision_", level));
    }
}

} // namespace pictures_test
