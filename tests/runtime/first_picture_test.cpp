#include "filasofia/filasofia.h"

#include "filasofia/runtime/stepped_run.h"
#include "skip.h"

namespace first_picture_test {

using namespace filasofia;
using namespace filasofia::runtime;

namespace {

/// How bright the bodies of a picture are, [-] 0 to 255, by the luminance of Rec. 709.
struct Brightness {
    std::map<int, double> mean = {}; ///< by the body's number
    double all = 0.0;                ///< mean of all pixels that show a body
    double dark = 0.0;               ///< [-] share of these that are nearly black
};

Brightness brightnessOf(const visual::Image& image, const visual::DepthImage& depth)
{
    std::map<int, int> pixels;
    Brightness out;
    double count = 0.0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const int body = depth.label[static_cast<std::size_t>(y * image.width + x)];
            if (body <= 0) continue;
            const auto p = image.pixel(x, y);
            const double luminance = 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
            out.mean[body] += luminance;
            ++pixels[body];
            out.all += luminance;
            out.dark += luminance < 12.0 ? 1.0 : 0.0;
            ++count;
        }
    for (auto& [body, sum] : out.mean) sum /= pixels[body];
    out.all /= count;
    out.dark /= count;
    return out;
}

/// Tissue on a floor with a ball over it, as large as `size` [m], which nobody has said how to draw or to light.
Brightness pictureOf(double size)
{
    Simulation sim({.physics = {.gravity = {}}});
    const BodyId tissue =
        sim.add(SoftBodyDef{.name = "tissue", .mesh = shapes::block(size * Vec3{0.5, 0.3, 0.5}, {6, 4, 6})});
    const BodyId floor = sim.add(RigidBodyDef{
        .name = "floor", .elements = {{{0, -0.2 * size, 0}, {}}}, .mesh = shapes::box(size * Vec3{1.0, 0.05, 1.0})});
    const BodyId ball = sim.add(
        RigidBodyDef{.name = "ball", .elements = {{{0, 0.3 * size, 0}, {}}}, .mesh = shapes::sphere(0.1 * size)});
    for (const BodyId each : {tissue, floor, ball}) sim.show(each);
    SteppedRun run(sim);
    run.step();
    const PictureDef def{.width = 240, .height = 180};
    return brightnessOf(run.picture(def), run.depth(def));
}

/// A plate, as large as `size` [m], and a bar over it, of metal and seen from `direction`.
Brightness metalSeen(double size, Vec3 direction, double roughness)
{
    Simulation sim({.physics = {.gravity = {}}, .look = {.direction = direction}});
    const BodyId plate = sim.add(RigidBodyDef{.name = "plate", .mesh = shapes::box(size * Vec3{1.0, 0.02, 0.7})});
    const BodyId bar = sim.add(RigidBodyDef{.name = "bar",
                                            .elements = {{size * Vec3{0, 0.12, 0.1}, axisAngle({1, 0.3, 0}, 1.2)}},
                                            .mesh = shapes::capsule(0.04 * size, 0.5 * size)});
    for (const BodyId each : {plate, bar}) sim.show(each, {.material = MetalMaterial{.roughness = roughness}});
    SteppedRun run(sim);
    run.step();
    const PictureDef def{.width = 240, .height = 180};
    return brightnessOf(run.picture(def), run.depth(def));
}

} // namespace

TEST_CASE("metal reads as metal from every side and at any size, also a flat plate that mirrors nothing bright")
{
    if (skipIf(!visual::hasBackend(Backend::Headless), "this build draws nothing")) return;
    const std::vector<Vec3> sides{{0, 1, 0.001},  {0.2, 1, 0.7},   {0.25, 0.3, 1},
                                  {1, 0.15, 0.1}, {-0.6, 0.5, -1}, {0.2, -1, 0.4}};
    for (const double size : {5_mm, 50_mm, 1.0})
        for (const Vec3& side : sides) {
            INFO(size << " m from " << side.x << " " << side.y << " " << side.z);
            const Brightness seen = metalSeen(size, side, MetalMaterial{}.roughness);
            CHECK(seen.all > 60.0);
            CHECK(seen.all < 200.0);
            CHECK(seen.dark < 0.1);
        }
    // What is polished mirrors the dark, but never is it black.
    for (const Vec3& side : sides) CHECK(metalSeen(50_mm, side, 0.05).all > 40.0);
}

TEST_CASE("the first picture of a scene of any size shows its bodies, neither dark nor too bright")
{
    if (skipIf(!visual::hasBackend(Backend::Headless), "this build draws nothing")) return;
    for (const double size : {5_mm, 50_mm, 500_mm, 1.0}) {
        INFO(size << " m");
        const Brightness seen = pictureOf(size);
        REQUIRE(seen.mean.size() == 3);
        CHECK(seen.all > 80.0);
        CHECK(seen.all < 150.0);
        CHECK(seen.dark < 0.05);
        for (const auto& [body, mean] : seen.mean) {
            INFO("body " << body);
            CHECK(mean > 60.0);
            CHECK(mean < 200.0);
        }
    }
}

} // namespace first_picture_test
