#include "filasofia/engine/piercing/line.h"

#include "filasofia/geometry/shapes.h"

#include "engine/stage.h"

namespace line_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

/// A wavy line, whose points are apart by different distances.
std::vector<Vec3> wave()
{
    std::vector<Vec3> points;
    for (int i = 0; i < 40; ++i)
        points.push_back({1e-3 * i + 2e-4 * (i % 3), 4e-3 * std::sin(0.3 * i), 2e-3 * std::cos(0.4 * i)});
    return points;
}

physics::RigidBodyDef needleOf(const std::vector<Vec3>& line)
{
    physics::RigidBodyDef def{.elements = {Pose{{0.01, 0.02, -0.03}, axisAngle({1, 2, 3}, 0.7)}}};
    def.needle = physics::NeedleDef{.line = line};
    def.mesh = geometry::shapes::box({1e-3, 1e-3, 1e-3});
    def.collision = {{}};
    return def;
}

/// The place nearest to x by going through the whole line finely.
double bruteNearest(const LineShape& line, Vec3 x)
{
    double best = line.begin(), least = 1e300;
    constexpr int kSteps = 100000;
    for (int i = 0; i <= kSteps; ++i) {
        const double place = line.begin() + (line.end() - line.begin()) * i / kSteps;
        if (const double d = lengthSquared(line.position(place) - x); d < least) least = d, best = place;
    }
    return best;
}

} // namespace

TEST_CASE("places on a needle are distances behind its tip, wherever the body is")
{
    Stage stage;
    const auto points = wave();
    const BodyId id = stage.add(needleOf(points));
    stage.step(1e-3);
    const LineShape line(stage.world.scene(), {id});
    double along = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i > 0) along += length(points[i] - points[i - 1]);
        const Pose& pose = stage.world.scene().rigid[0].state.poses[0];
        CHECK(length(line.position(along) - transform(pose, points[i])) < 1e-15);
    }
    CHECK(line.begin() == 0.0);
    CHECK(line.end() == Approx(along));
    CHECK(length(line.forward(0.5 * along)) == Approx(1.0));
    CHECK(dot(line.forward(0.0), line.position(0.0) - line.position(1e-4)) > 0.0); // towards the tip
}

TEST_CASE("the nearest place on a line is that of a search through the whole line, and beyond the ends it goes on")
{
    Stage stage;
    const BodyId id = stage.add(needleOf(wave()));
    stage.step(1e-3);
    const LineShape line(stage.world.scene(), {id});
    std::mt19937 random(7);
    for (int i = 0; i < 100; ++i) {
        const double place = line.begin() + (0.01 + 0.98 * i / 99.0) * (line.end() - line.begin());
        const Vec3 x = line.position(place) + randomVec3(random, 5e-4);
        const double exact = bruteNearest(line, x), error = 2e-6;
        CHECK(line.nearest(x) == Approx(exact).margin(error));
        CHECK(line.nearest(x, place + 2e-3) == Approx(exact).margin(error)); // downhill from beside it
    }
    const Vec3 ahead = line.position(0.0) + 3e-3 * line.forward(0.0);
    CHECK(line.nearest(ahead, 0.0) == Approx(-3e-3));
    const Vec3 behind = line.position(line.end()) - 2e-3 * line.forward(line.end());
    CHECK(line.nearest(behind, line.end()) == Approx(line.end() + 2e-3));
}

TEST_CASE("a rod's places name its material, from either end, and its point moves with its nodes")
{
    Stage stage;
    physics::RodBodyDef def{.points = {{0, 0, 0}, {0.01, 0, 0}}, .spacing = 1e-3};
    const BodyId id = stage.add(def);
    stage.step(1e-3);
    Scene& scene = stage.world.scene();
    for (Vec3& x : scene.soft[0].state.x) x.x *= 1.5; // stretched: the same material
    for (std::size_t i = 0; i < scene.soft[0].state.v.size(); ++i) scene.soft[0].state.v[i] = {0, 0.1 * double(i), 0};
    const LineShape forth(scene, {id}), back(scene, {id, true, 0.5});
    CHECK(length(forth.position(2.5e-3) - scene.soft[0].state.x[2] - Vec3{0.75e-3, 0, 0}) < 1e-12);
    CHECK(back.begin() == 0.5);
    CHECK(length(back.position(0.5) - scene.soft[0].state.x[10]) < 1e-15);
    CHECK(back.nearest(scene.soft[0].state.x[7]) == Approx(0.503));
    const BodyPoint point = back.pointAt(0.5025, scene, {});
    CHECK(point.of == BodyPoint::Of::Soft);
    REQUIRE(point.count == 2);
    CHECK(point.velocity.y == Approx(0.75));
}

} // namespace line_test
