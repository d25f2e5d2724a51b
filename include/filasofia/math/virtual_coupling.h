#pragma once

#include "filasofia/math/pose.h"

#include <limits>

/// A spring and a damper in all six directions between a haptic device's end effector and a body (the virtual coupling
/// of Colgate, Stanley and Brown 1995). The physics step and the device's servo loop compute the same law, each at its
/// own rate.
namespace filasofia {

struct VirtualCoupling {
    double linearStiffness = 500.0;                               ///< [N/m], >= 0
    double linearDamping = 2.0;                                   ///< [N s/m], >= 0
    double angularStiffness = 0.5;                                ///< [N m/rad], >= 0
    double angularDamping = 2e-3;                                 ///< [N m s/rad], >= 0
    double forceLimit = std::numeric_limits<double>::infinity();  ///< [N], > 0, upper bound of the force
    double torqueLimit = std::numeric_limits<double>::infinity(); ///< [N m], > 0, upper bound of the torque

    friend constexpr bool operator==(const VirtualCoupling&, const VirtualCoupling&) = default;
};
constexpr auto fields(const VirtualCoupling*)
{
    using T = VirtualCoupling;
    return describe(
        "VirtualCoupling",
        field("linearStiffness", &T::linearStiffness, "N/m", nonNegative(), "stiffness of the linear spring"),
        field("linearDamping", &T::linearDamping, "N s/m", nonNegative(), "damping of the linear damper"),
        field("angularStiffness", &T::angularStiffness, "N m/rad", nonNegative(), "stiffness of the angular spring"),
        field("angularDamping", &T::angularDamping, "N m s/rad", nonNegative(), "damping of the angular damper"),
        field("forceLimit", &T::forceLimit, "N", positiveOrInfinite(), "upper bound of the force"),
        field("torqueLimit", &T::torqueLimit, "N m", positiveOrInfinite(), "upper bound of the torque"));
}

/// The motion of a rigid thing, seen at one of its points.
struct MotionState {
    Pose pose = {};            ///< position of the point [m] and orientation of the thing
    Vec3 velocity = {};        ///< [m/s] velocity of the point
    Vec3 angularVelocity = {}; ///< [rad/s] in world axes

    friend constexpr bool operator==(const MotionState&, const MotionState&) = default;
};

struct CouplingForce {
    Vec3 force = {};  ///< [N] at the coupled point, in world axes
    Vec3 torque = {}; ///< [N m] in world axes

    friend constexpr bool operator==(const CouplingForce&, const CouplingForce&) = default;
};

/// The same motion seen at another point of the thing, given in the thing's coordinates.
constexpr MotionState atPoint(const MotionState& thing, Vec3 point)
{
    const Vec3 arm = rotate(thing.pose.orientation, point);
    return {{thing.pose.position + arm, thing.pose.orientation},
            thing.velocity + cross(thing.angularVelocity, arm),
            thing.angularVelocity};
}

/// [-] The factor that scales a force (or torque) of this size down to `limit`; 1 if it is not larger.
constexpr double limitFactor(double size, double limit) { return size > limit ? limit / size : 1.0; }

/// The force and torque of the coupling on the body, at the coupled point; the hand gets the opposite. The angular
/// spring takes the shorter way round.
inline CouplingForce couplingForce(const VirtualCoupling& coupling, const MotionState& hand, const MotionState& body)
{
    const Vec3 apart = hand.pose.position - body.pose.position;
    const Vec3 turned = rotationVector(hand.pose.orientation * conjugate(body.pose.orientation));
    const Vec3 force = coupling.linearStiffness * apart + coupling.linearDamping * (hand.velocity - body.velocity);
    const Vec3 torque =
        coupling.angularStiffness * turned + coupling.angularDamping * (hand.angularVelocity - body.angularVelocity);
    return {limitFactor(length(force), coupling.forceLimit) * force,
            limitFactor(length(torque), coupling.torqueLimit) * torque};
}

} // namespace filasofia
