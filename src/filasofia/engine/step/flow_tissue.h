#pragma once

#include "filasofia/engine/scene/scene.h"
#include "filasofia/engine/scene/step_context.h"

namespace filasofia::engine {

/// Tissue that bears more than its yield stress at the end of a step gets a new shape at rest.
void flowTissue(const StepContext& context, Scene& scene);

} // namespace filasofia::engine
