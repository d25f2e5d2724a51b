#include "engine/collision/scene.h"

namespace filasofia::engine::sheets_test {
namespace {

constexpr CollisionOptions kPlain{.proximity = 0.5e-3};

// A point over a sheet of 4 x 4 cells of 1 cm.
Scene pointOver(double height)
{
    Scene scene;
    scene.add(sheetMesh(0.02, 4), {.proximity = 0.5e-3, .depth = 1e-3});
    geometry::TriangleMesh point;
    point.vertices = {{0.0013, 0.0027, height}};
    scene.add(point, kPlain);
    return scene;
}

// A strip of 2 x n cells of 5 mm folded to a U: the lower arm in the plane z = 0, the upper one `between` above it.
geometry::TriangleMesh fold(geometry::TriangleMesh strip, double length, double between)
{
    const double radius = 0.5 * between, bend = std::numbers::pi * radius;
    for (Vec3& p : strip.vertices) {
        const double along = p.x - 0.5 * (length - bend);
        const double height = p.z;
        if (along <= 0.0) continue;
        if (along < bend) {
            const double angle = along / radius;
            p.x = 0.5 * (length - bend) + (radius - height) * std::sin(angle);
            p.z = radius - (radius - height) * std::cos(angle);
        } else {
            p.x = 0.5 * (length - bend) - (along - bend);
            p.z = between - height;
        }
    }
    return strip;
}

geometry::TriangleMesh strip(int n, double cell)
{
    geometry::TriangleMesh mesh;
    for (int i = 0; i <= n; ++i)
        for (int k = 0; k <= 2; ++k) mesh.vertices.push_back({i * cell, (k - 1) * cell, 0});
    for (int i = 0; i < n; ++i)
        for (int k = 0; k < 2; ++k) {
            const int a = 3 * i + k, b = a + 3;
            mesh.triangles.push_back({a, b, b + 1});
            mesh.triangles.push_back({a, b + 1, a + 1});
        }
    return mesh;
}

} // namespace

TEST_CASE("a sheet collides on both sides")
{
    for (const double height : {3e-4, -3e-4}) {
        Scene scene = pointOver(height);
        REQUIRE(scene.find().size() == 1);
        CHECK(scene.found[0].gap == Approx(3e-4));
        CHECK(distance(scene.found[0].normal, {0, 0, height > 0.0 ? -1.0 : 1.0}) < 1e-12);
    }
}

TEST_CASE("a point that went through a sheet is pushed back to its side")
{
    for (const double side : {1.0, -1.0}) {
        CAPTURE(side);
        Scene scene = pointOver(side * 3e-4);
        REQUIRE(scene.find().size() == 1);
        // It moves on, and also sideways over neighbouring triangles.
        for (int step = 1; step <= 8; ++step) {
            scene.move(1, {8e-4, 1e-4, -side * 2e-4});
            REQUIRE(scene.find().size() == 1);
            CHECK(scene.found[0].gap == Approx(3e-4 - step * 2e-4));
            CHECK(distance(scene.found[0].normal, {0, 0, -side}) < 1e-12);
        }
        // Out of range on the wrong side the history is dropped, and there the point starts on a new side.
        scene.move(1, {0, 0, -side * 3e-3});
        CHECK(scene.find().empty());
        scene.move(1, {0, 0, side * 4e-3});
        REQUIRE(scene.find().size() == 1);
        CHECK(scene.found[0].gap == Approx(3e-4));
        CHECK(distance(scene.found[0].normal, {0, 0, side}) < 1e-12);
    }
}

TEST_CASE("a point moves around the rim of a sheet from one side to the other")
{
    Scene scene = pointOver(3e-4);
    for (const Vec3 at :
         {Vec3{0.0199, 0.0027, 3e-4}, {0.0203, 0.0027, 1e-5}, {0.0203, 0.0027, -1e-5}, {0.0199, 0.0027, -3e-4}}) {
        scene.surfaces[1].x[0] = at;
        REQUIRE(scene.find().size() == 1);
        CHECK(scene.found[0].gap == Approx(3e-4).epsilon(0.01));
    }
    CHECK(distance(scene.found[0].normal, {0, 0, 1}) < 1e-12);
}

TEST_CASE("the sides are the complete history of a sheet, and the buffers hold none")
{
    Scene scene = pointOver(1e-4);
    scene.find();
    scene.move(1, {0, 0, -2e-4});
    Scene copy = scene;
    copy.sides.clear();
    REQUIRE(copy.find().size() == 1);
    CHECK(copy.found[0].gap == Approx(1e-4));
    copy = scene;
    copy.scratch = {};
    REQUIRE(copy.find().size() == 1);
    CHECK(copy.found[0].gap == Approx(-1e-4));
}

TEST_CASE("surfaces added and removed before a sheet and a point change neither their sides nor their numbers")
{
    Scene scene;
    scene.add(boxMesh({1e-3, 1e-3, 1e-3}), kPlain, {{1, 0, 0}, {}});
    const Scene over = pointOver(1e-4);
    for (const CollisionSurface& each : over.surfaces) {
        scene.surfaces.push_back(each);
        scene.surfaces.back().name = {{each.name.body.value + 1}, 3};
    }
    REQUIRE(scene.find().size() == 1);
    const std::uint64_t feature = scene.found[0].feature;
    const std::vector<SheetSide> sides = scene.sides;
    REQUIRE(sides.size() == 1);
    scene.surfaces.erase(scene.surfaces.begin());
    scene.move(1, {0, 0, -2e-4});
    REQUIRE(scene.find().size() == 1);
    CHECK(scene.found[0].gap == Approx(-1e-4));
    CHECK(scene.found[0].feature == feature);
    CHECK(scene.sides == sides);
}

TEST_CASE("the arms of a folded sheet collide, and a sheet does not collide with its own neighbouring triangles")
{
    const double cell = 5e-3;
    CollisionOptions options{.proximity = 0.5e-3, .self = true};
    const geometry::TriangleMesh flat = strip(16, cell);
    {
        Scene scene;
        scene.add(flat, options);
        CHECK(scene.find().empty());
    }
    Scene scene;
    scene.add(flat, options);
    scene.surfaces[0].x = fold(flat, 16 * cell, 0.8e-3).vertices;
    scene.find();
    REQUIRE(scene.found.size() > 20);
    for (const Proximity& p : scene.found) {
        CHECK(p.surfaces == std::array{0, 0});
        CHECK(p.gap > 0.0);
        CHECK(p.gap < 1e-3);
        for (const int v : p.vertices[0]) CHECK((v < 0 || std::ranges::find(p.vertices[1], v) == p.vertices[1].end()));
    }
    // After they were pressed through each other they still know their sides.
    const auto arms = [](const Proximity& p) { return std::fabs(p.normal.z) > 0.99 && p.gap < 0.0; };
    for (Vec3& x : scene.surfaces[0].x)
        if (x.z > 0.7e-3) x.z = -0.1e-3;
    scene.find();
    CHECK(std::ranges::count_if(scene.found, arms) > 10);
}

TEST_CASE("a thin body that folds collides with itself from outside, and not through its own thickness")
{
    // A strip of 1 mm in thickness, with proximities of 0.6 mm: its walls are nearer than the depth followed inside.
    geometry::TriangleMesh slab = boxMesh({0.04, 0.01, 0.5e-3}, 8);
    for (Vec3& p : slab.vertices) p.x += 0.04;
    CollisionOptions options{.proximity = 0.4e-3, .self = true};
    Scene scene;
    scene.add(slab, options);
    CHECK(scene.find().empty());
    // Squeezed to 70 %, there is still no contact.
    for (Vec3& x : scene.surfaces[0].x) x.z *= 0.7;
    CHECK(scene.find().empty());
    // Folded with the arms' middles 1.5 mm apart, which leaves half a millimetre between them.
    scene.surfaces[0].x = fold(slab, 0.08, 1.5e-3).vertices;
    scene.find();
    CHECK(std::ranges::count_if(scene.found, [](const Proximity& p) {
              return std::fabs(p.gap - 0.5e-3) < 1e-6 && std::fabs(p.normal.z) > 0.999;
          }) > 10);
    for (const Proximity& p : scene.found) CHECK(p.gap > 0.0);
}

} // namespace filasofia::engine::sheets_test
