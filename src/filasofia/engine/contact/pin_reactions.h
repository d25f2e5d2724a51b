#pragma once

#include "filasofia/engine/constraint/constraint.h"
#include "filasofia/engine/scene/scene.h"

#include <span>

namespace filasofia::engine {

/// Adds to the scene's reported attachments what every group of pins did in the step of dt [s].
void addPinReactions(double dt, std::span<const Constraint> constraints, Scene& scene);

} // namespace filasofia::engine
