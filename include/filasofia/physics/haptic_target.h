#pragma once

#include "filasofia/math/virtual_coupling.h"

namespace filasofia::physics {

/// The motion of a hand that holds a rigid element, at the end of the step, and its coupling to the element: the state
/// of a haptic device, sent once per step.
struct HapticTarget {
    Pose pose = {};            ///< pose of the hand: target of the element's origin
    Vec3 velocity = {};        ///< [m/s]
    Vec3 angularVelocity = {}; ///< [rad/s] in world axes
    VirtualCoupling coupling =
        {}; ///< virtual coupling between the element's centre of mass and the same point of the hand

    friend constexpr bool operator==(const HapticTarget&, const HapticTarget&) = default;
};
constexpr auto fields(const HapticTarget*)
{
    using T = HapticTarget;
    return describe("HapticTarget", field("pose", &T::pose, "pose of the hand"),
                    field("velocity", &T::velocity, "m/s", finite(), "velocity of the hand"),
                    field("angularVelocity", &T::angularVelocity, "rad/s", finite(), "angular velocity of the hand"),
                    field("coupling", &T::coupling, "virtual coupling between hand and element"));
}

} // namespace filasofia::physics
