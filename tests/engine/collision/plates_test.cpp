#include "engine/collision/scene.h"

#include "filasofia/engine/collision/plates.h"
#include "filasofia/geometry/distance.h"

#include <cmath>

namespace filasofia::engine::plates_test {
namespace {

/// [m] The distance between a point and the other element, sampled along the element's edges and in its face: never
/// less than the true one.
double sampledDistance(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b)
{
    constexpr int kParts = 12;
    double nearest = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= kParts; ++i)
        for (int k = 0; k + i <= kParts; ++k) {
            const Vec3 p = a[0] + 1.0 / kParts * (i * (a[1] - a[0]) + k * (a[2] - a[0]));
            nearest = std::min(nearest, geometry::nearestOnTriangle(p, b[0], b[1], b[2]).squaredDistance);
        }
    return std::sqrt(nearest);
}

} // namespace

TEST_CASE("plates tell only of elements that are farther apart, and of most of these")
{
    std::mt19937 random(31);
    std::uniform_real_distribution<double> number(0.0, 1.0);
    int apart = 0, told = 0;
    for (int round = 0; round < 4000; ++round) {
        // Two triangles, lines or points of 0.5 to 5 mm, up to 8 mm from each other, up to 10 m from the origin.
        const double size = 0.5e-3 + 4.5e-3 * number(random);
        const Vec3 origin = randomVector(random, round % 3 == 0 ? 10.0 : 0.1), away = randomVector(random, 5e-3);
        Scene scene;
        std::array<std::array<Vec3, 3>, 2> corners;
        for (int side = 0; side < 2; ++side) {
            const Vec3 at = origin + static_cast<double>(side) * away;
            const int count = round % 7 == 6 ? 1 + side : 3;
            geometry::TriangleMesh mesh;
            for (int k = 0; k < count; ++k) mesh.vertices.push_back(at + randomVector(random, size));
            for (int k = 0; k < 3; ++k) corners[side][k] = mesh.vertices[std::min(k, count - 1)];
            CollisionOptions options;
            if (count == 3) mesh.triangles.push_back({0, 1, 2});
            if (count == 2) options.segments = {{0, 1}};
            scene.add(mesh, options);
            makePlates(scene.surfaces.back());
        }
        const double far = 1e-3 * number(random), distance = sampledDistance(corners[0], corners[1]);
        const Plate &one = scene.surfaces[0].plates[0], &two = scene.surfaces[1].plates[0];
        const bool found = farApart(one, two, static_cast<float>(far));
        CAPTURE(round, far, distance);
        if (found) CHECK(distance > far);
        CHECK(farApart(two, one, static_cast<float>(far)) == found);
        apart += distance > 1.1 * far + 1e-4 ? 1 : 0;
        told += found ? 1 : 0;
    }
    CHECK(apart > 2000);
    CHECK(told > 0.7 * apart);
}

TEST_CASE("no plate tells of an element with a corner that is not finite")
{
    Scene scene;
    for (const double x : {0.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        scene.add({.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .triangles = {{0, 1, 2}}, .uv = {}}, {});
        CollisionSurface& surface = scene.surfaces.back();
        for (Vec3& p : surface.x) p.z += 5.0 * static_cast<double>(scene.surfaces.size());
        surface.x[0].x += x;
        surface.x[1].x += x;
        surface.x[2].x += x;
        makePlates(surface);
    }
    for (const std::size_t i : {1U, 2U})
        CHECK_FALSE(farApart(scene.surfaces[0].plates[0], scene.surfaces[i].plates[0], 0.1f));
}

} // namespace filasofia::engine::plates_test
