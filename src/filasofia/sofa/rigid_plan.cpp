#include "filasofia/sofa/rigid_plan.h"

#include "filasofia/core/validate.h"
#include "filasofia/sofa/make_tie.h"

namespace filasofia::sofaengine {

RigidPlan planRigid(const physics::RigidBodyDef& def)
{
    constexpr const char* lacks = " is not available with the engine 'sofa'";
    const std::string object = describeBody(physics::BodyDef{def});
    validate(def, object);
    check(physics::BodyDef{def});
    if (!def.articulation.joints.empty()) fail(object, ": articulation", lacks);
    if (def.needle) fail(object, ": needle", lacks);
    for (std::size_t i = 0; i < def.attachments.size(); ++i)
        checkTie(def.attachments[i], text(object, ": attachments[", i, "]"));
    if (def.dynamic && def.linearDamping != def.angularDamping)
        fail(object, ": an angularDamping that differs from linearDamping", lacks, ", got ", def.angularDamping,
             " and ", def.linearDamping);
    return {.def = def, .inertia = inertiaOf(def), .collision = planCollision(def, object)};
}

} // namespace filasofia::sofaengine
