#pragma once

#include "filasofia/engine/collision/surface_crossings.h"
#include "filasofia/engine/contact/contact_surfaces.h"
#include "filasofia/engine/contact/coupling.h"
#include "filasofia/engine/scene/step_context.h"

#include <span>
#include <vector>

namespace filasofia::engine {

/// Reports the pairs of bodies whose surfaces pass through each other (StepReport::intersections). To be called after
/// findProximities(). What two bodies share where they are attached to each other does not
/// count, nor what contacts still follow. Tests at every multiple of 10 ms, more often if what may meet moves fast, and
/// if `added` is not empty: it tells per surface whether it is new. A soft body that does not collide with itself is
/// tested against itself at every multiple of a second, or of 100 ms once it has been cut. Returns the pairs of
/// surfaces that pass through each other and of which one is new; the report waits for some of them, to see whether
/// they last.
std::vector<std::array<int, 2>> reportIntersections(const StepContext& context, const Scene& scene,
                                                    const std::vector<SurfaceOwner>& owners,
                                                    const std::vector<bool>& added, Coupling& coupling);

/// Every edge of two surfaces, at these places in the list, that passes through a triangle of the other; or of one and
/// itself. To be called after findProximities(), for a pair whose boxes overlap.
void findCrossings(const StepContext& context, std::array<int, 2> pair, ContactDetection& detection,
                   std::vector<SurfaceCrossing>& crossings);

} // namespace filasofia::engine
