#include "engine/collision/scene.h"

#include "filasofia/core/units.h"

#include <map>
#include <numbers>
#include <set>

namespace filasofia::engine::contacts_test {
namespace {

constexpr CollisionOptions kPlain{.proximity = 0.5e-3};

int onSide(const Proximity& p, int side)
{
    return static_cast<int>(std::ranges::count_if(p.vertices[side], [](int v) { return v >= 0; }));
}

} // namespace

TEST_CASE("a box on a plane has upright contacts at its corners and at the vertices under it, and no others")
{
    struct Place {
        double x, y, turn;
        const char* what;
    };
    const Place places[] = {{0.003, -0.002, 0.0, "beside the grid's lines"},
                            {0.0, 0.0, 0.0, "corners over vertices of the grid"},
                            {0.0, 0.005, 0.0, "corners over lines of the grid"},
                            {0.001, 0.002, 0.7, "turned"}};
    for (const bool sheet : {true, false})
        for (const Place& at : places) {
            CAPTURE(sheet, at.what);
            Scene scene;
            const double half = 0.02;
            const geometry::TriangleMesh ground = sheet ? sheetMesh(0.1, 10) : boxMesh({0.1, 0.1, 0.03}, 10);
            scene.add(ground, kPlain, {{0, 0, sheet ? 0.0 : -0.03}, {}});
            const Pose pose{{at.x, at.y, half + 1e-4}, axisAngle({0, 0, 1}, at.turn)};
            scene.add(boxMesh({half, half, half}), kPlain, pose);
            int under = 0;
            for (const Vec3 p : scene.surfaces[0].x) {
                const Vec3 local = transform(inverse(pose), p);
                under += std::fabs(local.x) < half - 1e-9 && std::fabs(local.y) < half - 1e-9 && p.z > -1e-9;
            }
            REQUIRE(under >= 1);
            scene.find();
            // A corner over a vertex of the grid is one contact, found once.
            std::set<std::array<long, 2>> where;
            for (const Proximity& p : scene.found) {
                CHECK(p.gap == Approx(1e-4).epsilon(1e-9));
                CHECK(distance(p.normal, {0, 0, -1}) < 1e-9);
                const Vec3 x = scene.place(p, 1);
                where.insert({std::lround(x.x * 1e8), std::lround(x.y * 1e8)});
            }
            // If the box's edges lie along vertices of the grid, these are near a face, an edge or both, and are found
            // once.
            CHECK(where.size() == scene.found.size());
            const auto corners = std::ranges::count_if(scene.found, [](const Proximity& p) {
                return p.vertices[1][1] < 0; // the box's side is a vertex
            });
            CHECK(corners == 4);
            const auto inside = std::ranges::count_if(scene.found, [&](const Proximity& p) {
                const Vec3 local = transform(inverse(pose), scene.place(p, 1));
                return std::fabs(local.x) < half - 1e-9 && std::fabs(local.y) < half - 1e-9;
            });
            CHECK(inside == under);
        }
}

TEST_CASE("a box that slides level over a plane does not catch on the vertices ahead of it")
{
    Scene scene;
    scene.add(sheetMesh(0.1, 10), kPlain);
    // Its front, at 19.9 mm, is a tenth of a millimetre before a row of the grid and crosses it in this step.
    scene.add(boxMesh({0.01, 0.03, 0.01}), kPlain, {{0.0099, 0, 0.01 + 1e-5}, {}}, {1, 0, 0});
    scene.find();
    REQUIRE(scene.found.size() >= 4);
    for (const Proximity& p : scene.found) CHECK(distance(p.normal, {0, 0, -1}) < 1e-9);
}

TEST_CASE("an edge rounded by its inset does not catch on the vertices ahead of it")
{
    // The surfaces are two insets of a fifth of a millimetre apart, and nearer to a row of the grid than that: 30
    // degrees and less.
    for (const double before : {0.02e-3, 0.1e-3, 0.2e-3}) {
        Scene scene;
        scene.add(sheetMesh(0.1, 10), kPlain);
        scene.add(boxMesh({0.01, 0.03, 0.01}), kPlain, {{0.01 - before, 0, 0.01 + 0.4e-3}, {}}, {1, 0, 0});
        scene.find();
        REQUIRE(scene.found.size() >= 4);
        for (const Proximity& p : scene.found) CHECK(distance(p.normal, {0, 0, -1}) < 1e-9);
    }
}

TEST_CASE("edges that cross are one contact, before and after they have passed each other")
{
    // Two roofs, one upside down over the other and rotated by a right angle: their ridges cross.
    const geometry::TriangleMesh box = boxMesh({0.05, 0.01, 0.01});
    const Quat onEdge = axisAngle({1, 0, 0}, std::numbers::pi / 4);
    const double ridge = 0.01 * std::sqrt(2.0);
    for (const double gap : {3e-4, 1e-9, 0.0, -1e-9, -3e-4, -0.9e-3}) {
        CAPTURE(gap);
        Scene scene;
        scene.add(box, kPlain, {{0, 0, -ridge}, onEdge});
        scene.add(box, kPlain, {{0.001, 0.002, ridge + gap}, axisAngle({0, 0, 1}, std::numbers::pi / 2) * onEdge});
        scene.find();
        REQUIRE(scene.found.size() == 1);
        const Proximity& p = scene.found[0];
        CHECK(onSide(p, 0) == 2);
        CHECK(onSide(p, 1) == 2);
        CHECK(p.gap == Approx(gap).margin(1e-12));
        CHECK(distance(p.normal, {0, 0, -1}) < 1e-9);
        CHECK(distance(scene.place(p, 0), {0.001, 0, 0}) < 1e-9);
    }
}

TEST_CASE("edges on the far sides of two thin plates make no contact")
{
    Scene scene;
    scene.add(boxMesh({0.05, 0.02, 0.0001}), kPlain, {{0, 0, 0}, axisAngle({0, 0, 1}, 0.3)});
    scene.add(boxMesh({0.05, 0.02, 0.0001}), kPlain, {{0, 0, 0.0005}, axisAngle({0, 0, 1}, 1.4)});
    // The plates cross: each of two edges crosses each of two, and no corner lies over a face.
    REQUIRE(scene.find().size() == 4);
    for (const Proximity& p : scene.found) {
        CHECK(p.gap == Approx(3e-4));
        CHECK(distance(p.normal, {0, 0, -1}) < 1e-9);
    }
}

TEST_CASE("a point inside near a convex edge is pushed out through the nearer face only")
{
    for (const double depth : {1e-5, 3e-4, 8e-4}) {
        CAPTURE(depth);
        Scene scene;
        scene.add(boxMesh({0.02, 0.02, 0.02}, 3), kPlain);
        geometry::TriangleMesh point;
        point.vertices = {{0.02 - 0.9e-3, 0.0011, 0.02 - depth}};
        scene.add(point, kPlain);
        scene.find();
        REQUIRE(scene.found.size() == 1);
        CHECK(scene.found[0].gap == Approx(-depth));
        CHECK(distance(scene.found[0].normal, {0, 0, -1}) < 1e-12);
    }
}

TEST_CASE("the distance at a sharp edge is positive wherever the point is outside")
{
    // A wedge of 10 degrees. The point is behind the plane of one face, before the other one, and outside.
    geometry::TriangleMesh wedge;
    const double t = std::tan(5_deg);
    wedge.vertices = {{0, -0.02, 0},
                      {0, 0.02, 0},
                      {-0.02, -0.02, 0.02 * t},
                      {-0.02, 0.02, 0.02 * t},
                      {-0.02, -0.02, -0.02 * t},
                      {-0.02, 0.02, -0.02 * t}};
    wedge.triangles = {{0, 1, 3}, {0, 3, 2}, {0, 5, 1}, {0, 4, 5}, {2, 3, 5}, {2, 5, 4}, {0, 2, 4}, {1, 5, 3}};
    REQUIRE(makeCollisionShape(wedge, kPlain).closed);
    for (int i = 0; i < 16; ++i) {
        const double angle = (i / 7.5 - 1.0) * 170_deg;
        CAPTURE(angle);
        Scene scene;
        scene.add(wedge, kPlain);
        geometry::TriangleMesh point;
        point.vertices = {{4e-4 * std::cos(angle), 0.003, 4e-4 * std::sin(angle)}};
        scene.add(point, kPlain);
        scene.find();
        REQUIRE(scene.found.size() == 1);
        // From 85 degrees on, a face is nearer than the edge.
        const double share = std::fabs(angle) < 85_deg ? 1.0 : std::sin(175_deg - std::fabs(angle));
        CHECK(scene.found[0].gap == Approx(4e-4 * share));
    }
}

TEST_CASE("a point near a thin plate touches only the near wall")
{
    // The plate is half a millimetre thick, and points are followed up to two millimetres inside.
    for (const double height : {4.5e-4, 3e-4, 2e-4, -2e-4, -3e-4, -4.5e-4}) {
        CAPTURE(height);
        Scene scene;
        scene.add(boxMesh({0.02, 0.02, 0.25e-3}, 4), kPlain);
        geometry::TriangleMesh point;
        point.vertices = {{0.0011, 0.0023, height}};
        scene.add(point, kPlain);
        scene.find();
        REQUIRE(scene.found.size() == 1);
        CHECK(scene.found[0].gap == Approx(std::fabs(height) - 0.25e-3).margin(1e-12));
        CHECK(scene.found[0].normal.z == (height > 0 ? -1.0 : 1.0));
    }
}

TEST_CASE("a body that approaches at 1 m/s is found before it arrives, and one that flies past is not")
{
    Scene scene;
    scene.add(boxMesh({0.02, 0.02, 0.02}), kPlain);
    const int ball = scene.add(boxMesh({0.005, 0.005, 0.005}), kPlain, {{0.001, 0.002, 0.0274}, {}});
    const auto withVelocity = [&](Vec3 v) {
        scene.surfaces[static_cast<std::size_t>(ball)].v.assign(8, v);
        return scene.find().size();
    };
    // They are 2.4 mm apart: both proximities are 1 mm, and a step and a half at 1 m/s is 1.5 mm.
    CHECK(withVelocity({0, 0, -1.0}) == 4);
    CHECK(withVelocity({0.3, 0, -1.0}) == 4);
    CHECK(withVelocity({0, 0, -0.9}) == 0);
    CHECK(withVelocity({1, 1, 0}) == 0);
    CHECK(withVelocity({0, 0, 1}) == 0);
    CHECK(withVelocity({0, 0, 0}) == 0);
}

TEST_CASE("a contact keeps its number while the touching features stay the same")
{
    Scene scene;
    std::mt19937 random(3);
    scene.add(lumpMesh(0.03, 12, 0.05, random), {.proximity = 1e-3, .depth = 2e-3});
    scene.add(lumpMesh(0.03, 12, 0.05, random), {.proximity = 1e-3, .depth = 2e-3}, {{0.055, 0, 0.004}, {}});
    std::map<std::uint64_t, Proximity> before;
    for (const Proximity& p : scene.find()) before[p.feature] = p;
    REQUIRE(before.size() > 8);
    scene.move(1, {1e-7, -1e-7, 1e-7});
    std::size_t again = 0;
    for (const Proximity& p : scene.find()) {
        const auto it = before.find(p.feature);
        if (it == before.end()) continue;
        ++again;
        CHECK(it->second.vertices == p.vertices);
        CHECK(distance(it->second.normal, p.normal) < 1e-2);
        CHECK(std::fabs(it->second.gap - p.gap) < 1e-6);
    }
    CHECK(again + 1 >= before.size());
}

TEST_CASE("a needle of segments touches by points on faces and segments across edges, and is pushed out if inside")
{
    geometry::TriangleMesh needle;
    for (int i = 0; i <= 8; ++i) needle.vertices.push_back({-0.04 + 0.01 * i, 0.001, 0.0});
    CollisionOptions options{.proximity = 0.5e-3};
    for (int i = 0; i < 8; ++i) options.segments.push_back({i, i + 1});
    for (const double gap : {2e-4, -2e-4}) {
        CAPTURE(gap);
        Scene scene;
        scene.add(boxMesh({0.023, 0.02, 0.02}, 3), kPlain);
        scene.add(needle, options, {{0, 0, 0.02 + gap}, {}});
        scene.find();
        int points = 0, crossings = 0;
        for (const Proximity& p : scene.found) {
            CHECK(p.gap == Approx(gap));
            CHECK(distance(p.normal, {0, 0, -1}) < 1e-9);
            (onSide(p, 1) == 1 ? points : crossings) += 1;
        }
        CHECK(points == 5);    // the others are beyond the box
        CHECK(crossings == 2); // over the two edges of the box's top
    }
}

TEST_CASE("edges of tissue that have become flat or lead a little towards each other touch only if they pushed before")
{
    // Two roofs, ridge across ridge, whose slopes lead away from each other, or towards each other if they are
    // negative.
    const auto touch = [](double slope, bool soft, bool pushed, double past = 0.0) { // [m/s] sideways
        const double half = 0.005;
        const geometry::TriangleMesh roof{
            .vertices = {{-half, 0, 0}, {half, 0, 0}, {0, half, slope * half}, {0, -half, slope * half}},
            .triangles = {{0, 1, 2}, {1, 0, 3}},
            .uv = {}};
        Scene scene;
        scene.add(roof, kPlain, {{0, 0, 4e-4}, {}});
        scene.add(roof, kPlain, {{0, 0, 0}, axisAngle({1, 1, 0}, std::numbers::pi)}); // x to y, z to -z
        if (soft) scene.surfaces[0].element = -1;
        scene.surfaces[0].v.assign(4, {past, 0, 0});
        const auto ridge = [](const CollisionShape& shape) {
            const auto isRidge = [](const std::array<int, 2>& edge) { return edge[0] + edge[1] == 1; };
            return shape.edgeFeature(
                static_cast<int>(std::ranges::find_if(shape.edges, isRidge) - shape.edges.begin()));
        };
        const std::array features{ridge(*scene.surfaces[0].shape), ridge(*scene.surfaces[1].shape)};
        const std::uint64_t both = featureNumber(FeaturePair{.features = features});
        if (pushed) scene.pushed = {{{1}, {2}, both - 1}, {{1}, {2}, both}, {{1}, {2}, both + 1}};
        scene.find();
        const auto found = std::ranges::find(scene.found, both, &Proximity::feature);
        if (found == scene.found.end()) return false;
        CHECK(found->gap == Approx(4e-4));
        CHECK(distance(found->normal, {0, 0, 1}) < 1e-12);
        return true;
    };
    for (const bool soft : {true, false})
        for (const bool pushed : {true, false}) {
            CAPTURE(soft, pushed);
            CHECK(touch(0.01, soft, pushed));
            CHECK(touch(1e-4, soft, pushed) == (soft && pushed));
            CHECK(touch(-0.17, soft, pushed) == (soft && pushed));
            CHECK(!touch(-0.3, soft, pushed));
            CHECK(touch(1e-4, soft, pushed, 0.19) == (soft && pushed)); // by 0.285 mm in a step and a half
            CHECK(!touch(1e-4, soft, pushed, 0.21));
        }
}

TEST_CASE("surfaces in other collision groups or of the same body do not collide")
{
    const auto contacts = [](int group, std::uint32_t body) {
        Scene scene;
        scene.add(boxMesh({0.01, 0.01, 0.01}), kPlain);
        CollisionOptions options = kPlain;
        options.group = group;
        scene.add(boxMesh({0.01, 0.01, 0.01}), options, {{0.001, 0.002, 0.0202}, {}});
        scene.surfaces[1].name = {{body}, 1};
        return scene.find().size();
    };
    CHECK(contacts(0, 2) > 0);
    CHECK(contacts(1, 2) == 0);
    CHECK(contacts(0, 1) == 0);
}

} // namespace filasofia::engine::contacts_test
