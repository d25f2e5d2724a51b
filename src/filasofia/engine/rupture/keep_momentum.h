#pragma once

#include "filasofia/math/vec3.h"

#include <span>
#include <vector>

namespace filasofia::engine {

/// [kg m/s] Momentum of those nodes that have a velocity.
inline Vec3 momentumOf(std::span<const int> nodes, std::span<const double> masses, std::span<const Vec3> velocities)
{
    Vec3 sum;
    for (const int node : nodes)
        if (const auto i = static_cast<std::size_t>(node); i < velocities.size()) sum += masses[i] * velocities[i];
    return sum;
}

/// A sliding node moves mass between nodes. The momentum that this adds to `before`, or removes, is spread over those
/// of the nodes that are not held.
template <class Held> void keepMomentum(Vec3 before, std::span<const int> nodes, std::span<const double> masses,
                                        const Held& isHeld, std::span<Vec3> velocities)
{
    double mass = 0.0;
    for (const int node : nodes)
        if (!isHeld(node)) mass += masses[static_cast<std::size_t>(node)];
    if (!(mass > 0.0)) return;
    const Vec3 change = 1.0 / mass * (before - momentumOf(nodes, masses, velocities));
    for (const int node : nodes)
        if (!isHeld(node)) velocities[static_cast<std::size_t>(node)] += change;
}

} // namespace filasofia::engine
