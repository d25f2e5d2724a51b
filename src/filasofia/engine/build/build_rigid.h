#pragma once

#include "filasofia/physics/commands.h"

#include <memory>

namespace filasofia::engine {

/// Builds a rigid body; throws an Error that names body, field, bound and value.
std::unique_ptr<physics::BuiltBody> buildRigid(const physics::RigidBodyDef& def);

} // namespace filasofia::engine
