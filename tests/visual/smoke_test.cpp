#include "little_scene.h"

#include "filasofia/core/error.h"
#include "filasofia/geometry/shapes.h"

namespace smoke_test {

using namespace filasofia;
using namespace filasofia::visual;

namespace {

/// A plain wall at z = 0 under light from the front alone, seen straight from z = 0.1.
struct Wall {
    static constexpr double kLux = 12000.0;
    explicit Wall(double share = 1.0)
    {
        server.setEnvironment({.intensity = 0.0});
        VisualBodyDef wall{.name = "wall"};
        wall.mesh = *geometry::shapes::sheet(0.4, 0.4, {2, 2});
        wall.material = BoneMaterial{};
        server.add(wall).setPose({{}, axisAngle({1, 0, 0}, std::numbers::pi / 2)});
        camera = &server.add(CameraDef{.near = 0.002});
        camera->setPose({{0, 0, 0.1}, {}});
        server.add(LightDef{.kind = DirectionalLight{kLux * share}, .castShadows = false});
        server.add(ViewDef{.quality = Quality::Low}, *camera);
    }
    /// Mean of the channels in the middle of the picture.
    double middle()
    {
        const Image image = server.capture();
        double sum = 0.0;
        for (int y = 58; y < 62; ++y)
            for (int x = 78; x < 82; ++x)
                for (int c = 0; c < 3; ++c) sum += image.pixel(x, y)[std::size_t(c)];
        return sum / 48.0;
    }
    VisualServer server{{.width = 160, .height = 120}};
    Camera* camera = nullptr;
};

Smoke black(std::vector<SmokePuff> puffs, double haze = 0.0)
{
    return {.puffs = std::move(puffs),
            .haze = haze,
            .room = {{-1, -1, -1}, {1, 1, 0.05}},
            .color = {0, 0, 0},
            .wisps = 0.0};
}

} // namespace

TEST_CASE("black smoke takes as much of the light as Beer and Lambert say")
{
    const auto expected = [](double depth) { return Wall(std::exp(-depth)).middle(); };
    const auto seen = [](const Smoke& smoke) {
        Wall wall;
        wall.server.setSmoke(smoke);
        return wall.middle();
    };
    const double clear = expected(0.0);
    REQUIRE(clear > 120.0);
    REQUIRE(expected(1.0) < 0.8 * clear);
    for (const double depth : {0.3, 1.0, 2.0}) {
        INFO("depth " << depth);
        const double by = 0.02 * clear;
        CHECK(seen(black({}, depth / 0.05)) == Approx(expected(depth)).margin(by)); // 5 cm of haze before the wall
        CHECK(seen(black({{.place = {0, 0, 0.03}, .radius = 0.006, .depth = depth}})) ==
              Approx(expected(depth)).margin(by));
        CHECK(seen(black({{.place = {0, 0, 0}, .radius = 0.006, .depth = 2.0 * depth}})) ==
              Approx(expected(depth)).margin(by)); // half of it is behind the wall
        CHECK(seen(black({{.place = {0, 0, 0.1}, .radius = 0.02, .depth = 2.0 * depth}})) ==
              Approx(expected(depth)).margin(by)); // the camera is in its middle
        CHECK(seen(black({{.place = {0, 0, 0.03}, .radius = 0.005, .depth = 0.5 * depth},
                          {.place = {0, 0, 0.06}, .radius = 0.01, .depth = 0.5 * depth}})) ==
              Approx(expected(depth)).margin(by));
    }
    CHECK(seen(black({{.place = {0, 0, 0.15}, .radius = 0.005, .depth = 5.0}})) == Approx(clear)); // behind the camera
    CHECK(seen(black({{.place = {0, 0, -0.05}, .radius = 0.005, .depth = 5.0}})) ==
          Approx(clear).margin(0.1)); // behind the wall
}

TEST_CASE("white smoke is lit by the scene's lights")
{
    Smoke smoke = black({{.place = {0, 0, 0.02}, .radius = 0.008, .depth = 6.0}});
    const auto seen = [&](double share) {
        Wall wall(share);
        wall.server.setSmoke(smoke);
        return wall.middle();
    };
    const double dark = seen(1.0);
    smoke.color = {0.95, 0.95, 0.95};
    CHECK(dark < 10.0);
    CHECK(seen(1.0) > 120.0);
    CHECK(seen(0.2) < 0.8 * seen(1.0));
    CHECK(seen(0.2) > 2.0 * dark);
}

TEST_CASE("smoke takes light of a lamp outside its room only within the room")
{
    // A lamp four times as far and sixteen times as bright lights the room alike.
    const auto seen = [](double far, bool haze) {
        Wall wall(1e-6);
        Smoke smoke = haze ? black({}, 30.0) : black({{.place = {0, 0, 0.03}, .radius = 0.008, .depth = 3.0}}, 10.0);
        smoke.room = {{-0.03, -0.03, 0.005}, {0.03, 0.03, 0.06}};
        smoke.color = {0.95, 0.95, 0.95};
        wall.server.setSmoke(smoke);
        wall.server.add(LightDef{.kind = PointLight{20000.0 * far * far, 100.0}}).setPose({{0, far, 0.1}, {}});
        return wall.middle();
    };
    for (const bool haze : {false, true}) {
        INFO(haze);
        CHECK(seen(0.5, haze) > 20.0);
        CHECK(seen(2.0, haze) == Approx(seen(0.5, haze)).epsilon(0.1));
    }
}

TEST_CASE("haze has the colour of its lights, and its own")
{
    const auto seen = [](Color light, Color own, const EnvironmentDef& around) {
        Wall wall(1e-6);
        wall.server.setEnvironment(around);
        Smoke smoke = black({}, 30.0);
        smoke.room = {{-1, -1, 0.005}, {1, 1, 1}};
        smoke.color = own;
        wall.server.setSmoke(smoke);
        wall.server.add(LightDef{.kind = PointLight{400.0, 100.0}, .color = light}).setPose({{0, 0.1, 0.1}, {}});
        const Image image = wall.server.capture();
        return image.pixel(80, 60);
    };
    const Color white{0.95, 0.95, 0.95}, red{1.0, 0.1, 0.1};
    const auto grey = seen({1, 1, 1}, white, {.intensity = 0.0});
    CHECK(grey[0] > 60);
    CHECK(std::abs(grey[0] - grey[2]) < 0.15 * grey[0]);
    for (const auto& each :
         {seen(red, white, {.intensity = 0.0}), seen({1, 1, 1}, red, {.intensity = 0.0}),
          seen({1e-6, 1e-6, 1e-6}, white, {.intensity = 3000.0, .above = red, .below = red, .lampStrength = 0.0})}) {
        CHECK(each[0] > 60);
        CHECK(each[0] > 2 * each[2]);
    }
}

TEST_CASE("smoke has no edge where it meets a surface")
{
    Wall wall;
    const Image clear = wall.server.capture();
    Smoke smoke = black({{.place = {0.002, 0, 0.001}, .radius = 0.008, .depth = 3.0}});
    wall.server.setSmoke(smoke);
    const Image image = wall.server.capture();
    int steepest = 0, strongest = 0;
    for (int x = 1; x < 160; ++x) {
        const auto taken = [&](int at) { return clear.pixel(at, 60)[0] - image.pixel(at, 60)[0]; };
        steepest = std::max(steepest, std::abs(taken(x) - taken(x - 1)));
        strongest = std::max(strongest, taken(x));
    }
    CHECK(strongest > 60);
    CHECK(steepest < strongest / 4);
}

TEST_CASE("wisps are uneven, and take as much light in all as even smoke")
{
    Wall wall;
    const Image clear = wall.server.capture();
    /// What is taken from all pixels, and how far single ones are from `other`.
    const auto taken = [&](double wisps, double pattern, const Image* other, double& apart) {
        Smoke smoke = black({{.place = {0, 0, 0.01}, .radius = 0.008, .depth = 0.15, .pattern = pattern}});
        smoke.wisps = wisps;
        wall.server.setSmoke(smoke);
        const Image image = wall.server.capture();
        double sum = 0.0;
        for (int y = 0; y < 120; ++y)
            for (int x = 0; x < 160; ++x) {
                sum += clear.pixel(x, y)[1] - image.pixel(x, y)[1];
                if (other) apart += std::abs(image.pixel(x, y)[1] - other->pixel(x, y)[1]);
            }
        return sum;
    };
    double none = 0.0, apart = 0.0, sum = 0.0;
    const double even = taken(0.0, 0.0, nullptr, none);
    const Image plain = wall.server.capture();
    for (int pattern = 1; pattern <= 16; ++pattern) sum += taken(1.0, pattern, &plain, apart) / 16.0;
    CHECK(apart / 16.0 > 0.2 * even);
    CHECK(sum == Approx(even).epsilon(0.1));
}

TEST_CASE("without smoke the picture is as if there had never been any, and the same smoke is the same picture")
{
    Wall wall, other;
    const Image clear = wall.server.capture();
    const Smoke smoke{.puffs = {{.place = {0, 0, 0.03}, .radius = 0.01, .depth = 1.0}},
                      .haze = 2.0,
                      .room = {{-1, -1, -1}, {1, 1, 1}}};
    wall.server.setSmoke(smoke);
    const Image smoky = wall.server.capture();
    CHECK(smoky != clear);
    other.server.setSmoke(smoke);
    CHECK(other.server.capture() == smoky);
    wall.server.setSmoke({});
    CHECK(wall.server.capture() == clear);
}

TEST_CASE("wrong smoke is an Error")
{
    using Catch::Contains;
    VisualServer server({.backend = Backend::Null});
    CHECK_THROWS_WITH(server.setSmoke({.haze = -1.0}), Contains("smoke: haze must be in [0, 1000000] 1/m, got -1"));
    CHECK_THROWS_WITH(server.setSmoke({.puffs = {{.radius = 0.0}}}), Contains("smoke: puffs[0].radius"));
    CHECK_THROWS_WITH(server.setSmoke({.puffs = std::vector<SmokePuff>(257)}), Contains("at most 256 puffs, got 257"));
    CHECK_THROWS_WITH(server.setSmoke({.room = geometry::Box{}}), Contains("smoke: room"));
}

} // namespace smoke_test
