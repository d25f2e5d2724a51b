#pragma once

namespace filasofia::frame {

/// A joint of an articulated body, after a step. Units: a revolute joint's, or a prismatic one's.
struct Joint {
    double position = 0.0; ///< [rad] or [m]
    double velocity = 0.0; ///< [rad/s] or [m/s], through the step
    double force = 0.0; ///< [N m] or [N] of its drive: as commanded; of a joint that goes to a position, what that took
                        ///< against contacts and attachments (the links' own masses aside)
    double load = 0.0;  ///< [N m] or [N] of contacts and attachments about its axis, of all that it moves
    double stop = 0.0;  ///< [N m] or [N] of its limits: > 0 at the lower one; 0 of a joint that goes to a position
};

} // namespace filasofia::frame
