#pragma once

#include "filasofia/engine/rigid/rigid_step.h"
#include "filasofia/math/world_inertia.h"

#include "engine/stage.h"

namespace filasofia::engine {

/// The surface of a box with its low corner at the origin.
inline std::shared_ptr<const geometry::TriangleMesh> boxSurface(Vec3 size)
{
    geometry::TriangleMesh mesh;
    for (int i = 0; i < 8; ++i) mesh.vertices.push_back({i & 4 ? size.x : 0, i & 2 ? size.y : 0, i & 1 ? size.z : 0});
    mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1},
                      {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
    return std::make_shared<const geometry::TriangleMesh>(std::move(mesh));
}

inline constexpr Vec3 kBoxSize{0.2, 0.1, 0.05};
inline constexpr Vec3 kBoxCentre = 0.5 * kBoxSize;

/// A box of 1 kg without gravity; its element's origin is a corner.
inline physics::RigidBodyDef boxBody()
{
    return {.name = "box", .mesh = boxSurface(kBoxSize), .dynamic = true, .gravity = false};
}

/// A body given only by its moments of inertia.
inline physics::RigidBodyDef tumbling(Vec3 moments, Vec3 angularVelocity)
{
    return {.name = "top",
            .dynamic = true,
            .mass = physics::GivenInertia{.mass = 2.0, .moments = moments},
            .angularVelocity = angularVelocity,
            .gravity = false};
}

inline RigidState& rigidState(Stage& stage, std::size_t body = 0) { return stage.world.scene().rigid[body].state; }

inline Vec3 angularMomentum(Stage& stage, std::size_t e = 0)
{
    const Mat3& inertia = stage.world.scene().rigid[0].model.inertias[e].inertia;
    const RigidState& state = rigidState(stage);
    return worldInertia(inertia, state.poses[e].orientation) * state.angularVelocities[e];
}

/// [J] Energy of the rotation.
inline double turningEnergy(Stage& stage, std::size_t e = 0)
{
    return 0.5 * dot(angularMomentum(stage, e), rigidState(stage).angularVelocities[e]);
}

} // namespace filasofia::engine
