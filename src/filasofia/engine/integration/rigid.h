#pragma once

#include "filasofia/math/pose.h"

/// One step of a rigid body. Its turning follows the midpoint Lie algorithm (Austin, Krishnaprasad and Wang 1993; in
/// the form of Krysl 2005): the step turns with the velocity that the angular momentum gives in its middle. So the
/// momentum is kept to rounding, in steps of up to about two radians in its direction, too, and in any in its size: the
/// energy cannot leave what the largest and the smallest moment of inertia allow, and in small steps it does not drift.
namespace filasofia::engine {

/// What resists, what acts and what slows down, of one element.
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

/// From the velocities at the start of a step to those with which it moves when nothing is in the way. Damping is
/// implicit: v' = (v + h a) / (1 + h c).
RigidChange freeChange(const RigidLoad& load, Quat orientation, Vec3 velocity, Vec3 angularVelocity, double dt);

/// After a step that turned with `angularVelocity`: the angular velocity at its end, where the axes that the angular
/// momentum meets have turned by the other half of the step. `orientation` is that at the end.
Vec3 turnedVelocity(const Mat3& inertia, Quat orientation, Vec3 angularVelocity, double dt);

/// The pose after moving for dt [s]: an exact turn about the point `centre`, which lies in the pose's own coordinates
/// and moves with `velocity`.
Pose moved(const Pose& pose, Vec3 centre, Vec3 velocity, Vec3 angularVelocity, double dt);

/// Constant velocities of the pose's origin that lead from one pose to another in dt > 0, the short way round.
RigidChange velocitiesBetween(const Pose& from, const Pose& to, double dt);

/// A body's inertia in world axes.
Mat3 worldInertia(const Mat3& inertia, Quat orientation);

} // namespace filasofia::engine
