#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/math/vec3.h"

namespace filasofia::physics {

/// Rayleigh damping: the damping matrix is mass * M + stiffness * K.
struct Rayleigh {
    double mass = 0.1;       ///< [1/s], >= 0
    double stiffness = 0.01; ///< [s], >= 0
};

/// A prescribed force on a node.
struct NodalForce {
    int node = 0;    ///< index of the mesh, or along the rod
    Vec3 force = {}; ///< [N]
};

constexpr auto fields(const Rayleigh*)
{
    using T = Rayleigh;
    return describe(
        "Rayleigh", field("mass", &T::mass, "1/s", within(nonNegative(), 1e9), "factor of the mass matrix"),
        field("stiffness", &T::stiffness, "s", within(nonNegative(), 1e9), "factor of the stiffness matrix"));
}
constexpr auto fields(const NodalForce*)
{
    using T = NodalForce;
    return describe("NodalForce", field("node", &T::node, "-", nonNegative(), "index of the node"),
                    field("force", &T::force, "N", finite(), "force on it"));
}

} // namespace filasofia::physics
