// Materials, textures and the pool: what works and what is an Error, the same on every backend.
#include "little_scene.h"
#include "organs.h"

#include "filasofia/core/error.h"
#include "filasofia/geometry/texture_seams.h"
#include "filasofia/visual/material_package.h"
#include "filasofia/visual/null_backend.h"
#include "filasofia/visual/scene.h"

#include <fstream>

namespace materials_test {

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

std::string tempFile(const std::string& name) { return std::string(FILASOFIA_BINARY_DIR) + "/" + name; }

std::string written(const std::string& name, const std::string& bytes)
{
    std::ofstream(tempFile(name), std::ios::binary) << bytes;
    return tempFile(name);
}

std::string readAll(const std::string& file)
{
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// A small valid picture as a file.
std::string goodPng()
{
    Image image{4, 4, std::vector<std::uint8_t>(64, 200)};
    savePng(image, tempFile("good.png"));
    return tempFile("good.png");
}

/// The head of a PNG of this size, with nothing after it.
std::string pngHead(std::uint32_t width, std::uint32_t height)
{
    std::string bytes;
    bytes.append("\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR", 16);
    for (std::uint32_t number : {width, height})
        for (int shift : {24, 16, 8, 0}) bytes += char(number >> shift & 255U);
    return bytes.append("\x08\x02\0\0\0\0\0\0\0", 9);
}

VisualBodyDef screenDef(const Material& material)
{
    return {.name = "screen", .mesh = screen(0.1, 0.1), .material = material};
}

const NullBackend::Body& kept(VisualBody& body)
{
    return dynamic_cast<const NullBackend&>(*body.impl().scene.backend).bodies.at(body.impl().slot);
}

} // namespace

TEST_CASE("an invalid number or colour is an error in every material")
{
    const std::vector<std::pair<Material, const char*>> wrong = {
        {TissueMaterial{.baseColor = {kNan, 0, 0}}, "baseColor.red"},
        {MucosaMaterial{.vesselColor = {0, 0, 1.5}}, "vesselColor.blue"},
        {MucosaMaterial{.pits = -0.1}, "pits"},
        {BoneMaterial{.stainColor = {0, kNan, 0}}, "stainColor.green"},
        {BoneMaterial{.noiseScale = 0.0}, "noiseScale"},
        {MetalMaterial{.roughness = kNan}, "roughness"},
        {GlassMaterial{.refractiveIndex = 0.9}, "refractiveIndex"},
        {GlassMaterial{.tint = {0.0, 1, 1}}, "tint"},
        {GlassMaterial{.thickness = kNan}, "thickness"},
        {UnlitMaterial{.color = {kNan, 0, 0}}, "color.red"},
        {ThreadMaterial{.strands = 33}, "strands"},
        {ThreadMaterial{.pitch = 0.0}, "pitch"},
        {NamedMaterial{"nobody"}, "nobody"},
    };
    for (Backend backend : backends()) {
        LittleScene scene(backend);
        for (const auto& [material, what] : wrong) {
            CHECK_THROWS_WITH(scene.body.setMaterial(material), Contains("ball") && Contains(what));
            CHECK_THROWS_WITH(scene.server.add(screenDef(material)), Contains("screen") && Contains(what));
        }
        CHECK(scene.body.material() == Material(TissueMaterial{}));
        CHECK(scene.server.statistics().bodies == 1);
        CHECK(scene.server.render());
    }
}

TEST_CASE("a missing, damaged or huge picture is an error that names it")
{
    const std::string png = readAll(goodPng());
    const std::vector<std::pair<std::string, const char*>> wrong = {
        {tempFile("nowhere.png"), "nowhere.png"},
        {std::string(FILASOFIA_BINARY_DIR), "must be a file, got a directory"},
        {"/dev/zero", "is not a regular file"},
        {"", "no such file"},
        {written("text.png", "not a picture"), "text.png"},
        {written("empty.png", ""), "empty.png"},
        {written("cut.png", png.substr(0, png.size() / 2)), "cut.png"},
        {written("cut.jpg", "\xff\xd8\xff\xe0"), "cut.jpg"},
        {written("huge.png", pngHead(100000, 100000)), "100000 x 100000"},
        {written("wide.png", pngHead(8193, 1)), "8193"},
        {written("endless.png", pngHead(0xffffffff, 0xffffffff)), "at most 8192"},
    };
    for (Backend backend : backends()) {
        LittleScene scene(backend);
        for (const auto& [file, what] : wrong) {
            INFO(file);
            CHECK_THROWS_WITH(scene.server.add(screenDef(UnlitMaterial{.texture = TextureFile{file}})),
                              Contains("screen") && Contains(what));
            CHECK_THROWS_AS(loadImage(file), Error);
        }
        CHECK(scene.server.render());
    }
}

TEST_CASE("a texture needs uv, also when the mesh changes or the pool does")
{
    const Texture picture = TextureFile{goodPng()};
    for (Backend backend : backends()) {
        LittleScene scene(backend);
        for (const Material& material :
             {Material(TissueMaterial{.baseColorTexture = picture}),
              Material(MetalMaterial{.baseColorTexture = picture}), Material(BoneMaterial{.baseColorTexture = picture}),
              Material(UnlitMaterial{.texture = picture})})
            CHECK_THROWS_WITH(scene.body.setMaterial(material), Contains("ball") && Contains("uv"));
        VisualBody& screenBody = scene.server.add(screenDef(UnlitMaterial{.texture = picture}));
        geometry::TriangleMesh bare = screen(0.2, 0.2);
        bare.uv.clear();
        CHECK_THROWS_WITH(screenBody.setMesh(bare, bare.vertices), Contains("screen") && Contains("uv"));
        scene.server.addMaterial("plain", TissueMaterial{});
        scene.body.setMaterial(NamedMaterial{"plain"});
        CHECK_THROWS_WITH(scene.server.changeMaterial("plain", UnlitMaterial{.texture = picture}),
                          Contains("ball") && Contains("uv"));
        CHECK(scene.server.material("plain") == Material(TissueMaterial{}));
        CHECK(scene.server.render());
    }
}

TEST_CASE("a body has the uv of its mesh, subdivided like its vertices")
{
    VisualServer server({.backend = Backend::Null});
    VisualBodyDef def = screenDef(UnlitMaterial{});
    def.subdivision = 1;
    VisualBody& body = server.add(def);
    const BodyGeometry& geometry = kept(body).geometry;
    REQUIRE(geometry.uv.size() == geometry.rest.size());
    for (std::size_t i = 0; i < geometry.uv.size(); ++i) { // the screen's shape is an affine map of its uv
        CHECK(geometry.uv[i][0] == Approx(geometry.rest[i].x / 0.1 + 0.5).margin(1e-5));
        CHECK(geometry.uv[i][1] == Approx(geometry.rest[i].y / 0.1 + 0.5).margin(1e-5));
    }
    CHECK(kept(server.add(sphereDef())).geometry.uv.empty());
}

TEST_CASE("where its texture has a seam, a body is drawn with a vertex for each side, whatever changes of it")
{
    VisualServer server({.backend = Backend::Null});
    VisualBodyDef def = screenDef(UnlitMaterial{});
    std::vector<std::array<double, 2>> ofCorners;
    for (std::size_t t = 0; t < def.mesh.triangles.size(); ++t)
        for (const int v : def.mesh.triangles[t])
            ofCorners.push_back({def.mesh.uv[std::size_t(v)][0] + double(t), 0.5});
    geometry::setUvOfCorners(def.mesh, ofCorners);
    REQUIRE(geometry::perCorner(def.mesh));
    VisualBody& body = server.add(def);
    const auto whole = [&](std::size_t vertices) {
        const auto& now = kept(body);
        CHECK(now.geometry.rest.size() == vertices);
        CHECK(now.geometry.uv.size() == vertices);
        CHECK(now.geometry.vertices.positions.size() == vertices);
        CHECK(now.geometry.vertices.frames.size() == vertices);
        CHECK(now.states.size() == vertices);
        for (std::size_t i = 0; i < ofCorners.size(); ++i) {
            const std::uint32_t drawn = now.geometry.indices[i];
            CHECK(now.geometry.uv[drawn][0] == Approx(ofCorners[i][0]));
            CHECK(now.geometry.vertices.positions[drawn] ==
                  toFloat3(body.vertices()[std::size_t(def.mesh.triangles[i / 3][i % 3])]));
        }
    };
    const std::size_t corners = 3 * def.mesh.triangles.size(); // no triangle has a pair of another
    body.setSurfaceState(std::vector<SurfaceState>(def.mesh.vertices.size(), SurfaceState{.blood = 0.5}));
    whole(corners);
    std::vector<Vec3> moved = def.mesh.vertices;
    for (Vec3& each : moved) each.z += each.x;
    body.setVertices(moved);
    whole(corners);
    body.setMesh({moved, def.mesh.triangles, def.mesh.uv}, def.mesh.vertices);
    body.setSurfaceState(std::vector<SurfaceState>(def.mesh.vertices.size(), SurfaceState{.burn = 0.5}));
    whole(corners);
}

TEST_CASE("a change in the pool changes the bodies that use it, and no other")
{
    VisualServer server({.backend = Backend::Null});
    server.addMaterial("liver", TissueMaterial{.wetness = 0.1});
    VisualBodyDef def = sphereDef();
    def.material = NamedMaterial{"liver"};
    VisualBody& first = server.add(def);
    VisualBody& second = server.add(def);
    VisualBody& other = server.add(sphereDef());
    CHECK(std::get<TissueMaterial>(kept(first).material).wetness == 0.1);
    second.setMaterial(MetalMaterial{});
    server.changeMaterial("liver", MucosaMaterial{.wetness = 0.2});
    CHECK(std::get<MucosaMaterial>(kept(first).material).wetness == 0.2);
    CHECK(first.material() == Material(NamedMaterial{"liver"}));
    CHECK(std::holds_alternative<MetalMaterial>(kept(second).material));
    CHECK(std::holds_alternative<TissueMaterial>(kept(other).material));
    CHECK(server.material("liver") == Material(MucosaMaterial{.wetness = 0.2}));
    // Refers to the pool again.
    second.setMaterial(NamedMaterial{"liver"});
    CHECK(std::holds_alternative<MucosaMaterial>(kept(second).material));
}

TEST_CASE("wrong use of the pool is an error that names the material")
{
    for (Backend backend : backends()) {
        LittleScene scene(backend);
        VisualServer& server = scene.server;
        server.addMaterial("liver", TissueMaterial{});
        CHECK_THROWS_WITH(server.addMaterial("liver", MetalMaterial{}), Contains("liver"));
        CHECK_THROWS_AS(server.addMaterial("", MetalMaterial{}), Error);
        CHECK_THROWS_WITH(server.addMaterial("steel", MetalMaterial{.roughness = 3}),
                          Contains("steel") && Contains("roughness"));
        CHECK_THROWS_WITH(server.addMaterial("loop", NamedMaterial{"liver"}), Contains("loop"));
        CHECK_THROWS_WITH(server.changeMaterial("liver", NamedMaterial{"liver"}), Contains("liver"));
        CHECK_THROWS_WITH(server.changeMaterial("spleen", TissueMaterial{}), Contains("spleen"));
        CHECK_THROWS_WITH(server.changeMaterial("liver", TissueMaterial{.wetness = kNan}), Contains("wetness"));
        CHECK_THROWS_WITH(server.material("spleen"), Contains("spleen"));
        CHECK_THROWS_WITH(server.removeMaterial("spleen"), Contains("spleen"));
        scene.body.setMaterial(NamedMaterial{"liver"});
        CHECK_THROWS_WITH(server.removeMaterial("liver"), Contains("liver") && Contains("ball"));
        scene.body.setMaterial(TissueMaterial{});
        server.removeMaterial("liver");
        CHECK_THROWS_AS(scene.body.setMaterial(NamedMaterial{"liver"}), Error);
        CHECK(server.render());
    }
}

#ifdef FILASOFIA_TEST_MATERIAL

TEST_CASE("a material file lists its parameters, and wrong ones are errors that name file and parameter")
{
    const std::string own = FILASOFIA_TEST_MATERIAL;
    const MaterialPackage package = readMaterialPackage(own);
    REQUIRE(package.find("color"));
    CHECK(package.find("color")->kind == MaterialPackage::Kind::Float3);
    CHECK(package.find("stripes")->kind == MaterialPackage::Kind::Int);
    CHECK(package.find("width")->kind == MaterialPackage::Kind::Float);
    CHECK(package.find("axis")->kind == MaterialPackage::Kind::Float4);
    CHECK(package.find("glossy")->kind == MaterialPackage::Kind::Bool);
    CHECK(package.find("picture")->kind == MaterialPackage::Kind::Sampler);
    CHECK(package.find("pair")->kind == MaterialPackage::Kind::Other);
    CHECK_FALSE(package.readsUv);

    const std::vector<std::pair<MaterialParameter, const char*>> wrong = {
        {{"colour", Color{}}, "no parameter of this name"},
        {{"color", 1.0}, "must be a float3, got a float"},
        {{"stripes", 1.5}, "must be a int, got a float"},
        {{"width", true}, "must be a float, got a bool"},
        {{"axis", Vec3{}}, "must be a float4, got a float3"},
        {{"picture", 1}, "must be a sampler2d, got a int"},
        {{"pair", 1.0}, "another type"},
        {{"width", kNan}, "finite"},
        {{"width", 1e300}, "finite"},
        {{"axis", std::array<double, 4>{0, 0, kNan, 0}}, "finite"},
        {{"color", Color{kNan, 0, 0}}, "red"},
        {{"picture", Texture(TextureFile{"nowhere.png"})}, "nowhere.png"},
    };
    for (Backend backend : backends()) {
        LittleScene scene(backend);
        for (const auto& [parameter, what] : wrong) {
            INFO(parameter.name);
            CHECK_THROWS_WITH(scene.body.setMaterial(CustomMaterial{own, {parameter}}),
                              Contains("ball") && Contains(what));
        }
        CHECK_THROWS_WITH(scene.body.setMaterial(CustomMaterial{own, {{"colour", 1.0}}}),
                          Contains("own.filamat") && Contains("colour"));
        scene.body.setMaterial(CustomMaterial{own, {{"color", Color{0, 1, 0}}, {"glossy", false}}});
        scene.body.setMaterial(CustomMaterial{own, {}});
        CHECK(scene.server.render());
    }
}

TEST_CASE("a material file that is invalid, damaged, of another version or purpose is an error that names it")
{
    const std::string own = readAll(FILASOFIA_TEST_MATERIAL);
    std::string version = own, shaders = own, blending = own;
    version[12] = 9; // the first chunk holds the version
    const std::size_t glsl = own.find("LSLG_TAM");
    REQUIRE(glsl != std::string::npos);
    shaders[glsl + 12 + 8 + 3 + 2] = char(0x7f); // the beginning of the first shader
    blending[own.find("NELB_TAM") + 12] = 77;
    const std::vector<std::pair<std::string, const char*>> wrong = {
        {tempFile("nowhere.filamat"), "no such file"},
        {written("empty.filamat", ""), "empty"},
        {written("text.filamat", "material { name : text }"), "not a compiled material"},
        {written("short.filamat", own.substr(0, 5)), "damaged"},
        {written("cut.filamat", own.substr(0, own.size() / 2)), "damaged"},
        {written("end.filamat", own.substr(0, own.size() - 1)), "damaged"},
        {written("version.filamat", version), "version 10"},
        {written("shaders.filamat", shaders), "damaged"},
        {written("blending.filamat", blending), "damaged"},
        {FILASOFIA_TEST_POST_MATERIAL, "surface domain"},
        {FILASOFIA_TEST_CUBE_MATERIAL, "'around' must be a plain sampler2d"},
    };
    for (Backend backend : backends()) {
        LittleScene scene(backend);
        for (const auto& [file, what] : wrong) {
            INFO(file);
            CHECK_THROWS_WITH(scene.body.setMaterial(CustomMaterial{file, {}}), Contains("ball") && Contains(what));
        }
        CHECK(scene.server.render());
    }
}

TEST_CASE("a material file cut anywhere is an error, never the end of the process")
{
    const std::string own = readAll(FILASOFIA_TEST_MATERIAL);
    const std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(own.data()), own.size());
    std::mt19937 random(1);
    for (int i = 0; i < 300; ++i) {
        const std::size_t length = i < 100 ? std::size_t(i) * 7 : random() % own.size();
        CHECK_THROWS_AS(parseMaterialPackage(bytes.first(length), "cut"), Error);
    }
}

#endif

} // namespace materials_test
