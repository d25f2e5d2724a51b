#pragma once

#include "filasofia/geometry/shapes.h"
#include "filasofia/physics/defs.h"

namespace filasofia::engine {

/// The rigid body of a clip of 8 mm, which falls nowhere.
inline physics::RigidBodyDef clipBody(Vec3 place = {})
{
    return {.name = "clip",
            .elements = {{place, {}}},
            .mesh = geometry::shapes::box({1e-3, 1e-3, 8e-3}),
            .dynamic = true,
            .mass = physics::TotalMass{1e-4},
            .linearDamping = 5.0,
            .angularDamping = 5.0,
            .gravity = false};
}

} // namespace filasofia::engine
