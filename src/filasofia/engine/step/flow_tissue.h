#pragma once

#include "filasofia/engine/scene/scene.h"
#include "filasofia/engine/scene/step_context.h"

namespace filasofia::engine {

/// Tissue that bears more than its yield stress at the end of a step gets a new shape at rest, and so do rods that are
/// bent beyond their yield strain.
void flowTissue(const StepContext& context, Scene& scene);

} // namespace filasofia::engine
