#pragma once

#include "filasofia/geometry/triangle_mesh.h"
#include "filasofia/math/quat.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>

namespace filasofia {

inline std::shared_ptr<const geometry::TriangleMesh> shared(geometry::TriangleMesh mesh)
{
    return std::make_shared<const geometry::TriangleMesh>(std::move(mesh));
}

/// The surface of a box around the origin: twelve triangles.
inline geometry::TriangleMesh boxSurface(Vec3 half)
{
    geometry::TriangleMesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.vertices.push_back({(i & 1) ? half.x : -half.x, (i & 2) ? half.y : -half.y, (i & 4) ? half.z : -half.z});
    constexpr int faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& f : faces) {
        mesh.triangles.push_back({f[0], f[1], f[2]});
        mesh.triangles.push_back({f[0], f[2], f[3]});
    }
    return mesh;
}

/// A ball around the origin: an octahedron refined `levels` times, 8 * 4^levels triangles.
inline geometry::TriangleMesh ballSurface(double radius, int levels)
{
    geometry::TriangleMesh mesh;
    mesh.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<int, int>, int> middles;
        const auto middle = [&](int a, int b) {
            const auto [at, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<int>(mesh.vertices.size()));
            if (fresh) mesh.vertices.push_back(normalized(mesh.vertices[a] + mesh.vertices[b]));
            return at->second;
        };
        std::vector<geometry::Triangle> finer;
        for (const auto& [a, b, c] : mesh.triangles) {
            const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            for (const geometry::Triangle& t : {geometry::Triangle{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
                finer.push_back(t);
        }
        mesh.triangles = std::move(finer);
    }
    for (Vec3& v : mesh.vertices) v = radius * v;
    return mesh;
}

inline Quat turnAbout(Vec3 axis, double angle)
{
    const Vec3 u = std::sin(0.5 * angle) * normalized(axis);
    return {std::cos(0.5 * angle), u.x, u.y, u.z};
}

} // namespace filasofia
