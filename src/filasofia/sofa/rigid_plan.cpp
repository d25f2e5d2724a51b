#include "filasofia/sofa/rigid_plan.h"

#include "filasofia/core/validate.h"
#include "filasofia/engine/rupture/stroke.h"
#include "filasofia/sofa/lacks.h"

#include <algorithm>

namespace filasofia::sofaengine {

bool isDriven(const physics::RigidBodyDef& def)
{
    const auto byForce = [](const physics::JointDef& joint) {
        return joint.command && physics::isByForce(*joint.command);
    };
    const auto& joints = def.articulation.joints;
    return !joints.empty() && (def.dynamic || std::ranges::any_of(joints, byForce));
}

RigidPlan planRigid(const physics::RigidBodyDef& def)
{
    const std::string object = describeBody(physics::BodyDef{def});
    validate(def, object);
    check(physics::BodyDef{def});
    if (def.needle) fail(object, ": needle", kLacks);
    for (const physics::JointDef& joint : def.articulation.joints)
        if (joint.command && std::holds_alternative<physics::JointSpring>(*joint.command))
            fail(object, ": JointSpring", kLacks);
    const bool jointed = !def.articulation.joints.empty();
    if (def.dynamic && !jointed && def.linearDamping != def.angularDamping)
        fail(object, ": an angularDamping that differs from linearDamping", kLacks, ", got ", def.angularDamping,
             " and ", def.linearDamping);
    RigidPlan plan{.def = def, .collision = planCollision(def, object)};
    if (jointed)
        plan.links = linkInertias(def);
    else
        plan.inertia = inertiaOf(def);
    plan.def.elements = elementPoses(def);
    for (const CollisionPlan& each : plan.collision)
        plan.lines.push_back(each.def.cutting ? engine::cuttingEdges(each.mesh) : std::vector<std::array<int, 2>>{});
    return plan;
}

} // namespace filasofia::sofaengine
