#pragma once

#include "filasofia/math/pose.h"

#include <limits>

/// A spring and a damper in all six directions between a hand and what it holds: the one law that the physics step and
/// a haptic device's servo loop both compute, each at its own rate.
namespace filasofia {

struct HandCoupling {
    double linearStiffness = 500.0;                               ///< [N/m], >= 0
    double linearDamping = 2.0;                                   ///< [N s/m], >= 0
    double angularStiffness = 0.5;                                ///< [N m/rad], >= 0
    double angularDamping = 2e-3;                                 ///< [N m s/rad], >= 0
    double forceLimit = std::numeric_limits<double>::infinity();  ///< [N], > 0: it pulls no harder
    double torqueLimit = std::numeric_limits<double>::infinity(); ///< [N m], > 0, the same of its turning

    friend constexpr bool operator==(const HandCoupling&, const HandCoupling&) = default;
};
constexpr auto fields(const HandCoupling*)
{
    using T = HandCoupling;
    return describe("HandCoupling",
                    field("linearStiffness", &T::linearStiffness, "N/m", nonNegative(), "of the spring"),
                    field("linearDamping", &T::linearDamping, "N s/m", nonNegative(), "of the damper"),
                    field("angularStiffness", &T::angularStiffness, "N m/rad", nonNegative(), "of the spring"),
                    field("angularDamping", &T::angularDamping, "N m s/rad", nonNegative(), "of the damper"),
                    field("forceLimit", &T::forceLimit, "N", positiveOrInfinite(), "it pulls no harder"),
                    field("torqueLimit", &T::torqueLimit, "N m", positiveOrInfinite(), "it turns no harder"));
}

/// Something that moves, by one of its points.
struct Moving {
    Pose pose = {};            ///< of the point
    Vec3 velocity = {};        ///< [m/s] of the point
    Vec3 angularVelocity = {}; ///< [rad/s] in world axes

    friend constexpr bool operator==(const Moving&, const Moving&) = default;
};

struct CouplingForce {
    Vec3 force = {};  ///< [N] at the point that is held, in world axes
    Vec3 torque = {}; ///< [N m] in world axes

    friend constexpr bool operator==(const CouplingForce&, const CouplingForce&) = default;
};

/// The same seen at another point of the thing, given in its own coordinates.
constexpr Moving atPoint(const Moving& thing, Vec3 point)
{
    const Vec3 arm = rotate(thing.pose.orientation, point);
    return {{thing.pose.position + arm, thing.pose.orientation},
            thing.velocity + cross(thing.angularVelocity, arm),
            thing.angularVelocity};
}

/// [-] by what a spring and damper that would pull with `size` is weakened so that it does not pull harder than limit.
constexpr double weakened(double size, double limit) { return size > limit ? limit / size : 1.0; }

/// What the coupling does to the body that the hand holds, both seen at the point that is held; the hand gets the
/// opposite. Turns go the short way round.
inline CouplingForce couplingForce(const HandCoupling& coupling, const Moving& hand, const Moving& body)
{
    const Vec3 apart = hand.pose.position - body.pose.position;
    const Vec3 turned = rotationVector(hand.pose.orientation * conjugate(body.pose.orientation));
    const Vec3 force = coupling.linearStiffness * apart + coupling.linearDamping * (hand.velocity - body.velocity);
    const Vec3 torque =
        coupling.angularStiffness * turned + coupling.angularDamping * (hand.angularVelocity - body.angularVelocity);
    return {weakened(length(force), coupling.forceLimit) * force,
            weakened(length(torque), coupling.torqueLimit) * torque};
}

} // namespace filasofia
