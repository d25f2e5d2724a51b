#pragma once

#include "filasofia/engine/contact/contact_surfaces.h"
#include "filasofia/engine/contact/coupling.h"
#include "filasofia/engine/scene/step_context.h"

#include <vector>

namespace filasofia::engine {

/// Reports the pairs of bodies whose surfaces pass through each other (StepReport::intersections). To be called after
/// findProximities(). What two bodies share where they are attached to each other does not
/// count, nor what contacts still follow. Tests at every multiple of 10 ms, more often if what may meet moves fast, and
/// if `changed` tells that surfaces were added or removed. A soft body that does not collide with itself is tested
/// against itself at every multiple of a second, or of 100 ms once it has been cut.
void reportIntersections(const StepContext& context, const Scene& scene, const std::vector<SurfaceOwner>& owners,
                         bool changed, Coupling& coupling);

} // namespace filasofia::engine
