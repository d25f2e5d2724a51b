#include "filasofia/filasofia.h"

#include "filasofia/runtime/stepped_run.h"
#include "skip.h"

#include <numbers>

namespace burn_picture_test {

using namespace filasofia;
using namespace filasofia::runtime;

namespace {

constexpr double kUp = 0.09, kHalf = 0.3; ///< [m] the camera's height over the surface, [rad] half its angle

struct Burn {
    double area = 0.0;    ///< [m^2], that looks other than before
    double largest = 0.0; ///< [m], the largest radius towards 16 sides
    double least = 0.0;
    double burnt = 0.0;    ///< [m^2], says the physics
    double farthest = 0.0; ///< [m], from the middle, of what has changed
};

/// A slab is heated within 6 mm of a place beside its middle, and looked at from above.
Burn burnOf(std::array<int, 3> cells, int subdivision, double power)
{
    // Lit as for a picture of the box around it: how much of a burn is seen depends on the light.
    Simulation sim({.physics = {.rate = 200, .gravity = {}},
                    .look = {.around = Box{{-30_mm, -5_mm, -20_mm}, {30_mm, 5_mm, 20_mm}}}});
    const BodyId slab = sim.add(SoftBodyDef{.name = "slab",
                                            .mesh = shapes::block({60_mm, 10_mm, 40_mm}, cells),
                                            .attachments = {{.box = Box{{-1, -1, -1}, {1, -4.9_mm, 1}}}}});
    const Vec3 middle{1_mm, 5_mm, 0.6_mm};
    sim.burn(slab, {.depth = 1_mm});
    sim.show(slab, {.subdivision = subdivision, .material = visual::plainMaterial({0.6, 0.2, 0.2})});
    SteppedRun run(sim);
    const PictureDef def{.width = 240,
                         .height = 240,
                         .pose = visual::lookAt(middle + Vec3{0, kUp, 1e-6}, middle),
                         .camera = CameraDef{.verticalFieldOfView = 2.0 * kHalf, .near = 0.005, .far = 1.0}};
    run.step();
    const visual::Image before = run.picture(def);
    sim.treat(slab, Heat{.place = middle, .radius = 6_mm, .power = power});
    for (int i = 0; i < 400; ++i) run.step();
    sim.treat(slab, Heat{.power = 0.0});
    for (int i = 0; i < 20; ++i) run.step();
    const visual::Image after = run.picture(def);
    visual::savePng(after, text(FILASOFIA_BINARY_DIR "/burn_", cells[0], "_", subdivision, "_", power, ".png"));

    Burn out;
    out.burnt = sim.heat(slab).burnt;
    const double pixel = 2.0 * kUp * std::tan(kHalf) / 240; // [m]
    std::array<double, 16> radius{};
    for (int y = 0; y < 240; ++y)
        for (int x = 0; x < 240; ++x) {
            const auto was = before.pixel(x, y), is = after.pixel(x, y);
            const int changed =
                std::max({std::abs(was[0] - is[0]), std::abs(was[1] - is[1]), std::abs(was[2] - is[2])});
            if (changed < 20) continue;
            const double right = (x - 119.5) * pixel, down = (y - 119.5) * pixel, away = std::hypot(right, down);
            out.area += pixel * pixel;
            out.farthest = std::max(out.farthest, away);
            const auto side = static_cast<std::size_t>((std::atan2(down, right) / std::numbers::pi + 1.0) * 8.0) % 16;
            radius[side] = std::max(radius[side], away);
        }
    out.largest = std::ranges::max(radius);
    out.least = std::ranges::min(radius);
    return out;
}

} // namespace

TEST_CASE("a burn looks round and as large as it is, also where triangles are nearly as large as it")
{
    if (skipIf(!visual::hasBackend(Backend::Headless), "this build draws nothing")) return;
    for (const double power : {14.0, 60.0}) // blanched, and charred
        for (const int subdivision : {0, 1}) {
            const double edge = 4_mm;
            const Burn burn = burnOf({15, 2, 10}, subdivision, power);
            INFO(power << " W, subdivision " << subdivision << ": radii " << 1e3 * burn.least << " to "
                       << 1e3 * burn.largest << " mm, " << 1e6 * burn.area << " mm^2 of " << 1e6 * burn.burnt);
            REQUIRE(burn.burnt > 0.0);
            CHECK(burn.largest < 1.4 * burn.least);
            CHECK(burn.area > 0.65 * burn.burnt);
            CHECK(burn.area < 1.35 * burn.burnt);
            CHECK(burn.farthest < 6_mm + edge); // nothing is burnt farther than an element from what was heated
        }
}

} // namespace burn_picture_test
