#pragma once

#include "filasofia/engine/body/rigid_model.h"
#include "filasofia/engine/body/soft_model.h"

namespace filasofia::engine {

/// Throws an Error that begins with `object` if a collision model of the body is invalid.
void checkCollision(const std::string& object, const SoftModel& body);
void checkCollision(const std::string& object, const RigidModel& body);

} // namespace filasofia::engine
