#pragma once

#include "filasofia/geometry/shapes.h"
#include "filasofia/geometry/triangle_mesh.h"

#include "engine/meshes.h"

#include <cmath>
#include <numbers>

namespace filasofia {

inline std::shared_ptr<const geometry::TriangleMesh> shared(geometry::TriangleMesh mesh)
{
    return std::make_shared<const geometry::TriangleMesh>(std::move(mesh));
}

/// A flat sheet in the plane z = 0 with its low corner at the origin, facing upwards, in n cells of two triangles.
/// Vertices run fastest along y. `jitter`: the largest displacement of inner vertices as a fraction of a cell, which
/// stays in the plane; `mixed`: the diagonals alternate.
inline geometry::TriangleMesh sheetMesh(std::array<int, 2> n, double width, double depth, double jitter = 0.0,
                                        bool mixed = false)
{
    geometry::TriangleMesh mesh;
    std::mt19937 random(7);
    const auto index = [&](int i, int j) { return i * (n[1] + 1) + j; };
    for (int i = 0; i <= n[0]; ++i)
        for (int j = 0; j <= n[1]; ++j) {
            const Vec3 shift = randomVec3(random, jitter);
            const bool inner = i > 0 && i < n[0] && j > 0 && j < n[1];
            mesh.vertices.push_back(
                {(i + (inner ? shift.x : 0.0)) * width / n[0], (j + (inner ? shift.y : 0.0)) * depth / n[1], 0.0});
        }
    for (int i = 0; i < n[0]; ++i)
        for (int j = 0; j < n[1]; ++j) {
            const int a = index(i, j), b = index(i + 1, j), c = index(i + 1, j + 1), d = index(i, j + 1);
            if (mixed && (i + j) % 2 != 0)
                mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {b, c, d}});
            else
                mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
        }
    return mesh;
}

/// A flat disc around the origin in the plane z = 0, facing upwards: rings of 6 k vertices at equal distances.
inline geometry::TriangleMesh discMesh(int rings, double radius)
{
    geometry::TriangleMesh mesh{.vertices = {{}}, .triangles = {}, .uv = {}};
    const auto first = [](int ring) { return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1); };
    for (int ring = 1; ring <= rings; ++ring)
        for (int k = 0; k < 6 * ring; ++k) {
            const double r = radius * ring / rings, angle = 2.0 * std::numbers::pi * k / (6 * ring);
            mesh.vertices.push_back({r * std::cos(angle), r * std::sin(angle), 0.0});
        }
    for (int ring = 1; ring <= rings; ++ring)
        for (int side = 0; side < 6; ++side)
            for (int k = 0; k < ring; ++k) {
                const int count = 6 * ring, inner = std::max(1, 6 * (ring - 1));
                const int a = first(ring) + side * ring + k, b = first(ring) + (side * ring + k + 1) % count;
                const int c = first(ring - 1) + (side * (ring - 1) + k) % inner;
                mesh.triangles.push_back({c, a, b});
                if (k + 1 < ring)
                    mesh.triangles.push_back({c, b, first(ring - 1) + (side * (ring - 1) + k + 1) % inner});
            }
    return mesh;
}

/// A tube of a radius around the x axis, open at both ends, facing outwards.
inline geometry::TriangleMesh tubeMesh(int around, int along, double radius, double length)
{
    geometry::TriangleMesh mesh;
    const auto index = [&](int i, int j) { return i * around + j % around; };
    for (int i = 0; i <= along; ++i)
        for (int j = 0; j < around; ++j) {
            const double angle = 2.0 * std::numbers::pi * (j + 0.5 * (i % 2)) / around;
            mesh.vertices.push_back({i * length / along, radius * std::cos(angle), radius * std::sin(angle)});
        }
    for (int i = 0; i < along; ++i)
        for (int j = 0; j < around; ++j) {
            const int a = index(i, j), b = index(i + 1, j), c = index(i + 1, j + 1), d = index(i, j + 1);
            if (i % 2 == 0)
                mesh.triangles.insert(mesh.triangles.end(), {{a, d, b}, {d, c, b}});
            else
                mesh.triangles.insert(mesh.triangles.end(), {{a, d, c}, {a, c, b}});
        }
    return mesh;
}

} // namespace filasofia
