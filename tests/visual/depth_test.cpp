// Depth images against rays through the pixels, and what counts as seen.
#include "little_scene.h"
#include "organs.h"

#include "filasofia/core/error.h"
#include "filasofia/visual/depth_views.h"

#include "skip.h"

#include <optional>

namespace depth_test {

using namespace filasofia;
using namespace filasofia::visual;
using Catch::Contains;

namespace {

struct Seen {
    double depth = std::numeric_limits<double>::infinity();
    std::uint32_t label = 0;
};

/// What the ray through a place of the picture meets first, by testing every triangle (Moeller and Trumbore, "Fast,
/// minimum storage ray-triangle intersection", 1997).
Seen cast(const VisualServer& server, const Pose& eye, const CameraDef& lens, double column, double row, int width,
          int height, const std::vector<std::uint32_t>& labels)
{
    const double half = std::tan(0.5 * lens.verticalFieldOfView);
    const Vec3 ray{(2.0 * column / width - 1.0) * half * width / height, (1.0 - 2.0 * row / height) * half, -1.0};
    Seen seen;
    const auto bodies = server.bodies();
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        if (!bodies[i]->worldVisible()) continue;
        const auto place = [&](int vertex) {
            return transform(inverse(eye),
                             transform(bodies[i]->worldPose(), bodies[i]->vertices()[std::size_t(vertex)]));
        };
        for (const geometry::Triangle& triangle : bodies[i]->triangles()) {
            const Vec3 a = place(triangle[0]), ab = place(triangle[1]) - a, ac = place(triangle[2]) - a;
            const Vec3 p = cross(ray, ac);
            const double volume = dot(ab, p);
            if (std::abs(volume) < 1e-18) continue;
            const double u = dot(-a, p) / volume, v = dot(ray, cross(-a, ab)) / volume;
            const double depth = dot(ac, cross(-a, ab)) / volume;
            if (u < 0.0 || v < 0.0 || u + v > 1.0 || depth < lens.near || depth >= seen.depth) continue;
            seen = {depth, labels[i]};
        }
    }
    return seen;
}

/// Two balls of which one covers part of the other, before a wall without a label, and a hidden ball.
struct Balls {
    LittleScene scene;
    std::vector<std::uint32_t> labels{0, 7, 9, 0, 11}; ///< the first is the little scene's own

    Balls()
    {
        lookFromFront(scene);
        scene.body.setVisible(false);
        const auto add = [&](double radius, const Vec3& place, int label) -> VisualBody& {
            VisualBodyDef def = sphereDef(radius, 3);
            def.label = label;
            VisualBody& ball = scene.server.add(def);
            ball.setPose({place, {}});
            return ball;
        };
        add(0.05, {0.03, 0.02, 0.0}, 7);
        add(0.02, {-0.01, 0.0, 0.1}, 9);
        VisualBody& wall =
            scene.server.add({.name = "wall", .mesh = screen(0.3, 0.2), .material = UnlitMaterial{}, .label = 0});
        wall.setPose({{-0.1, 0.0, -0.1}, {}});
        add(0.02, {-0.05, 0.0, 0.1}, 11).setVisible(false);
    }
};

} // namespace

TEST_CASE("depth and label of every pixel are those of the ray through its centre")
{
    if (skipIf(!hasBackend(Backend::Headless), "this build draws nothing")) return;
    Balls balls;
    VisualServer& server = balls.scene.server;
    const DepthImage image = server.captureDepth();
    REQUIRE((image.width == 320 && image.height == 240));
    const CameraDef lens = balls.scene.look.camera->def();
    const Pose eye = balls.scene.look.camera->worldPose();
    int compared = 0, nothing = 0;
    for (int y = 0; y < image.height; y += 2)
        for (int x = 0; x < image.width; x += 2) {
            const auto at = [&](double dx, double dy) {
                return cast(server, eye, lens, x + 0.5 + dx, y + 0.5 + dy, 320, 240, balls.labels);
            };
            const Seen seen = at(0, 0);
            bool onEdge = false; // where rounding decides
            double slope = 0.0;  // [m] within 0.02 pixels: the rasteriser places corners to 1/256
            for (double d : {-0.02, 0.02})
                for (const Seen& near : {at(d, 0), at(0, d)}) {
                    onEdge = onEdge || near.label != seen.label || std::isinf(near.depth) != std::isinf(seen.depth);
                    if (!onEdge && std::isfinite(seen.depth))
                        slope = std::max(slope, std::abs(near.depth - seen.depth));
                }
            if (onEdge) continue;
            const std::size_t i = std::size_t(y) * 320 + std::size_t(x);
            INFO("pixel " << x << ", " << y);
            REQUIRE(image.label[i] == seen.label);
            REQUIRE(std::isinf(image.depth[i]) == std::isinf(seen.depth));
            if (std::isinf(seen.depth)) {
                REQUIRE(image.depth[i] == DepthImage::kNothing);
                ++nothing;
            } else {
                REQUIRE(image.depth[i] == Approx(seen.depth).epsilon(1e-6).margin(slope));
            }
            ++compared;
        }
    CHECK(compared > 19000); // out of 19,200
    CHECK(nothing > 1000);
    CHECK(server.captureDepth() == image);
}

TEST_CASE("a depth image leaves the picture as it was, and effects leave the depth")
{
    if (skipIf(!hasBackend(Backend::Headless), "this build draws nothing")) return;
    Balls balls;
    VisualServer& server = balls.scene.server;
    const Image before = server.capture();
    const DepthImage depth = server.captureDepth();
    CHECK(server.capture() == before);
    server.debug().line({-0.1, 0, 0.2}, {0.1, 0, 0.2}, {.width = 9});
    balls.scene.look.light->setVisible(false);
    ViewDef def = balls.scene.look.view->def();
    def.effects = effectsOf(Quality::High);
    def.effects->fog = Fog{};
    balls.scene.look.view->set(def);
    CHECK(server.capture() != before);
    CHECK(server.captureDepth() == depth);
}

TEST_CASE("through endoscope optics depth moves as the colours do")
{
    if (skipIf(!hasBackend(Backend::Headless), "this build draws nothing")) return;
    Balls balls;
    VisualServer& server = balls.scene.server;
    for (VisualBody* body : server.bodies()) { // flat colours by label, so that the picture tells the body
        const bool near = body->worldPose().position.z > 0.05;
        body->setMaterial(UnlitMaterial{.color = {near ? 0.9 : 0.1, 0.1, near ? 0.1 : 0.9}});
    }
    server.setEnvironment({.background = {0, 0, 0}});
    ViewDef def = balls.scene.look.view->def();
    def.effects = effectsOf(Quality::Low);
    def.effects->endoscope = EndoscopeOptics{.maskSoftness = 0.0, .distortion = 0.6, .vignette = 0.0, .rimBlur = 0.0};
    balls.scene.look.view->set(def);
    const Image colours = server.capture();
    const DepthImage depth = server.captureDepth();
    int wrong = 0, seen = 0;
    for (int y = 0; y < 240; ++y)
        for (int x = 0; x < 320; ++x) {
            const std::size_t i = std::size_t(y) * 320 + std::size_t(x);
            const auto pixel = colours.pixel(x, y);
            const bool red = pixel[0] > 150, any = red || pixel[2] > 150;
            wrong += red != (depth.label[i] == 9) || any != std::isfinite(depth.depth[i]);
            seen += any;
        }
    CHECK(seen > 10000);
    CHECK(wrong < 600);         // the pixels along the edges, whose colours are blends
    CHECK(depth.label[0] == 0); // outside the round field
    CHECK(depth.depth[0] == DepthImage::kNothing);
}

TEST_CASE("a window's depth is that of its views, an off-screen view has its own")
{
    if (skipIf(!hasBackend(Backend::Headless), "this build draws nothing")) return;
    Balls balls;
    VisualServer& server = balls.scene.server;
    Camera& camera = *balls.scene.look.camera;
    ViewDef half = balls.scene.look.view->def();
    half.viewport = {.left = 0.5, .top = 0.5, .width = 0.5, .height = 0.5};
    balls.scene.look.view->set(half);
    View& own = server.add({.name = "own", .target = OffScreen{160, 120}}, camera);
    const DepthImage small = own.captureDepth();
    REQUIRE((small.width == 160 && small.height == 120));
    DepthImage expected = emptyDepth(320, 240);
    place(small, 160, 120, expected);
    CHECK(server.captureDepth() == expected);
    CHECK_THROWS_WITH(balls.scene.look.view->captureDepth(), Contains("use VisualServer::captureDepth()"));
    balls.scene.look.view->setVisible(false);
    CHECK(server.captureDepth() == emptyDepth(320, 240));
}

TEST_CASE("a sheet is seen from behind if its material shows it from there")
{
    if (skipIf(!hasBackend(Backend::Headless), "this build draws nothing")) return;
    for (const Material& material : {Material{TissueMaterial{}}, Material{MetalMaterial{}}}) {
        LittleScene scene;
        lookFromFront(scene);
        scene.body.setVisible(false);
        VisualBody& sheet =
            scene.server.add({.name = "sheet", .mesh = screen(0.1, 0.1), .material = material, .label = 3});
        sheet.setPose({{}, axisAngle({0, 1, 0}, std::numbers::pi)});
        scene.server.setEnvironment({.background = {0, 0, 0}});
        const bool shown = brightnessAt(scene.server.capture(), 160, 120) > 5;
        CHECK(shown == std::holds_alternative<TissueMaterial>(material));
        CHECK((scene.server.captureDepth().label[120 * 320 + 160] == 3) == shown);
    }
}

TEST_CASE("labels have a range, and without a picture nothing is seen")
{
    LittleScene scene(Backend::Null);
    VisualBodyDef def = sphereDef();
    for (int wrong : {-1, 16777216}) {
        def.label = wrong;
        CHECK_THROWS_WITH(scene.server.add(def), Contains("label") && Contains("[0, 16777215]"));
    }
    CHECK(scene.server.captureDepth() == emptyDepth(320, 240));
    View& own = scene.server.add({.name = "own", .target = OffScreen{8, 6}}, *scene.look.camera);
    CHECK(own.captureDepth() == emptyDepth(8, 6));
}

TEST_CASE("the lens without distortion only takes the corners away")
{
    DepthImage image = emptyDepth(9, 5);
    for (std::size_t i = 0; i < image.depth.size(); ++i) {
        image.depth[i] = static_cast<float>(i + 1);
        image.label[i] = static_cast<std::uint32_t>(i);
    }
    CHECK(throughLens(image, {.maskRadius = 2.0, .distortion = 0.0}).label[22] == 22);
    const DepthImage round = throughLens(image, {.maskRadius = 1.0, .distortion = 0.0});
    for (int y = 0; y < 5; ++y)
        for (int x = 0; x < 9; ++x) {
            const std::size_t i = std::size_t(y) * 9 + std::size_t(x);
            const bool inside = (x - 4) * (x - 4) + (y - 2) * (y - 2) < 6.25;
            CHECK(round.label[i] == (inside ? image.label[i] : 0));
            CHECK(round.depth[i] == (inside ? image.depth[i] : DepthImage::kNothing));
        }
}

} // namespace depth_test
