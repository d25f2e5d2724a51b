#pragma once

#include "filasofia/engine/collision/surface_pair.h"

#include <vector>

namespace filasofia::engine {

/// Appends the minima in scratch.parts that count: decides which points are inside, and drops duplicates and minima
/// that are too far. `sides` are those of the last step; those of this step are appended to scratch.nextSides.
void keepMinima(const Meeting& meeting, const std::vector<SideKept>& sides, ProximityScratch& scratch,
                std::vector<Proximity>& found);

} // namespace filasofia::engine
