#pragma once

#include "filasofia/engine/collision/find_proximities.h"
#include "filasofia/math/pose.h"

#include <algorithm>
#include <numbers>
#include <random>

namespace filasofia::engine {

/// A closed box around the origin with 2 n^2 triangles per side and convex edges.
inline geometry::TriangleMesh boxMesh(Vec3 half, int n = 1)
{
    geometry::TriangleMesh mesh;
    const auto vertexAt = [&](Vec3 p) {
        const auto same = [p](Vec3 q) { return distance(p, q) < 1e-12; };
        const auto it = std::ranges::find_if(mesh.vertices, same);
        if (it == mesh.vertices.end()) return mesh.vertices.push_back(p), static_cast<int>(mesh.vertices.size()) - 1;
        return static_cast<int>(it - mesh.vertices.begin());
    };
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0})
            for (int i = 0; i < n; ++i)
                for (int k = 0; k < n; ++k) {
                    const auto corner = [&](int di, int dk) {
                        Vec3 p;
                        p[axis] = side * half[axis];
                        p[(axis + 1) % 3] = (2.0 * (i + di) / n - 1.0) * half[(axis + 1) % 3];
                        p[(axis + 2) % 3] = (2.0 * (k + dk) / n - 1.0) * half[(axis + 2) % 3];
                        return vertexAt(p);
                    };
                    std::array<int, 4> q{corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
                    if (side < 0.0) std::swap(q[1], q[3]);
                    mesh.triangles.push_back({q[0], q[1], q[2]});
                    mesh.triangles.push_back({q[0], q[2], q[3]});
                }
    return mesh;
}

/// A sheet in the plane z = 0 around the origin with n x n cells of two triangles, normal along +z.
inline geometry::TriangleMesh sheetMesh(double half, int n)
{
    geometry::TriangleMesh mesh;
    for (int i = 0; i <= n; ++i)
        for (int k = 0; k <= n; ++k)
            mesh.vertices.push_back({(2.0 * i / n - 1.0) * half, (2.0 * k / n - 1.0) * half, 0});
    for (int i = 0; i < n; ++i)
        for (int k = 0; k < n; ++k) {
            const int a = i * (n + 1) + k, b = a + n + 1;
            mesh.triangles.push_back({a, b, b + 1});
            mesh.triangles.push_back({a, b + 1, a + 1});
        }
    return mesh;
}

/// A closed lump: a sphere of `rings` rings whose vertices are moved in and out by up to `roughness` of the radius.
inline geometry::TriangleMesh lumpMesh(double radius, int rings, double roughness, std::mt19937& random)
{
    std::uniform_real_distribution<double> scale(1.0 - roughness, 1.0 + roughness);
    geometry::TriangleMesh mesh;
    const int around = rings + 1;
    const auto at = [&](int i, int k) { return 1 + (i - 1) * around + k % around; };
    mesh.vertices.push_back({0, 0, radius * scale(random)});
    for (int i = 1; i < rings; ++i)
        for (int k = 0; k < around; ++k) {
            const double a = std::numbers::pi * i / rings, b = 2.0 * std::numbers::pi * (k + 0.5 * (i % 2)) / around;
            mesh.vertices.push_back(radius * scale(random) *
                                    Vec3{std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)});
        }
    mesh.vertices.push_back({0, 0, -radius * scale(random)});
    const int last = static_cast<int>(mesh.vertices.size()) - 1;
    for (int k = 0; k < around; ++k) {
        mesh.triangles.push_back({0, at(1, k), at(1, k + 1)});
        mesh.triangles.push_back({last, at(rings - 1, k + 1), at(rings - 1, k)});
        for (int i = 1; i < rings - 1; ++i) {
            mesh.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
            mesh.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
        }
    }
    return mesh;
}

inline Vec3 randomVector(std::mt19937& random, double size)
{
    std::uniform_real_distribution<double> number(-size, size);
    const double x = number(random), y = number(random);
    return {x, y, number(random)};
}

/// Surfaces with all state of their queries from step to step: rigid ones, and tissue if they collide with themselves.
struct Scene {
    std::vector<CollisionSurface> surfaces;
    std::vector<PushedFeatures> pushed; ///< in the last step
    std::vector<SheetSide> sides;
    ProximityScratch scratch;
    std::vector<Proximity> found;
    double dt = 1e-3;

    int add(const geometry::TriangleMesh& mesh, const CollisionOptions& options, const Pose& pose = {},
            Vec3 velocity = {})
    {
        CollisionSurface surface;
        surface.name.body = {static_cast<std::uint32_t>(surfaces.size() + 1)};
        surface.element = options.self ? -1 : 0;
        surface.self = options.self;
        surface.shape = std::make_shared<const CollisionShape>(makeCollisionShape(mesh, options));
        for (const Vec3 p : mesh.vertices) surface.x.push_back(transform(pose, p));
        surface.v.assign(surface.x.size(), velocity);
        surfaces.push_back(std::move(surface));
        return static_cast<int>(surfaces.size()) - 1;
    }
    void move(int surface, Vec3 by)
    {
        for (Vec3& x : surfaces[static_cast<std::size_t>(surface)].x) x += by;
    }
    const std::vector<Proximity>& find(int threads = 1)
    {
        WorkerPool pool(threads);
        findProximities(surfaces, dt, pool, pushed, sides, scratch, found);
        return found;
    }
    /// The position of one side of a proximity.
    [[nodiscard]] Vec3 place(const Proximity& p, int side) const
    {
        Vec3 sum;
        for (int k = 0; k < 3; ++k)
            if (p.vertices[side][k] >= 0)
                sum += p.weights[side][k] * surfaces[static_cast<std::size_t>(p.surfaces[side])].x[p.vertices[side][k]];
        return sum;
    }
};

} // namespace filasofia::engine
