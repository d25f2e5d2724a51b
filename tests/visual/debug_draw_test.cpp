#include "filasofia/core/error.h"
#include "filasofia/visual/null_backend.h"
#include "filasofia/visual/overlays.h"
#include "filasofia/visual/scene.h"
#include "little_scene.h"

#include <limits>

namespace debug_draw_test {

using namespace filasofia;
using namespace filasofia::visual;

namespace {

const NullOverlays& overlaysOf(LittleScene& scene)
{
    return dynamic_cast<const NullBackend&>(*scene.body.impl().scene.backend).overlay;
}

} // namespace

TEST_CASE("a debug drawing is in one picture, or in all until it is cleared")
{
    LittleScene scene(Backend::Null);
    DebugDraw& debug = scene.server.debug();
    const NullOverlays& drawn = overlaysOf(scene);
    debug.line({0, 0, 0}, {1, 0, 0});
    debug.point({0, 1, 0}, {.onTop = true, .keep = true});
    debug.text({0, 0, 1}, "tip", {.keep = true});
    debug.text({0, 0, 1}, "now");
    CHECK(debug.counts().texts == 2);
    scene.server.render();
    CHECK(drawn.debug.inside.indices.size() == 6);
    CHECK(drawn.debug.onTop.indices.size() == 6);
    scene.server.render();
    CHECK(drawn.debug.inside.indices.empty());
    CHECK(drawn.debug.onTop.indices.size() == 6);
    CHECK(debug.counts().texts == 1);
    debug.clear();
    CHECK(debug.counts().vertices == 0);
    scene.server.render();
    CHECK(drawn.debug.onTop.indices.empty());
}

TEST_CASE("an arrow begins and ends at its points, and has its length")
{
    LittleScene scene(Backend::Null);
    scene.server.debug().arrow({1, 2, 3}, {1, 2, 5}, {.color = {1, 0, 0}});
    scene.server.debug().arrow({1, 2, 3}, {1, 2, 3}); // without length
    scene.server.render();
    const DebugLayer& layer = overlaysOf(scene).debug.inside;
    float low = 100, high = -100;
    for (const DebugVertex& v : layer.vertices) {
        low = std::min(low, v.position.z);
        high = std::max(high, v.position.z);
        CHECK(std::abs(v.position.x - 1.0F) <= 0.121F);
        CHECK(v.color == std::array<std::uint8_t, 4>{255, 0, 0, 255});
    }
    CHECK(low == Approx(3.0));
    CHECK(high == Approx(5.0));
    for (const std::uint32_t index : layer.indices) CHECK(index < layer.vertices.size());
}

TEST_CASE("a box has twelve edges, a frame three arrows along its axes")
{
    LittleScene scene(Backend::Null);
    scene.server.debug().box({{0, 0, 0}, {1, 2, 3}}, {{5, 0, 0}, {}});
    scene.server.render();
    const DebugLayer& layer = overlaysOf(scene).debug.inside;
    CHECK(layer.vertices.size() == 48);
    float total = 0;
    for (std::size_t i = 0; i < layer.vertices.size(); i += 4) {
        const Float3 edge = layer.vertices[i].other - layer.vertices[i].position;
        total += std::sqrt(dot(edge, edge));
        CHECK(layer.vertices[i].position.x >= 5.0F);
    }
    CHECK(total == Approx(4 * (1 + 2 + 3)));
    scene.server.debug().frame({}, 0.1);
    scene.server.render();
    float far = 0;
    for (const DebugVertex& v : layer.vertices) far = std::max({far, v.position.x, v.position.y, v.position.z});
    CHECK(far == Approx(0.1));
}

TEST_CASE("a text stands where its place is seen")
{
    LittleScene scene(Backend::Null);
    lookFromFront(scene);
    const View& view = *scene.look.view;
    const auto middle = projected(view, 320, 240, {0, 0, 0});
    REQUIRE(middle);
    CHECK((*middle)[0] == Approx(160));
    CHECK((*middle)[1] == Approx(120));
    const auto above = projected(view, 320, 240, {0.05, 0.05, 0});
    REQUIRE(above);
    const double pixels = 120.0 / (std::tan(std::numbers::pi / 6) * 0.3); // pixels per metre there
    CHECK((*above)[0] == Approx(160 + 0.05 * pixels));
    CHECK((*above)[1] == Approx(120 - 0.05 * pixels));
    CHECK_FALSE(projected(view, 320, 240, {0, 0, 1})); // behind the camera
    scene.server.debug().text({0, 0, 0}, "here");
    scene.server.render();
    CHECK(overlaysOf(scene).sheets.at(scene.look.view->impl().slot).picture.commands.size() == 1);
    scene.server.render();
    CHECK(overlaysOf(scene).sheets.at(scene.look.view->impl().slot).picture.commands.empty());
    scene.server.remove(*scene.look.view);
    scene.server.render();
    CHECK(overlaysOf(scene).sheets.empty());
}

TEST_CASE("wrong debug drawings are Errors")
{
    LittleScene scene(Backend::Null);
    DebugDraw& debug = scene.server.debug();
    const double nan = std::nan(""), endless = std::numeric_limits<double>::infinity();
    CHECK_THROWS_WITH(debug.line({0, 0, nan}, {}), Catch::Contains("debug drawing: line: from must be finite"));
    CHECK_THROWS_WITH(debug.arrow({}, {endless, 0, 0}), Catch::Contains("arrow: to must be finite"));
    CHECK_THROWS_WITH(debug.point({2e6, 0, 0}), Catch::Contains("point: at must be finite and below 1e6 m"));
    CHECK_THROWS_WITH(debug.text({0, nan, 0}, "x"), Catch::Contains("text: at"));
    CHECK_THROWS_WITH(debug.box({}, {}), Catch::Contains("box: high must be >= low"));
    CHECK_THROWS_WITH(debug.frame({}, 0.0), Catch::Contains("frame: length must be in (0, 1e6) m, got 0"));
    CHECK_THROWS_WITH(debug.line({}, {1, 0, 0}, {.width = 0.0}), Catch::Contains("width must be in [0.5, 100] px"));
    CHECK_THROWS_WITH(debug.line({}, {1, 0, 0}, {.color = {nan, 0, 0}}), Catch::Contains("color.red"));
    CHECK(debug.counts().vertices == 0);
}

} // namespace debug_draw_test
