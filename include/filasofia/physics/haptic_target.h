#pragma once

#include "filasofia/math/hand_coupling.h"

namespace filasofia::physics {

/// Where a hand is that holds a rigid element, at the end of the step, and how firmly it holds: what a haptic device
/// says once a step.
struct HapticTarget {
    Pose pose = {};             ///< of the hand, where the element's origin is to be
    Vec3 velocity = {};         ///< [m/s]
    Vec3 angularVelocity = {};  ///< [rad/s] in world axes
    HandCoupling coupling = {}; ///< between the element's centre of mass and the same point of the hand

    friend constexpr bool operator==(const HapticTarget&, const HapticTarget&) = default;
};
constexpr auto fields(const HapticTarget*)
{
    using T = HapticTarget;
    return describe("HapticTarget", field("pose", &T::pose, "where the hand is"),
                    field("velocity", &T::velocity, "m/s", finite(), "how it moves"),
                    field("angularVelocity", &T::angularVelocity, "rad/s", finite(), "how it turns"),
                    field("coupling", &T::coupling, "how firmly it holds"));
}

} // namespace filasofia::physics
