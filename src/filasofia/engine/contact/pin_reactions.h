#pragma once

#include "filasofia/engine/constraint/constraint.h"
#include "filasofia/engine/scene/scene.h"
#include "filasofia/engine/scene/step_context.h"

#include <span>

namespace filasofia::engine {

/// Appends the reaction of every group of pins in the step to the scene's reported attachments.
void addPinReactions(const StepContext& context, std::span<const Constraint> constraints, Scene& scene);

} // namespace filasofia::engine
