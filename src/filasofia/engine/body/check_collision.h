#pragma once

#include "filasofia/engine/body/rigid_model.h"
#include "filasofia/engine/body/soft_model.h"

namespace filasofia::engine {

/// Throws an Error beginning with `object` unless contacts can be found on the body's surfaces.
void checkCollision(const std::string& object, const SoftModel& body);
void checkCollision(const std::string& object, const RigidModel& body);

} // namespace filasofia::engine
