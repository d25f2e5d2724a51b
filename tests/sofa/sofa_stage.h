#pragma once

#include "filasofia/physics/physics_server.h"
#include "filasofia/runtime/engines.h"

#include <cmath>
#include <memory>
#include <string>

/// Scenes that run on either engine.
namespace filasofia::sofa_test {

/// A server with an engine of this name, on one thread.
inline std::unique_ptr<physics::PhysicsServer> serverWith(const std::string& engine, double period = 1e-3,
                                                          Vec3 gravity = {0, -9.81, 0})
{
    return std::make_unique<physics::PhysicsServer>(runtime::makeEngine(engine, {.period = period, .threads = 1}),
                                                    physics::PhysicsServerDef{.gravity = gravity});
}

/// A box of cells, each of five tetrahedra that mirror those of their neighbours.
inline std::shared_ptr<const geometry::TetMesh> bar(int nx, int ny, int nz, Vec3 size)
{
    geometry::TetMesh mesh;
    const auto node = [&](int i, int j, int k) { return (i * (ny + 1) + j) * (nz + 1) + k; };
    for (int i = 0; i <= nx; ++i)
        for (int j = 0; j <= ny; ++j)
            for (int k = 0; k <= nz; ++k) mesh.nodes.push_back({size.x * i / nx, size.y * j / ny, size.z * k / nz});
    constexpr int even[5][4] = {{0, 1, 2, 4}, {3, 2, 1, 7}, {5, 4, 7, 1}, {6, 7, 4, 2}, {1, 2, 4, 7}};
    constexpr int odd[5][4] = {{1, 0, 5, 3}, {2, 3, 6, 0}, {4, 5, 0, 6}, {7, 6, 3, 5}, {0, 3, 5, 6}};
    for (int i = 0; i < nx; ++i)
        for (int j = 0; j < ny; ++j)
            for (int k = 0; k < nz; ++k)
                for (const auto& each : (i + j + k) % 2 == 0 ? even : odd) {
                    geometry::Tetrahedron t{};
                    for (int c = 0; c < 4; ++c)
                        t[c] = node(i + (each[c] & 1), j + (each[c] >> 1 & 1), k + (each[c] >> 2 & 1));
                    if (geometry::signedVolume(mesh.nodes[t[0]], mesh.nodes[t[1]], mesh.nodes[t[2]], mesh.nodes[t[3]]) <
                        0)
                        std::swap(t[2], t[3]);
                    mesh.tetrahedra.push_back(t);
                }
    return std::make_shared<const geometry::TetMesh>(mesh);
}

/// [-] The distance of two states, relative to the way of the second from rest.
inline double relativeDistance(const std::vector<Vec3>& a, const std::vector<Vec3>& b, const std::vector<Vec3>& rest)
{
    double apart = 0.0, way = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        apart += lengthSquared(a[i] - b[i]);
        way += lengthSquared(b[i] - rest[i]);
    }
    return std::sqrt(apart / way);
}

inline physics::StepReport steps(physics::PhysicsServer& server, int count, double dt)
{
    physics::StepReport report;
    for (int i = 0; i < count; ++i) report = server.step(dt);
    return report;
}

} // namespace filasofia::sofa_test
