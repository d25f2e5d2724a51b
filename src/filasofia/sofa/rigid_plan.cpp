#include "filasofia/sofa/rigid_plan.h"

#include "filasofia/core/validate.h"
#include "filasofia/engine/rupture/stroke.h"
#include "filasofia/sofa/lacks.h"

namespace filasofia::sofaengine {

namespace {

void checkJoints(const physics::RigidBodyDef& def, const std::string& object)
{
    const auto& joints = def.articulation.joints;
    if (!joints.empty() && def.dynamic) fail(object, ": articulation of a dynamic body", kLacks);
    for (std::size_t j = 0; j < joints.size(); ++j)
        if (joints[j].command && std::holds_alternative<physics::JointForce>(*joints[j].command))
            fail(object, ": articulation.joints[", j, "].command JointForce", kLacks, ": give a JointPosition");
}

} // namespace

RigidPlan planRigid(const physics::RigidBodyDef& def)
{
    const std::string object = describeBody(physics::BodyDef{def});
    validate(def, object);
    check(physics::BodyDef{def});
    checkJoints(def, object);
    if (def.needle) fail(object, ": needle", kLacks);
    if (def.dynamic && def.linearDamping != def.angularDamping)
        fail(object, ": an angularDamping that differs from linearDamping", kLacks, ", got ", def.angularDamping,
             " and ", def.linearDamping);
    RigidPlan plan{.def = def, .inertia = inertiaOf(def), .collision = planCollision(def, object)};
    plan.def.elements = elementPoses(def);
    for (const CollisionPlan& each : plan.collision)
        plan.lines.push_back(each.def.cutting ? engine::cuttingEdges(each.mesh) : std::vector<std::array<int, 2>>{});
    return plan;
}

} // namespace filasofia::sofaengine
