#include "shown_stage.h"

#include "filasofia/core/error.h"
#include "filasofia/geometry/surface.h"

namespace cut_drawn_test {

using namespace filasofia;
using namespace filasofia::runtime;

namespace {

/// A block that may be cut, and a blade that goes through it in the plane x = 1 mm.
struct CutStage : ShownStage {
    BodyId tissue, blade;

    CutStage()
    {
        tissue = physics.add(physics::SoftBodyDef{
            .name = "tissue", .mesh = geometry::shapes::block({0.04, 0.04, 0.04}, {6, 6, 6}), .dynamicTopology = true});
        const auto mesh = std::make_shared<const geometry::TriangleMesh>(
            geometry::TriangleMesh{.vertices = {{0, 0, -0.03}, {0, 0, 0.03}, {0, 0.05, 0.03}, {0, 0.05, -0.03}},
                                   .triangles = {{0, 1, 2}, {0, 2, 3}},
                                   .uv = {}});
        blade = physics.add(physics::RigidBodyDef{
            .name = "blade", .elements = {poseAt(0.03)}, .collision = {{.mesh = mesh, .cutting = true}}});
    }
    static Pose poseAt(double y) { return {.position = {0.001, y, 0}}; }
    void cut(double to)
    {
        for (double y = 0.03; y > to; y -= 0.0005) {
            physics.setPose(blade, poseAt(y));
            step();
        }
        bindings.finishMeshes();
        step();
    }
    static double red(const visual::NullBackend::Body& body)
    {
        return std::get<visual::TissueMaterial>(body.material).baseColor.red;
    }
};

} // namespace

TEST_CASE("what a cut opens is drawn in the inside's material, until the body is whole again")
{
    CutStage stage;
    const ShownId id = stage.bindings.show(stage.tissue, {}, stage.physics);
    stage.step();
    const std::size_t whole = stage.only().geometry.indices.size();
    stage.cut(0.0);
    auto all = stage.drawn();
    REQUIRE(all.size() == 2);
    CHECK(all[0]->geometry.indices.size() >= whole);         // no triangle of the skin is lost
    CHECK(all[1]->geometry.indices.size() >= 3 * 2 * 6 * 3); // both sides of at least three rows of cells
    CHECK(CutStage::red(*all[1]) < CutStage::red(*all[0]));
    for (const visual::Float3& place : all[1]->geometry.rest) CHECK(std::abs(place.x - 0.001F) < 0.004F);

    visual::TissueMaterial pale;
    pale.baseColor = {0.9, 0.8, 0.7};
    stage.bindings.setMaterial(id, pale); // the skin's; the inside's material is derived from it again
    stage.step();
    CHECK(CutStage::red(*all[0]) == 0.9);
    CHECK(CutStage::red(*all[1]) < 0.9);

    stage.physics.setPose(stage.blade, CutStage::poseAt(0.5));
    stage.physics.reset();
    stage.step();
    stage.bindings.finishMeshes();
    stage.step();
    CHECK(stage.only().geometry.indices.size() == whole);
}

TEST_CASE("an inside that cannot be drawn is an error before anything is cut")
{
    CutStage stage;
    stage.bindings.show(stage.tissue, {.interior = visual::CustomMaterial{.file = "no/such.filamat"}}, stage.physics);
    stage.physics.step(1e-3);
    CHECK_THROWS_WITH(stage.map(), Catch::Contains("no/such.filamat"));
}

TEST_CASE("a finer surface opens where its body is cut, and is whole again with it")
{
    CutStage stage;
    geometry::TriangleMesh fine =
        geometry::extractSurface(*geometry::shapes::block({0.04, 0.04, 0.04}, {9, 8, 7})).mesh;
    stage.bindings.show(stage.tissue, {.surface = std::make_shared<const geometry::TriangleMesh>(fine)}, stage.physics);
    stage.step();
    CHECK(stage.only().geometry.indices.size() == 3 * fine.triangles.size());
    const auto widest = [&] { // largest extent of a triangle along x
        const visual::NullBackend::Body& skin = *stage.drawn().front();
        float width = 0.0F;
        for (std::size_t i = 0; i < skin.geometry.indices.size(); i += 3) {
            float low = 1.0F, high = -1.0F;
            for (std::size_t k = i; k < i + 3; ++k) {
                const float x = skin.geometry.rest[skin.geometry.indices[k]].x;
                low = std::min(low, x);
                high = std::max(high, x);
            }
            if (low < 0.0F && high > 0.002F && skin.geometry.rest[skin.geometry.indices[i]].y > 0.013F)
                width = std::max(width, high - low);
        }
        return width;
    };
    CHECK(widest() > 0.004F);
    stage.cut(0.0);
    const auto all = stage.drawn();
    REQUIRE(all.size() == 2);
    CHECK(all[0]->geometry.indices.size() > 3 * fine.triangles.size());
    CHECK(all[1]->geometry.indices.size() >= 3 * 2 * 6 * 3);
    CHECK(CutStage::red(*all[1]) < CutStage::red(*all[0]));
    CHECK(widest() < 0.0035F); // no triangle at the top reaches across the cut any more

    stage.physics.setPose(stage.blade, CutStage::poseAt(0.5));
    stage.physics.reset();
    stage.step();
    stage.bindings.finishMeshes();
    stage.step();
    CHECK(stage.only().geometry.indices.size() == 3 * fine.triangles.size());
}

TEST_CASE("the inside of a textured surface has no textures, neither its own nor those of the pool")
{
    const std::string png = std::string(FILASOFIA_BINARY_DIR) + "/skin.png";
    visual::savePng({4, 4, std::vector<std::uint8_t>(64, 200)}, png);
    const visual::TissueMaterial textured{.baseColorTexture = visual::TextureFile{png},
                                          .normalTexture = visual::TextureFile{png}};
    const std::vector<visual::MaterialParameter> overrides = {
        {"roughnessTexture", visual::Texture{textured.baseColorTexture}}};
    for (const visual::Material& material :
         {visual::Material{textured}, visual::Material{visual::NamedMaterial{"skin", overrides}}}) {
        CutStage stage;
        stage.visual.addMaterial("skin", textured);
        geometry::TriangleMesh fine =
            geometry::extractSurface(*geometry::shapes::block({0.04, 0.04, 0.04}, {9, 8, 7})).mesh;
        for (const Vec3& p : fine.vertices) fine.uv.push_back({p.x / 0.04, p.y / 0.04});
        stage.bindings.show(
            stage.tissue,
            {.surface = std::make_shared<const geometry::TriangleMesh>(std::move(fine)), .material = material},
            stage.physics);
        stage.step();
        stage.cut(0.0);
        const auto all = stage.drawn();
        REQUIRE(all.size() == 2);
        const auto& skin = std::get<visual::TissueMaterial>(all[0]->material);
        CHECK(skin.normalTexture == textured.normalTexture);
        CHECK(all[0]->geometry.uv.size() == all[0]->geometry.rest.size());
        const auto& inside = std::get<visual::TissueMaterial>(all[1]->material);
        CHECK(inside.baseColorTexture == visual::Texture{});
        CHECK(inside.normalTexture == visual::TextureMap{});
        CHECK(inside.roughnessTexture == visual::TextureMap{});
    }
}

} // namespace cut_drawn_test
