// Bodies that tune the parameters of a material of the pool.
#include "little_scene.h"
#include "organs.h"

#include "filasofia/core/error.h"
#include "filasofia/visual/null_backend.h"
#include "filasofia/visual/scene.h"

namespace overrides_test {

using namespace filasofia;
using namespace filasofia::visual;
using Catch::Contains;

namespace {

const NullBackend::Body& kept(VisualBody& body)
{
    return dynamic_cast<const NullBackend&>(*body.impl().scene.backend).bodies.at(body.impl().slot);
}

/// Three bodies that wear the pool's "wall", the first as it is.
struct Wards {
    VisualServer server{{.backend = Backend::Null}};
    VisualBody* plain = nullptr;
    VisualBody* own = nullptr;
    VisualBody* other = nullptr;

    Wards()
    {
        server.addMaterial("wall", MucosaMaterial{.wetness = 0.7, .pits = 0.3});
        plain = &add("plain", {});
        own = &add("own", {{"wetness", 0.1}, {"baseColor", Color{0.1, 0.2, 0.3}}});
        other = &add("other", {{"pits", 1}});
    }
    VisualBody& add(const char* name, std::vector<MaterialParameter> overrides)
    {
        return server.add(VisualBodyDef{
            .name = name, .mesh = screen(0.1, 0.1), .material = NamedMaterial{"wall", std::move(overrides)}});
    }
    static const MucosaMaterial& shown(VisualBody* body) { return std::get<MucosaMaterial>(kept(*body).material); }
};

} // namespace

TEST_CASE("a body's overrides change neither the pool's material nor other bodies")
{
    Wards wards;
    CHECK(Wards::shown(wards.plain) == MucosaMaterial{.wetness = 0.7, .pits = 0.3});
    CHECK(Wards::shown(wards.own) == MucosaMaterial{.baseColor = {0.1, 0.2, 0.3}, .wetness = 0.1, .pits = 0.3});
    CHECK(Wards::shown(wards.other) == MucosaMaterial{.wetness = 0.7, .pits = 1.0});
    CHECK(wards.server.material("wall") == Material(MucosaMaterial{.wetness = 0.7, .pits = 0.3}));
    CHECK(std::get<NamedMaterial>(wards.own->material()).overrides.size() == 2);
}

TEST_CASE("a change in the pool reaches what a body does not override")
{
    Wards wards;
    wards.server.changeMaterial("wall", MucosaMaterial{.roughness = 0.9, .wetness = 0.5});
    CHECK(Wards::shown(wards.plain) == MucosaMaterial{.roughness = 0.9, .wetness = 0.5});
    CHECK(Wards::shown(wards.own) == MucosaMaterial{.baseColor = {0.1, 0.2, 0.3}, .roughness = 0.9, .wetness = 0.1});
    CHECK(Wards::shown(wards.other).pits == 1.0);
}

TEST_CASE("a change in the pool that an override does not fit is an error, and nothing has changed")
{
    Wards wards;
    CHECK_THROWS_WITH(wards.server.changeMaterial("wall", TissueMaterial{}),
                      Contains("body 'other': material 'wall': TissueMaterial has no parameter 'pits'"));
    CHECK(Wards::shown(wards.plain) == MucosaMaterial{.wetness = 0.7, .pits = 0.3});
    CHECK(wards.server.material("wall") == Material(MucosaMaterial{.wetness = 0.7, .pits = 0.3}));
    wards.other->setMaterial(NamedMaterial{"wall"}); // without its override it fits
    wards.server.changeMaterial("wall", TissueMaterial{});
    CHECK(std::get<TissueMaterial>(kept(*wards.own).material).wetness == 0.1);
}

TEST_CASE("textures of a pool's material are overridden and removed like any parameter")
{
    const std::string png = std::string(FILASOFIA_BINARY_DIR) + "/override.png";
    savePng({4, 4, std::vector<std::uint8_t>(64, 200)}, png);
    VisualServer server({.backend = Backend::Null});
    server.addMaterial("steel", MetalMaterial{.baseColorTexture = TextureFile{png}});
    VisualBody& ball = server.add(sphereDef()); // without uv
    CHECK_THROWS_WITH(ball.setMaterial(NamedMaterial{"steel"}), Contains("ball") && Contains("baseColorTexture"));
    ball.setMaterial(NamedMaterial{"steel", {{"baseColorTexture", Texture{NoTexture{}}}}});
    CHECK(std::get<MetalMaterial>(kept(ball).material) == MetalMaterial{});
    VisualBody& flat = server.add(VisualBodyDef{.name = "flat", .mesh = screen(0.1, 0.1)});
    flat.setMaterial(NamedMaterial{"steel", {{"normalTexture", Texture{TextureFile{png}}}}});
    CHECK(std::get<MetalMaterial>(kept(flat).material).normalTexture == TextureMap(TextureFile{png}));
}

TEST_CASE("a wrong override is an error that names body, material, parameter and the nearest right name")
{
    const std::vector<std::pair<MaterialParameter, std::string>> wrong = {
        {{"rougness", 0.2}, "MucosaMaterial has no parameter 'rougness' (did you mean 'roughness'?)"},
        {{"normalTextur", Texture{}}, "has no parameter 'normalTextur' (did you mean 'normalTexture'?)"},
        {{"zzzzzzzz", 0.2}, "has no parameter 'zzzzzzzz'; it has baseColor, subsurfaceColor, vesselColor, "},
        {{"roughness", Color{}}, "override 'roughness': must be a number, got a colour"},
        {{"baseColor", 0.5}, "override 'baseColor': must be a colour, got a number"},
        {{"wetness", true}, "override 'wetness': must be a number, got a flag"},
        {{"normalTexture", Texture{ViewPicture{"v"}}}, "override 'normalTexture': must be a file, not the picture of"},
        {{"roughness", 3.0}, "roughness must be in [0.05, 1], got 3"},
        {{"baseColor", Color{2, 0, 0}}, "baseColor.red must be in [0, 1], got 2"},
        {{"baseColorTexture", Texture{TextureFile{"nowhere.png"}}}, "baseColorTexture: picture 'nowhere.png'"},
    };
    std::vector<Backend> backends{Backend::Null};
    if (hasBackend(Backend::Headless)) backends.push_back(Backend::Headless);
    for (Backend backend : backends) {
        LittleScene scene(backend);
        scene.server.addMaterial("wall", MucosaMaterial{});
        for (const auto& [parameter, what] : wrong)
            CHECK_THROWS_WITH(scene.body.setMaterial(NamedMaterial{"wall", {parameter}}),
                              Contains("body 'ball': material 'wall': ") && Contains(what));
        CHECK_THROWS_WITH(scene.body.setMaterial(NamedMaterial{"wall", {{"pits", 0.1}, {"pits", 0.2}}}),
                          "body 'ball': material 'wall': override 'pits' is given twice");
        CHECK(scene.body.material() == Material(TissueMaterial{}));
        CHECK(scene.server.render());
    }
}

#ifdef FILASOFIA_TEST_MATERIAL

TEST_CASE("parameters of the user's own material are overridden by the names of its file")
{
    for (Backend backend : {Backend::Null, Backend::Headless}) {
        LittleScene scene(backend);
        const CustomMaterial striped{FILASOFIA_TEST_MATERIAL, {{"stripes", 3}, {"width", 0.5}}};
        scene.server.addMaterial("striped", striped);
        scene.body.setMaterial(NamedMaterial{"striped", {{"width", 0.25}, {"color", Color{0, 1, 0}}}});
        CHECK_THROWS_WITH(scene.body.setMaterial(NamedMaterial{"striped", {{"colour", Color{}}}}),
                          Contains("body 'ball': material 'striped': material file '") &&
                              Contains("own.filamat' has no parameter 'colour' (did you mean 'color'?)"));
        CHECK_THROWS_WITH(scene.body.setMaterial(NamedMaterial{"striped", {{"stripes", 1.5}}}),
                          Contains("'stripes'") && Contains("must be a int, got a float"));
        CHECK(scene.server.material("striped") == Material(striped));
        CHECK(scene.server.render());
        if (backend == Backend::Headless) continue;
        const auto& shown = std::get<CustomMaterial>(kept(scene.body).material);
        CHECK(shown.parameters ==
              std::vector<MaterialParameter>{{"stripes", 3}, {"width", 0.25}, {"color", Color{0, 1, 0}}});
    }
}

TEST_CASE("a picture shows the overrides of one body only")
{
    LittleScene scene;
    lookFromFront(scene);
    scene.server.remove(scene.body);
    scene.server.addMaterial("label", UnlitMaterial{.color = {0.8, 0.0, 0.0}});
    for (int side : {-1, 1}) {
        const NamedMaterial material =
            side < 0 ? NamedMaterial{"label"} : NamedMaterial{"label", {{"color", Color{0.0, 0.0, 0.8}}}};
        scene.server.add(VisualBodyDef{.name = "label", .mesh = screen(0.08, 0.08), .material = material})
            .setPose({{0.06 * side, 0, 0.1}, {}});
    }
    const Image shown = scene.server.capture();
    const auto left = shown.pixel(100, 120), right = shown.pixel(220, 120);
    CHECK((left[0] > 150 && left[2] < 60));
    CHECK((right[2] > 150 && right[0] < 60));
}

#endif

} // namespace overrides_test
