#pragma once

#include "filasofia/engine/collision/surface_pair.h"

namespace filasofia::engine {

/// Finds the points of side `source` that are inside the other side, which is closed, deeper than findProximities()
/// follows them. Each gets its nearest way out. To be called after findProximities(), for a pair whose boxes overlap.
void findDeepPoints(const SurfacePair& meeting, int source, std::vector<Proximity>& found);

/// Whether two closed surfaces share a place that is deeper in both than findProximities() follows what is inside.
/// Boxes that lie along each other do, though no point and no edge of one is inside the other. Looks below the middles
/// of all triangles, so not everywhere. To be called after findProximities(), for a pair whose boxes overlap.
bool overlapDeep(const SurfacePair& meeting);

} // namespace filasofia::engine
