#pragma once

#include "filasofia/core/attachment_id.h"
#include "filasofia/math/vec3.h"

#include <span>
#include <vector>

namespace filasofia::engine {

/// A spring that pins a node to a point in space.
struct PinSpring {
    int node = 0;
    Vec3 anchor;            ///< [m]
    double stiffness = 0.0; ///< [N/m]
};

/// The nodes that one attachment of a body's Def pins in space.
struct PinGroup {
    AttachmentId id;
    std::vector<int> nodes; ///< ascending, each once
    double stiffness = 0.0; ///< [N/m] stiffness of each node's spring; infinite: hard
};

/// The pinned nodes of a body.
struct Pins {
    std::vector<bool> hard;         ///< per node: true if it does not move
    std::vector<PinSpring> springs; ///< in the order of nodes; a node may have several
    /// The attachments that pin them; a tune() that changes `hard` or `springs` does not change the groups.
    std::vector<PinGroup> groups = {};
};

/// Removes a group and releases the nodes that no other group pins.
void releaseGroup(std::size_t group, Pins& pins);

/// Adds the pin springs' forces [N] at the positions x.
void addPinForces(const Pins& pins, std::span<const Vec3> x, std::span<Vec3> forces);

} // namespace filasofia::engine
