#pragma once

#include "filasofia/engine/articulation/link_motion.h"

#include <span>
#include <vector>

/// A step of the joints of a tree without constraints. Joints that are told a position move there at their speed. The
/// velocities q' of the free joints, those that forces move, are the unknowns,
///
///     (M + h D) dq' = h (force - D q' - c(q, q' + dq'_0 / 2, base)) + sum of J^T impulse,
///
/// with the mass matrix M, the damping D, the inertial and gravity forces c (inverseDynamics) and the change dq'_0
/// without impulses: semi-implicit Euler in reduced coordinates, with inertial forces in the middle of the step. So the
/// velocities are those between two positions (leapfrog; Hairer, Lubich and Wanner 2006, I.1.4): the step is the same
/// forwards and backwards, and energy and angular momentum do not drift.
namespace filasofia::engine {

/// What drives the free joints besides their own motion.
struct JointDrive {
    std::span<const int> free;      ///< the free joints, ascending; those of a free base are the last
    std::span<const double> forces; ///< [N m] or [N] per free joint
    Vec3 gravity;                   ///< [m/s^2]
    bool freeBase = false;
    double linearDamping = 0.0;  ///< [1/s] slows all links, if the base is free
    double angularDamping = 0.0; ///< [1/s] the same
};
/// The equations of a step, per free joint.
struct JointStep {
    std::vector<double> arms;   ///< [m] factor that turns its velocity into one in [m/s]
    JointMatrix matrix;         ///< M + h D
    JointMatrix inverse;        ///< the inverse of `matrix`
    std::vector<double> change; ///< change of its velocity without constraints
};
/// The velocities of the moving tree are those of all joints, and of the base if it is free; accelerations count for
/// joints that are told a position.
JointStep planJoints(const MovingTree& moving, const JointDrive& drive, double dt);

/// [N] at the arm's length: a stop bears no more. If a body that is told its motion pushes a joint against its stop,
/// both cannot be satisfied: the stop yields, and the joint's position is clamped.
inline constexpr double kMostAtStop = 1000.0;

/// The generalised force of a force and a torque at a link's point on a joint that moves it.
double forceOn(const LinkTree& tree, std::span<const JointAxis> axes, int joint, int link, Vec3 point, Vec3 force,
               Vec3 torque);

struct JointMotion {
    double position = 0.0; ///< [rad] or [m]
    double velocity = 0.0; ///< [rad/s] or [m/s]
};
/// Where a joint that is told a position is after a step of dt [s].
double positionAfter(const LinkJoint& joint, double position, double target, double dt);
/// A free joint after a step with this velocity: it stops at its limits. Not finite if the velocity is not.
JointMotion moved(const LinkJoint& joint, double position, double velocity, double dt);

/// The changes of the links' motion by a change of the free joints' velocities. `poses`: where the links are.
std::vector<LinkMotion> linkChanges(const LinkTree& tree, std::span<const JointAxis> axes, std::span<const Pose> poses,
                                    std::span<const int> free, std::span<const double> change);

} // namespace filasofia::engine
