#pragma once

#include "filasofia/core/attachment_id.h"
#include "filasofia/math/vec3.h"

#include <span>
#include <vector>

namespace filasofia::engine {

/// A node held in space by a spring.
struct PinSpring {
    int node = 0;
    Vec3 anchor;            ///< [m]
    double stiffness = 0.0; ///< [N/m]
};

/// What one attachment of a body's Def holds in space.
struct PinGroup {
    AttachmentId id;
    std::vector<int> nodes; ///< ascending, each once
    double stiffness = 0.0; ///< [N/m] of each node's spring; infinite: hard
};

/// The nodes of a body that are held in space.
struct Pins {
    std::vector<bool> hard;            ///< per node: it does not move
    std::vector<PinSpring> springs;    ///< in the order of nodes; a node may have several
    std::vector<PinGroup> groups = {}; ///< who holds them; what a tune() changes above is not followed here
};

/// Lets go what a group holds, and no other group does.
void releaseGroup(std::size_t group, Pins& pins);

/// Adds [N] the pin springs' forces at the positions x.
void addPinForces(const Pins& pins, std::span<const Vec3> x, std::span<Vec3> forces);

} // namespace filasofia::engine
