#include "engine/collision/scene.h"

#include <limits>

namespace filasofia::engine::robustness_test {
namespace {

constexpr CollisionOptions kPlain{.proximity = 0.5e-3};
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

void checkSound(const Scene& scene)
{
    for (const Proximity& p : scene.found) {
        REQUIRE(length(p.normal) == Approx(1.0));
        REQUIRE(std::isfinite(p.gap));
        for (int side = 0; side < 2; ++side) {
            double sum = 0.0;
            for (int k = 0; k < 3; ++k) {
                REQUIRE(p.weights[side][k] >= 0.0);
                REQUIRE((p.vertices[side][k] >= 0 || p.weights[side][k] == 0.0));
                sum += p.weights[side][k];
            }
            REQUIRE(sum == Approx(1.0));
        }
    }
}

} // namespace

TEST_CASE("surfaces without any feature collide with nothing")
{
    Scene scene;
    CHECK(scene.find().empty());
    scene.add({}, kPlain);
    scene.add(boxMesh({0.01, 0.01, 0.01}), kPlain);
    scene.add({}, {.self = true});
    CHECK(scene.find().empty());
    CollisionOptions off = kPlain;
    off.points = off.lines = off.triangleFaces = false;
    scene.add(boxMesh({0.01, 0.01, 0.01}), off);
    CHECK(scene.find().empty());
}

TEST_CASE("vertices that are not finite, or extremely far away, collide with nothing and disturb nothing else")
{
    Scene clean;
    clean.add(sheetMesh(0.02, 4), kPlain);
    clean.add(boxMesh({0.003, 0.003, 0.003}), kPlain, {{0.001, 0.002, 0.0032}, {}});
    const std::size_t count = clean.find().size();
    REQUIRE(count == 5);
    for (const double bad : {kNan, kInfinity, -kInfinity, 1e200, 1e12}) {
        CAPTURE(bad);
        Scene scene = clean;
        scene.surfaces[0].x[24].x = bad; // a corner that nothing lies above
        scene.find();
        checkSound(scene);
        CHECK(scene.found.size() == count);
        scene.surfaces[1].v[0].z = bad;
        scene.find();
        checkSound(scene);
        CHECK(scene.found.size() < count);
        for (Vec3& x : scene.surfaces[1].x) x.y = bad;
        CHECK(scene.find().empty());
    }
}

TEST_CASE("a point exactly on a face, an edge or a corner is pushed out along the normal there")
{
    const double h = 0.01, s = 1.0 / std::sqrt(3.0), r = 1.0 / std::sqrt(2.0);
    const std::pair<Vec3, Vec3> cases[] = {
        {{0.001, 0.003, h}, {0, 0, 1}}, {{h, 0.001, h}, {r, 0, r}}, {{h, h, h}, {s, s, s}}};
    for (const auto& [at, outwards] : cases) {
        CAPTURE(at.x, at.y, at.z);
        Scene scene;
        scene.add(boxMesh({h, h, h}), kPlain);
        geometry::TriangleMesh point;
        point.vertices = {at};
        scene.add(point, kPlain);
        scene.find();
        REQUIRE(scene.found.size() == 1);
        CHECK(std::fabs(scene.found[0].gap) < 1e-15);
        CHECK(distance(scene.found[0].normal, -outwards) < 1e-6);
    }
}

TEST_CASE("coincident meshes and triangles without area give finite unit normals")
{
    std::mt19937 random(5);
    for (int round = 0; round < 20; ++round) {
        CAPTURE(round);
        const geometry::TriangleMesh lump = lumpMesh(0.02, 8, 0.1, random);
        Scene scene;
        scene.add(lump, kPlain);
        geometry::TriangleMesh other = round % 2 == 0 ? lump : lumpMesh(0.02, 8, 0.1, random);
        CollisionOptions options = kPlain;
        options.self = true;
        scene.add(other, options);
        // Make some vertices coincide and some collinear.
        for (int i = 0; i < 6; ++i) {
            const auto& [a, b, c] = other.triangles[random() % other.triangles.size()];
            scene.surfaces[1].x[a] =
                i % 2 == 0 ? scene.surfaces[1].x[b] : 0.5 * (scene.surfaces[1].x[b] + scene.surfaces[1].x[c]);
        }
        scene.find();
        CHECK(scene.found.size() > 20);
        checkSound(scene);
    }
}

TEST_CASE("a surface shrunk to a point collides and gives finite unit normals")
{
    Scene scene;
    scene.add(boxMesh({0.01, 0.01, 0.01}), kPlain);
    scene.add(boxMesh({0.01, 0.01, 0.01}), kPlain);
    for (const Vec3 at : {Vec3{0.001, 0.002, 0.0103}, {0.001, 0.002, 0.01}, {0.01, 0.01, 0.01}, {0.0, 0.0, 0.0102}}) {
        scene.surfaces[1].x.assign(8, at);
        scene.find();
        CHECK(scene.found.size() >= 8);
        checkSound(scene);
    }
}

TEST_CASE("contacts far from the origin match those at the origin")
{
    const auto contacts = [](Vec3 origin) {
        Scene scene;
        scene.add(boxMesh({0.02, 0.02, 0.02}, 3), kPlain, {origin, {}});
        scene.add(boxMesh({0.01, 0.01, 0.01}), kPlain, {origin + Vec3{0.001, 0.002, 0.0302}, {}});
        return scene.find().size();
    };
    CHECK(contacts({}) > 4);
    CHECK(contacts({1000, -2000, 500}) == contacts({}));
}

} // namespace filasofia::engine::robustness_test
