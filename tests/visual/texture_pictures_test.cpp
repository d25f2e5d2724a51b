// What normal, roughness and occlusion textures do to a picture.
#include "little_scene.h"
#include "organs.h"
#include "pictures.h"
#include "relief_maps.h"

namespace texture_pictures_test {

using namespace filasofia;
using namespace filasofia::visual;

namespace {

/// A flat screen that faces the camera, lit from the side at 45 degrees: the brightness of its middle.
double lit(const Material& material, Vec3 lampFrom, bool mirrored = false)
{
    VisualServer server({.width = 96, .height = 72});
    server.setEnvironment({.intensity = 0.0});
    geometry::TriangleMesh mesh = screen(0.1, 0.1);
    if (mirrored)
        for (auto& uv : mesh.uv) uv[0] = 1.0 - uv[0];
    server.add(VisualBodyDef{.name = "screen", .mesh = mesh, .material = material});
    Camera& camera = server.add(CameraDef{.near = 0.01});
    camera.setPose(lookAt({0, 0, 0.1}, {0, 0, 0}));
    server.add(LightDef{.kind = DirectionalLight{.illuminance = 2000.0}}).setPose(lookAt(lampFrom, {0, 0, 0}));
    Effects plain = effectsOf(Quality::Low);
    server.add(ViewDef{.effects = plain}, camera);
    return brightnessAt(server.capture(), 48, 36);
}

const TissueMaterial kPlain{.roughness = 1.0, .wetness = 0.0, .mottling = 0.0, .vessels = 0.0, .bump = 0.0};

Material withNormals(const TextureMap& map, double strength = 1.0)
{
    TissueMaterial made = kPlain;
    made.normalTexture = map;
    made.normalStrength = strength;
    return made;
}

TextureFile level() { return leaningFile("level", 0.0, 0.0); }

} // namespace

TEST_CASE("a normal map leans the surface towards growing u and v, on mirrored uv as well")
{
    const Vec3 right{1, 0, 1}, above{0, 1, 1};
    const Material toU = withNormals(leaningFile("to_u", 0.5, 0.0)), toV = withNormals(leaningFile("to_v", 0.0, 0.5));
    const Material fromU = withNormals(leaningFile("from_u", -0.5, 0.0));
    const Material fromV = withNormals(leaningFile("from_v", 0.0, -0.5));
    const double flat = lit(kPlain, right);
    CHECK(flat > 20);
    CHECK(std::abs(lit(withNormals(level()), right) - flat) <= 1);
    CHECK(std::abs(lit(withNormals(leaningFile("to_u", 0.5, 0.0), 0.0), right) - flat) <= 1);
    CHECK(lit(toU, right) > flat + 5);
    CHECK(lit(fromU, right) < flat - 5);
    CHECK(lit(toV, above) > flat + 5);
    CHECK(lit(fromV, above) < flat - 5);
    CHECK(std::abs(lit(toV, right) - lit(fromV, right)) <= 2);
    CHECK(lit(toU, right, true) < flat - 5);
    CHECK(lit(fromU, right, true) > flat + 5);
    CHECK(lit(toV, above, true) > flat + 5);
    CHECK(lit(withNormals(leaningFile("to_u", 0.5, 0.0), 2.0), right) > lit(toU, right));
}

TEST_CASE("roughness and occlusion textures change the picture, and only through their own channel")
{
    const auto plain = [](const char* name, double r, double g, double b) {
        return pictureFile(name, 4, [&](double, double) { return std::array{r, g, b}; });
    };
    LittleScene scene;
    scene.server.remove(scene.body);
    VisualBody& body = scene.server.add(VisualBodyDef{.name = "bone", .mesh = boneEnd(0.1, 0.02)});
    const auto shown = [&](const Material& material) {
        body.setMaterial(material);
        return scene.server.capture();
    };
    const BoneMaterial base{.roughness = 0.2, .wetness = 0.0, .bump = 0.0};
    const Image smooth = shown(base);
    const auto with = [&](auto change) {
        BoneMaterial made = base;
        change(made);
        return shown(made);
    };
    const TextureFile rough = plain("rough", 0.1, 0.9, 0.2), same = plain("same", 0.9, 0.2, 0.7);
    CHECK(difference(smooth, with([&](BoneMaterial& m) { m.roughnessTexture = rough; })) > 10);
    CHECK(difference(smooth, with([&](BoneMaterial& m) { m.roughnessTexture = same; })) <= 2);
    const TextureFile closed = plain("closed", 0.1, 0.9, 0.9), open = plain("open", 1.0, 0.0, 0.0);
    CHECK(brightness(with([&](BoneMaterial& m) { m.occlusionTexture = closed; })) < brightness(smooth) - 1.0);
    CHECK(difference(smooth, with([&](BoneMaterial& m) { m.occlusionTexture = open; })) == 0);
    CHECK(difference(smooth, with([&](BoneMaterial& m) {
                         m.occlusionTexture = closed;
                         m.occlusionStrength = 0.0;
                     })) == 0);
}

namespace {

/// Two pictures of the same height, side by side.
Image beside(const Image& left, const Image& right)
{
    Image both{left.width + right.width, left.height, {}};
    for (int y = 0; y < both.height; ++y)
        for (const Image* each : {&left, &right}) {
            const std::size_t row = 4 * std::size_t(each->width) * std::size_t(y);
            both.rgba.insert(both.rgba.end(), each->rgba.begin() + std::ptrdiff_t(row),
                             each->rgba.begin() + std::ptrdiff_t(row + 4 * std::size_t(each->width)));
        }
    return both;
}

/// The inside of a stomach: folds, and on them the small mounds of its glands (areae gastricae, 2 to 4 mm), as maps.
ReliefMaps stomachMaps()
{
    static const Mounds mounds(13, 7), grains(41, 3);
    return reliefMaps("stomach", 512, 0.03, 0.45, 0.25, [](double u, double v) {
        // Bent, so that no rows show.
        const double a = u + 0.020 * std::sin(2 * kPi * (2 * v + 0.1)) + 0.008 * std::sin(2 * kPi * (5 * v + 3 * u));
        const double b = v + 0.018 * std::sin(2 * kPi * (3 * u + 0.4)) + 0.008 * std::sin(2 * kPi * (4 * u - 5 * v));
        return 0.020 * mounds.height(a, b) + 0.0016 * grains.height(a, b);
    });
}

/// The view from inside a hollow organ whose uv repeat every 40 mm or so.
Image insideStomach(const Material& material, int width, int height)
{
    VisualServer server({.width = width, .height = height});
    geometry::TriangleMesh mesh = tubeInside(0.026, 0.30);
    for (auto& uv : mesh.uv) uv = {4.0 * uv[0], 7.0 * uv[1]};
    server.add(VisualBodyDef{.name = "stomach", .mesh = std::move(mesh), .material = material});
    Camera& camera = server.add(CameraDef{.verticalFieldOfView = 80.0 * kPi / 180.0, .near = 0.004});
    camera.setPose(lookAt({0.004, -0.003, 0.0}, {0.012, 0.006, -0.10}));
    Light& lamp = server.add(LightDef{.kind = SpotLight{.intensity = 15.0, .innerAngle = 0.6, .outerAngle = 1.4}});
    lamp.attachTo(camera);
    lamp.setPose({{-0.006, 0.007, 0.002}, {}});
    server.add(ViewDef{.effects = effectsOf(Quality::High, 0.006)}, camera);
    server.setEnvironment({.intensity = 350.0});
    return server.capture();
}

} // namespace

TEST_CASE("picture: mucosa without and with normal, roughness and occlusion textures")
{
    const ReliefMaps maps = stomachMaps();
    const MucosaMaterial plain{.wetness = 0.45, .noiseScale = 110.0, .pits = 0.0, .bump = 0.35};
    MucosaMaterial mapped = plain;
    mapped.normalTexture = maps.normal;
    mapped.roughnessTexture = mapped.occlusionTexture = maps.occlusionRoughness;
    checkPicture(beside(insideStomach(plain, 320, 240), insideStomach(mapped, 320, 240)), "texture_maps");
}

} // namespace texture_pictures_test
