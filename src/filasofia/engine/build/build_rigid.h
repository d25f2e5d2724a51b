#pragma once

#include "filasofia/physics/commands.h"

#include <memory>

namespace filasofia::engine {

/// Builds a rigid body. Throws an Error that names body, field, bound and value if the Def is invalid.
std::unique_ptr<physics::BuiltBody> buildRigid(const physics::RigidBodyDef& def);

} // namespace filasofia::engine
