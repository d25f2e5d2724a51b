#include "filasofia/physics/defs.h"

#include "filasofia/core/text.h"

namespace filasofia::physics {

std::string describeBody(const BodyDef& def)
{
    if (const auto* soft = std::get_if<SoftBodyDef>(&def)) return text("soft body '", soft->name, "'");
    return text("rigid body '", std::get<RigidBodyDef>(def).name, "'");
}

} // namespace filasofia::physics
