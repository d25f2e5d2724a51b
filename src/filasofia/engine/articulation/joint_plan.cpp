#include "filasofia/engine/articulation/joint_plan.h"

#include "filasofia/math/world_inertia.h"
#include "filasofia/physics/limits.h"

#include <cmath>

namespace filasofia::engine {
namespace {

using physics::JointForce;
using physics::JointPosition;

std::vector<LinkMass> massesOf(std::span<const physics::RigidInertia> inertias, std::span<const Pose> poses)
{
    std::vector<LinkMass> masses;
    for (std::size_t e = 0; e < poses.size(); ++e) {
        const physics::RigidInertia& own = inertias[e];
        masses.push_back({own.mass, transform(poses[e], own.centre), worldInertia(own.inertia, poses[e].orientation)});
    }
    return masses;
}

/// [N m] or [N] The force on a free joint: its command and the wrenches on the links that it moves.
double givenForce(const JointedBody& body, const LinkLoads& loads, const std::vector<LinkMass>& masses,
                  const JointPlan& plan, int joint)
{
    double force = 0.0;
    if (!isOfBase(body.tree, joint))
        if (const auto* given = std::get_if<JointForce>(&body.joints[static_cast<std::size_t>(joint)].command))
            force = given->value; // a spring is a constraint (addJointConstraints)
    for (std::size_t link = 0; link < masses.size(); ++link) {
        const Wrench& wrench = loads.wrenches[link];
        if (wrench == Wrench{} || !moves(body.tree, joint, static_cast<int>(link))) continue;
        force += forceOn(body.tree, plan.axes, joint, static_cast<int>(link), masses[link].centre, wrench.force,
                         wrench.torque);
    }
    return force;
}

/// Whether joint j mimics a free joint.
bool followsFree(const LinkTree& tree, const JointPlan& plan, std::size_t j)
{
    const int other = tree.joints[j].mimics;
    return other >= 0 && plan.place[static_cast<std::size_t>(other)] >= 0;
}

/// Moves the joints that follow others: those of a free joint are at their start, as that one is.
void planMimics(const JointedBody& body, double dt, JointPlan& plan)
{
    for (std::size_t j = 0; j < body.joints.size(); ++j) {
        const LinkJoint& joint = body.tree.joints[j];
        if (joint.mimics < 0) continue;
        const auto other = static_cast<std::size_t>(joint.mimics);
        if (followsFree(body.tree, plan, j)) {
            plan.velocities[j] = joint.multiplier * plan.velocities[other];
        } else {
            plan.ends[j] = joint.multiplier * plan.ends[other] + joint.offset;
            plan.velocities[j] = dt > 0.0 ? (plan.ends[j] - body.joints[j].now.position) / dt : 0.0;
        }
    }
}

} // namespace

JointPlan planMotion(const JointedBody& body, double dt)
{
    JointPlan out;
    out.axes = jointAxes(body.tree, body.poses);
    out.ends = positionsOf(body.joints);
    out.place.assign(body.joints.size(), -1);
    for (std::size_t j = 0; j < body.joints.size(); ++j) {
        const DrivenJoint& joint = body.joints[j];
        if (body.tree.joints[j].mimics >= 0) {
            out.velocities.push_back(0.0); // planMimics() finds it
        } else if (physics::isByForce(joint.command)) {
            out.place[j] = static_cast<int>(out.free.size());
            out.free.push_back(static_cast<int>(j));
            out.velocities.push_back(joint.now.velocity);
        } else {
            out.ends[j] = positionAfter(body.tree.joints[j], joint.now.position,
                                        std::get<JointPosition>(joint.command).value, dt);
            out.velocities.push_back(dt > 0.0 ? (out.ends[j] - joint.now.position) / dt : 0.0);
        }
    }
    planMimics(body, dt, out);
    out.freeBase = body.freeBase;
    if (!out.freeBase) return out;
    for (int k = 0; k < kBaseJoints; ++k) out.free.push_back(static_cast<int>(body.joints.size()) + k);
    for (const Vec3& v : {body.base.linear, body.base.angular})
        out.velocities.insert(out.velocities.end(), {v.x, v.y, v.z});
    return out;
}

void planFree(const JointedBody& body, const LinkLoads& loads, const LinkMotion& base, double dt, JointPlan& plan)
{
    const std::vector<LinkMass> masses = massesOf(loads.inertias, body.poses);
    std::vector<double> accelerations(body.joints.size());
    for (std::size_t j = 0; j < accelerations.size(); ++j)
        if (plan.place[j] < 0 && !followsFree(body.tree, plan, j))
            accelerations[j] = (plan.velocities[j] - body.joints[j].now.velocity) / dt;
    const LinkMotion gaining{1.0 / dt * (base.linear - body.base.linear), // zero if the base is free
                             1.0 / dt * (base.angular - body.base.angular)};
    std::vector<double> forces;
    for (const int joint : plan.free) forces.push_back(givenForce(body, loads, masses, plan, joint));
    plan.step = planJoints({body.tree, plan.axes, body.poses, masses, plan.velocities, accelerations, base, gaining},
                           {.free = plan.free,
                            .forces = forces,
                            .gravity = loads.gravity,
                            .freeBase = plan.freeBase,
                            .linearDamping = loads.linearDamping,
                            .angularDamping = loads.angularDamping},
                           dt);
}

bool moveJoints(const LinkTree& tree, const JointPlan& plan, std::span<const double> change, double dt,
                std::span<DrivenJoint> joints)
{
    for (std::size_t j = 0; j < joints.size(); ++j) {
        if (plan.place[j] < 0) {
            if (!followsFree(tree, plan, j)) joints[j].now = {plan.ends[j], plan.velocities[j]};
            continue;
        }
        const double velocity = plan.velocities[j] + change[static_cast<std::size_t>(plan.place[j])];
        if (!(std::abs(velocity) < physics::kFarthest)) return false;
        joints[j].now = moved(tree.joints[j], joints[j].now.position, velocity, dt);
        for (const int each : tree.followers[j]) {
            const LinkJoint& follower = tree.joints[static_cast<std::size_t>(each)];
            joints[static_cast<std::size_t>(each)].now = {follower.multiplier * joints[j].now.position +
                                                              follower.offset,
                                                          follower.multiplier * joints[j].now.velocity};
        }
    }
    return true;
}

std::vector<double> positionsOf(std::span<const DrivenJoint> joints)
{
    std::vector<double> positions;
    for (const DrivenJoint& joint : joints) positions.push_back(joint.now.position);
    return positions;
}

} // namespace filasofia::engine
