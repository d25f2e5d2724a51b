#include "filasofia/sofa/rigid_plan.h"

#include "filasofia/core/validate.h"

namespace filasofia::sofaengine {

RigidPlan planRigid(const physics::RigidBodyDef& def)
{
    constexpr const char* lacks = " is not available with the engine 'sofa'";
    const std::string object = describeBody(physics::BodyDef{def});
    validate(def, object);
    check(physics::BodyDef{def});
    if (!def.articulation.joints.empty()) fail(object, ": articulation", lacks);
    if (def.needle) fail(object, ": needle", lacks);
    if (!def.attachments.empty()) fail(object, ": attachments", lacks);
    if (def.dynamic && def.linearDamping != def.angularDamping)
        fail(object, ": an angularDamping that differs from linearDamping", lacks, ", got ", def.angularDamping,
             " and ", def.linearDamping);
    return {.def = def, .inertia = inertiaOf(def), .collision = planCollision(def, object)};
}

} // namespace filasofia::sofaengine
