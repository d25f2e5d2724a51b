#pragma once

#include "filasofia/engine/scene/scene.h"
#include "filasofia/engine/scene/step_context.h"

namespace filasofia::engine {

/// The curvature of steered rods comes nearer to what was commanded.
void steerRods(const StepContext& context, Scene& scene);

} // namespace filasofia::engine
