#pragma once

#include "filasofia/math/pose.h"

/// One step of a rigid body. Its rotation follows the midpoint Lie algorithm (Austin, Krishnaprasad and Wang 1993; in
/// the form of Krysl 2005): the body rotates with the velocity that follows from the angular momentum at the middle of
/// the step. The momentum's direction is therefore kept to rounding in steps of up to about two radians, and its
/// magnitude in steps of any size: the energy stays within the bounds that the largest and the smallest moment of
/// inertia set, and in small steps it does not drift.
namespace filasofia::engine {

/// The inertia, loads and damping of one element.
struct RigidLoad {
    double mass = 1.0;           ///< [kg]
    Mat3 inertia;                ///< [kg m^2] about the centre of mass, along the element's axes
    Vec3 force;                  ///< [N] at the centre of mass, in world axes
    Vec3 torque;                 ///< [N m] in world axes
    Vec3 gravity;                ///< [m/s^2]
    double linearDamping = 0.0;  ///< [1/s]
    double angularDamping = 0.0; ///< [1/s]
};

struct RigidChange {
    Vec3 linear;  ///< [m/s]
    Vec3 angular; ///< [rad/s]
};

/// Returns the change from the velocities at the start of a step to those of unconstrained motion. Damping is implicit:
/// v' = (v + h a) / (1 + h c).
RigidChange freeChange(const RigidLoad& load, Quat orientation, Vec3 velocity, Vec3 angularVelocity, double dt);

/// The angular velocity at the end of a step that rotated with `angularVelocity`: by then the body's axes have turned
/// by the second half of the step relative to the angular momentum. `orientation` is that at the end.
Vec3 turnedVelocity(const Mat3& inertia, Quat orientation, Vec3 angularVelocity, double dt);

/// The pose after moving for dt [s]: an exact rotation about the point `centre`, which is in the pose's own coordinates
/// and moves with `velocity`.
Pose moved(const Pose& pose, Vec3 centre, Vec3 velocity, Vec3 angularVelocity, double dt);

/// The constant velocities of the pose's origin that lead from one pose to another in dt > 0, by the shorter rotation.
RigidChange velocitiesBetween(const Pose& from, const Pose& to, double dt);

} // namespace filasofia::engine
