#pragma once

#include "filasofia/geometry/shapes.h"

#include "engine/stage.h"

/// A thread, and a table for it.
namespace filasofia::engine::rods {

inline constexpr Vec3 kGravity{0, -9.81, 0};

/// A thread of 10 cm along x whose first edge is clamped, unless said otherwise.
inline physics::RodBodyDef thread(bool held = true)
{
    physics::RodBodyDef def{
        .name = "silk", .points = {{0, 0.05, 0}, {0.1, 0.05, 0}}, .spacing = 2e-3, .radius = 0.3e-3};
    def.youngModulus = 2e7;
    if (held) def.attachments = {{.nodes = {0, 1}}};
    return def;
}

inline physics::RigidBodyDef table()
{
    return {.name = "table",
            .elements = {{{0, -5e-3, 0}, {}}},
            .mesh = geometry::shapes::box({0.4, 0.01, 0.4}),
            .collision = {{}}};
}

} // namespace filasofia::engine::rods
