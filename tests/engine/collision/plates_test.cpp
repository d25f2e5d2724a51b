#include "engine/collision/scene.h"

#include "filasofia/engine/collision/plates.h"
#include "filasofia/geometry/distance.h"

#include <cmath>

namespace filasofia::engine::plates_test {
namespace {

double squaredSegmentDistance(Vec3 p, Vec3 d, Vec3 q, Vec3 e)
{
    // The minimum lies where both parameters are free, or at an end of one segment.
    double nearest = std::numeric_limits<double>::infinity();
    const double a = dot(d, d), b = dot(d, e), c = dot(e, e), f = dot(d, p - q), g = dot(e, p - q), den = a * c - b * b;
    if (den > 1e-12 * a * c) {
        const double s = (b * g - c * f) / den, t = (a * g - b * f) / den;
        if (s >= 0.0 && s <= 1.0 && t >= 0.0 && t <= 1.0) nearest = lengthSquared(p + s * d - q - t * e);
    }
    for (const Vec3 end : {p, p + d})
        nearest = std::min(nearest, lengthSquared(end - geometry::nearestOnSegment(end, q, q + e).point));
    for (const Vec3 end : {q, q + e})
        nearest = std::min(nearest, lengthSquared(end - geometry::nearestOnSegment(end, p, p + d).point));
    return nearest;
}

/// [m] The distance of two triangles that do not pass through each other: between edges, or a corner and a face.
double distanceOf(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b)
{
    double nearest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
        nearest = std::min(nearest, geometry::nearestOnTriangle(a[i], b[0], b[1], b[2]).squaredDistance);
        nearest = std::min(nearest, geometry::nearestOnTriangle(b[i], a[0], a[1], a[2]).squaredDistance);
        for (int k = 0; k < 3; ++k)
            nearest =
                std::min(nearest, squaredSegmentDistance(a[i], a[(i + 1) % 3] - a[i], b[k], b[(k + 1) % 3] - b[k]));
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
            if (round % 5 == 4 && count == 3) // a needle: its normal is rounding
                mesh.vertices[2] = mesh.vertices[0] + 0.4 * (mesh.vertices[1] - mesh.vertices[0]);
            for (int k = 0; k < 3; ++k) corners[side][k] = mesh.vertices[std::min(k, count - 1)];
            CollisionOptions options;
            if (count == 3) mesh.triangles.push_back({0, 1, 2});
            if (count == 2) options.segments = {{0, 1}};
            scene.add(mesh, options);
            makePlates(scene.surfaces.back());
        }
        const double far = 1e-3 * number(random), distance = distanceOf(corners[0], corners[1]);
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
    for (const double odd : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
        for (int corner = 0; corner < 3; ++corner) {
            Scene scene;
            for (int side = 0; side < 2; ++side) {
                scene.add({.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .triangles = {{0, 1, 2}}, .uv = {}}, {});
                CollisionSurface& surface = scene.surfaces.back();
                for (Vec3& p : surface.x) p.z += 5.0 * side;
                if (side == 1) surface.x[static_cast<std::size_t>(corner)].x = odd;
                makePlates(surface);
            }
            const Plate &one = scene.surfaces[0].plates[0], &two = scene.surfaces[1].plates[0];
            CHECK_FALSE(farApart(one, two, 0.1f));
            CHECK_FALSE(farApart(two, one, 0.1f));
        }
}

} // namespace filasofia::engine::plates_test
