#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/math/pose.h"

#include <vector>

namespace filasofia::sofaengine {

/// Where a rigid body is, per element.
struct RigidState {
    std::vector<Pose> poses = {};             ///< where the elements have their origins
    std::vector<Vec3> velocities = {};        ///< [m/s] at the centres of mass; those of links at their origins
    std::vector<Vec3> angularVelocities = {}; ///< [rad/s] in world axes
};

/// A force of a contact or an attachment on an element of a rigid body.
struct PointForce {
    BodyId body = {};
    int element = 0;
    Vec3 point = {}; ///< [m]
    Vec3 force = {}; ///< [N]
};

} // namespace filasofia::sofaengine
