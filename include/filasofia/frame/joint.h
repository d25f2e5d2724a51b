#pragma once

namespace filasofia::frame {

/// The state of a joint of an articulated body after a step. The first unit is that of a revolute joint, the second
/// that of a prismatic one.
struct Joint {
    double position = 0.0; ///< [rad] or [m]
    double velocity = 0.0; ///< [rad/s] or [m/s], mean over the step
    /// [N m] or [N], the drive's force: the commanded one, that of its spring, or, for a prescribed position, the force
    /// that its motion took against contacts and attachments (without the inertia and weight of the links)
    double force = 0.0;
    double load = 0.0; ///< [N m] or [N], load of contacts and attachments along its axis, on everything that it moves
    double stop =
        0.0; ///< [N m] or [N], force of its limits: > 0 at the lower one; 0 for a joint with a prescribed position
};

} // namespace filasofia::frame
