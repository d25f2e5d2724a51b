#pragma once

#include "filasofia/engine/articulation/joint_step.h"
#include "filasofia/physics/commands.h"
#include "filasofia/physics/defs.h"

#include <span>
#include <vector>

/// The step of a body with joints, before constraints: what both engines make of its joints' commands.
namespace filasofia::engine {

/// A joint's command, and its motion in the last step.
struct DrivenJoint {
    physics::JointCommand command;
    JointMotion now;
};

/// A body with joints at the start of a step.
struct JointedBody {
    const LinkTree& tree;
    std::span<const DrivenJoint> joints;
    std::span<const Pose> poses; ///< per link
    LinkMotion base;             ///< that of the last step
    bool freeBase = false;
};
/// What its links weigh and what acts on them.
struct LinkLoads {
    std::span<const physics::RigidInertia> inertias;
    std::span<const Wrench> wrenches;
    Vec3 gravity;                ///< [m/s^2]
    double linearDamping = 0.0;  ///< [1/s] counts if the base is free
    double angularDamping = 0.0; ///< [1/s] the same
};

/// The motion of the joints in a step.
struct JointPlan {
    std::vector<JointAxis> axes;    ///< per joint: its axis at the start of the step
    std::vector<double> velocities; ///< [rad/s] or [m/s] per joint: throughout the step; at its start if the joint is
                                    ///< free. The six velocities of a free base follow
    std::vector<double> ends; ///< [rad] or [m] per joint: at the end of the step; at its start if the joint is free
    std::vector<int> free;    ///< the free joints, ascending
    std::vector<int> place;   ///< per joint: its index in `free`; -1: not free
    bool freeBase = false;    ///< the base is free: its six degrees of freedom are the last of `free`
    JointStep step;           ///< that of the free joints
};

/// Finds the free joints and all velocities of a step of dt [s] >= 0. The step of the free joints is left to
/// planFree().
JointPlan planMotion(const JointedBody& body, double dt);

/// Plans the step of the free joints. `base`: the base's motion in this step, without constraints.
void planFree(const JointedBody& body, const LinkLoads& loads, const LinkMotion& base, double dt, JointPlan& plan);

/// Moves the joints by a plan, with this change of the free joints' velocities. False, with some joints moved, if a
/// velocity is not finite or beyond physics::kFarthest.
bool moveJoints(const LinkTree& tree, const JointPlan& plan, std::span<const double> change, double dt,
                std::span<DrivenJoint> joints);

/// The positions of these joints.
std::vector<double> positionsOf(std::span<const DrivenJoint> joints);

} // namespace filasofia::engine
