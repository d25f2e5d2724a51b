#include "filasofia/engine/articulation/def_tree.h"

#include <cmath>
#include <limits>
#include <utility>

namespace filasofia::engine {

LinkTree treeOf(const physics::ArticulationDef& def)
{
    std::vector<LinkJoint> joints;
    for (std::size_t j = 0; j < def.joints.size(); ++j) {
        const physics::JointDef& joint = def.joints[j];
        const physics::JointLimits limits = physics::limitsOf(def.joints, j);
        joints.push_back({.prismatic = joint.kind == physics::JointKind::Prismatic,
                          .axis = normalized(joint.axis),
                          .parent = joint.parent,
                          .child = joint.child,
                          .parentOffset = physics::unitPose(joint.parentOffset, "parentOffset"),
                          .childOffset = physics::unitPose(joint.childOffset, "childOffset"),
                          .lower = limits.lower,
                          .upper = limits.upper,
                          .start = physics::startOf(def.joints, j),
                          .startVelocity = joint.velocity,
                          .speed = joint.speed,
                          .damping = joint.damping,
                          .friction = joint.friction,
                          .inertia = joint.inertia});
    }
    for (std::size_t j = 0; j < joints.size(); ++j) {
        const auto& mimic = def.joints[j].mimic;
        if (!mimic) continue;
        LinkJoint& own = joints[j];
        LinkJoint& other = joints[static_cast<std::size_t>(mimic->joint)];
        own.mimics = mimic->joint;
        own.multiplier = mimic->multiplier;
        own.offset = mimic->offset;
        own.startVelocity = own.multiplier * other.startVelocity;
        own.lower = -std::numeric_limits<double>::infinity(); // the other one's are narrowed in place of these
        own.upper = std::numeric_limits<double>::infinity();
        // What resists its motion resists that of the other one, by the ratio of their velocities.
        other.damping += own.multiplier * own.multiplier * own.damping;
        other.inertia += own.multiplier * own.multiplier * own.inertia;
        other.friction += std::abs(own.multiplier) * own.friction;
    }
    return linkTree(std::move(joints));
}

std::vector<physics::JointCommand> startCommands(const physics::ArticulationDef& def)
{
    std::vector<physics::JointCommand> commands;
    for (std::size_t j = 0; j < def.joints.size(); ++j)
        commands.push_back(def.joints[j].command.value_or(physics::JointPosition{physics::startOf(def.joints, j)}));
    return commands;
}

} // namespace filasofia::engine
