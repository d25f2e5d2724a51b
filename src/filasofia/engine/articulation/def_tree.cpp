#include "filasofia/engine/articulation/def_tree.h"

#include <utility>

namespace filasofia::engine {

LinkTree treeOf(const physics::ArticulationDef& def)
{
    std::vector<LinkJoint> joints;
    for (const physics::JointDef& joint : def.joints)
        joints.push_back({.prismatic = joint.kind == physics::JointKind::Prismatic,
                          .axis = normalized(joint.axis),
                          .parent = joint.parent,
                          .child = joint.child,
                          .parentOffset = physics::unitPose(joint.parentOffset, "parentOffset"),
                          .childOffset = physics::unitPose(joint.childOffset, "childOffset"),
                          .lower = joint.lower,
                          .upper = joint.upper,
                          .start = joint.start,
                          .startVelocity = joint.velocity,
                          .speed = joint.speed,
                          .damping = joint.damping,
                          .friction = joint.friction,
                          .inertia = joint.inertia});
    return linkTree(std::move(joints));
}

std::vector<physics::JointCommand> startCommands(const physics::ArticulationDef& def)
{
    std::vector<physics::JointCommand> commands;
    for (const physics::JointDef& joint : def.joints)
        commands.push_back(joint.command.value_or(physics::JointPosition{joint.start}));
    return commands;
}

} // namespace filasofia::engine
