// Normal, roughness and occlusion textures: the frames that they need, and what is an Error.
#include "little_scene.h"
#include "organs.h"
#include "relief_maps.h"

#include "filasofia/core/error.h"
#include "filasofia/visual/null_backend.h"
#include "filasofia/visual/scene.h"

#include <fstream>

namespace texture_maps_test {

using namespace filasofia;
using namespace filasofia::visual;
using Catch::Contains;

namespace {

struct Axes {
    Vec3 tangent, bitangent, normal;
};

/// A packed frame as the shader reads it.
Axes axesOf(PackedFrame f)
{
    const double x = f.x / 32767.0, y = f.y / 32767.0, z = f.z / 32767.0, w = f.w / 32767.0;
    const Vec3 n{2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)};
    const Vec3 t{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)};
    return {t, (f.w < 0 ? -1.0 : 1.0) * cross(n, t), n};
}

const NullBackend::Body& kept(VisualBody& body)
{
    return dynamic_cast<const NullBackend&>(*body.impl().scene.backend).bodies.at(body.impl().slot);
}

/// A folded bed, whose uv run along x and -z.
VisualBodyDef bedDef(const Material& material, int subdivision = 0)
{
    return {.name = "bed", .mesh = bed(0.1, 12), .subdivision = subdivision, .material = material};
}

TextureFile level() { return leaningFile("level", 0.0, 0.0); }

const TissueMaterial kPlain{.roughness = 1.0, .wetness = 0.0, .mottling = 0.0, .vessels = 0.0, .bump = 0.0};

Material withNormals(const TextureMap& map, double strength = 1.0)
{
    TissueMaterial made = kPlain;
    made.normalTexture = map;
    made.normalStrength = strength;
    return made;
}

} // namespace

TEST_CASE("a packed frame gives tangent, bitangent and normal back, mirrored or not")
{
    std::mt19937 random(3);
    std::normal_distribution<double> number;
    for (int i = 0; i < 10000; ++i) {
        const Vec3 n = normalized(Vec3{number(random), number(random), number(random)});
        const Vec3 t = normalized(cross(n, Vec3{number(random), number(random), number(random)}));
        const Vec3 b = (i % 2 == 0 ? 1.0 : -1.0) * cross(n, t);
        const PackedFrame frame = packAlignedFrame(toFloat3(2.0 * n), {toFloat3(3.0 * t + 0.4 * n), toFloat3(0.1 * b)});
        CHECK(frame.w != 0);
        const Axes axes = axesOf(frame);
        CHECK(distance(axes.normal, n) < 5e-4);
        CHECK(distance(axes.tangent, t) < 5e-4);
        CHECK(distance(axes.bitangent, b) < 1e-3);
    }
}

TEST_CASE("uv without a direction leave the frame that a normal alone gives")
{
    for (const Float3& along : {Float3{}, Float3{0.0F, 0.0F, 2.0F}}) {
        const PackedFrame frame = packAlignedFrame({0, 0, 1}, {along, along});
        const PackedFrame plain = packFrame({0, 0, 1});
        CHECK((frame.x == plain.x && frame.y == plain.y && frame.z == plain.z && frame.w == plain.w));
    }
    CHECK(distance(axesOf(packAlignedFrame({0, 0, 0}, {{1, 0, 0}, {0, 1, 0}})).normal, {0, 0, 1}) < 1e-3);
}

TEST_CASE("a normal map turns the frames along the uv, subdivided and deformed alike")
{
    for (int subdivision : {0, 1}) {
        VisualServer server({.backend = Backend::Null});
        VisualBody& body = server.add(bedDef(withNormals(level()), subdivision));
        const auto check = [&](Vec3 u, Vec3 v) {
            for (const PackedFrame& frame : kept(body).geometry.vertices.frames) {
                const Axes axes = axesOf(frame);
                CHECK(dot(axes.tangent, u) > 0.9); // the folds tilt it
                CHECK(dot(axes.bitangent, v) > 0.9);
            }
        };
        check({1, 0, 0}, {0, 0, -1});
        std::vector<Vec3> turned(body.vertices().begin(), body.vertices().end());
        for (Vec3& p : turned) p = {p.z, p.y, -p.x}; // a quarter turn about y
        body.setVertices(turned);
        check({0, 0, -1}, {-1, 0, 0});
    }
}

TEST_CASE("frames follow the material, the one of the pool as well")
{
    VisualServer server({.backend = Backend::Null});
    VisualBody& body = server.add(bedDef(kPlain));
    const auto aligned = [&] {
        const auto& frames = kept(body).geometry.vertices.frames;
        return std::ranges::all_of(frames, [](PackedFrame f) { return axesOf(f).tangent.x > 0.9; }) &&
               std::ranges::any_of(frames, [](PackedFrame f) { return f.z != 0; });
    };
    CHECK(!aligned());
    body.setMaterial(withNormals(level()));
    CHECK(aligned());
    CHECK(kept(body).vertexCalls == 1);
    body.setMaterial(withNormals(level(), 0.5));
    CHECK(kept(body).vertexCalls == 1); // nothing to turn
    body.setMaterial(kPlain);
    CHECK(!aligned());
    server.addMaterial("wall", kPlain);
    body.setMaterial(NamedMaterial{"wall"});
    server.changeMaterial("wall", withNormals(level()));
    CHECK(aligned());
}

TEST_CASE("the wall of a cut, whose uv are a line, gets frames of unit length")
{
    VisualServer server({.backend = Backend::Null});
    VisualBody& body = server.add(bedDef(withNormals(level())));
    geometry::TriangleMesh cut = bed(0.1, 12);
    const int first = int(cut.vertices.size());
    for (int i = 0; i < 3; ++i) { // a lip's vertices once more, and the rim below them
        cut.vertices.push_back(cut.vertices[std::size_t(i)]);
        cut.vertices.push_back(cut.vertices[std::size_t(i)] - Vec3{0, 0.01, 0});
        for (int twice = 0; twice < 2; ++twice) cut.uv.push_back(cut.uv[std::size_t(i)]);
    }
    for (int i = 0; i < 2; ++i) {
        const int a = first + 2 * i;
        cut.triangles.push_back({a, a + 1, a + 3});
        cut.triangles.push_back({a, a + 3, a + 2});
    }
    body.setMesh(cut, cut.vertices);
    const auto& frames = kept(body).geometry.vertices.frames;
    REQUIRE(frames.size() == cut.vertices.size());
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const PackedFrame f = frames[i];
        CHECK(std::sqrt(double(f.x) * f.x + double(f.y) * f.y + double(f.z) * f.z + double(f.w) * f.w) ==
              Approx(32767.0).epsilon(1e-3));
        const Axes axes = axesOf(f);
        if (int(i) >= first)
            CHECK(std::abs(axes.normal.y) < 1e-3);
        else
            CHECK(axes.tangent.x > 0.9);
    }
}

TEST_CASE("the null backend keeps the maps of every material that has them")
{
    const TextureFile file = level();
    VisualServer server({.backend = Backend::Null});
    VisualBody& body = server.add(bedDef(UnlitMaterial{}));
    for (const Material& material :
         {Material(TissueMaterial{.normalTexture = file, .roughnessTexture = file, .occlusionTexture = file}),
          Material(MucosaMaterial{.normalTexture = file, .normalStrength = 2.0}),
          Material(BoneMaterial{.occlusionTexture = file, .occlusionStrength = 0.5}),
          Material(MetalMaterial{.roughnessTexture = file}),
          Material(GlassMaterial{.normalTexture = file, .roughnessTexture = file, .normalStrength = 0.2})}) {
        body.setMaterial(material);
        CHECK(kept(body).material == material);
    }
}

TEST_CASE("a wrong map or strength is an error that names body, field and file")
{
    const auto path = [](const char* name) { return std::string(FILASOFIA_BINARY_DIR) + "/" + name; };
    std::ofstream(path("words.png")) << "not a picture";
    const TextureFile heights = pictureFile("heights", 8, [](double u, double) {
        return std::array{u, u, u};
    }); // half of it below 128
    const std::vector<std::pair<Material, std::vector<std::string>>> wrong = {
        {TissueMaterial{.normalTexture = TextureFile{"nowhere.png"}},
         {"body 'bed': material: normalTexture: picture 'nowhere.png'", "no such file"}},
        {MucosaMaterial{.roughnessTexture = TextureFile{"nowhere.png"}}, {"roughnessTexture", "nowhere.png"}},
        {BoneMaterial{.occlusionTexture = TextureFile{path("words.png")}}, {"occlusionTexture", "words.png"}},
        {MetalMaterial{.baseColorTexture = TextureFile{"nowhere.png"}}, {"baseColorTexture", "nowhere.png"}},
        {GlassMaterial{.normalTexture = heights}, {"normalTexture", "heights_", "no normal map", "128"}},
        {TissueMaterial{.normalStrength = -0.1}, {"normalStrength", "[0, 4]"}},
        {MetalMaterial{.occlusionStrength = 1.5}, {"occlusionStrength", "[0, 1]"}},
    };
    std::vector<Backend> backends{Backend::Null};
    if (hasBackend(Backend::Headless)) backends.push_back(Backend::Headless);
    for (Backend backend : backends) {
        VisualServer server({.backend = backend, .width = 64, .height = 48});
        VisualBody& body = server.add(bedDef(TissueMaterial{}));
        for (const auto& [material, parts] : wrong)
            for (const std::string& part : parts)
                CHECK_THROWS_WITH(body.setMaterial(material), Contains("bed") && Contains(part));
        CHECK(body.material() == Material(TissueMaterial{}));
        VisualBody& ball = server.add(sphereDef()); // without uv
        CHECK_THROWS_WITH(ball.setMaterial(MetalMaterial{.roughnessTexture = level()}),
                          "body 'ball': material: roughnessTexture needs texture coordinates, but the mesh has no uv");
        CHECK(server.render());
    }
}

} // namespace texture_maps_test
