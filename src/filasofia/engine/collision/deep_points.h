#pragma once

#include "filasofia/engine/collision/surface_pair.h"

namespace filasofia::engine {

/// Finds the points of side `source` that are inside the other side, which is closed, deeper than findProximities()
/// follows them. Each gets its nearest way out. To be called after findProximities(), for a pair whose boxes overlap.
void findDeepPoints(const Meeting& meeting, int source, std::vector<Proximity>& found);

} // namespace filasofia::engine
