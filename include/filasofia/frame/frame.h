#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/math/pose.h"

#include <cstdint>
#include <vector>

namespace filasofia::frame {

/// The state of one soft body.
struct SoftBodyFrame {
    BodyId id = {};
    std::vector<Vec3> positions = {};  ///< [m], one per node
    std::vector<Vec3> velocities = {}; ///< [m/s], one per node
};

/// The state of one rigid body: one pose per element.
struct RigidBodyFrame {
    BodyId id = {};
    std::vector<Pose> poses = {}; ///< from the element's coordinates to the world
};

/// The whole state after one step, as everyone outside the engine sees it. Immutable once published.
struct Frame {
    std::uint64_t step = 0;                       ///< number of steps made
    double time = 0.0;                            ///< [s], simulated
    std::vector<SoftBodyFrame> softBodies = {};   ///< in the order of their ids
    std::vector<RigidBodyFrame> rigidBodies = {}; ///< in the order of their ids

    [[nodiscard]] const SoftBodyFrame* softBody(BodyId id) const;   ///< nullptr where there is none
    [[nodiscard]] const RigidBodyFrame* rigidBody(BodyId id) const; ///< nullptr where there is none
};

} // namespace filasofia::frame
