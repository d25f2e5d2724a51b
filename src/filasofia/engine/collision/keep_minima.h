#pragma once

#include "filasofia/engine/collision/surface_pair.h"

#include <vector>

namespace filasofia::engine {

/// Of the minima in scratch.parts, appends those that count: decides which points are inside, drops what is there
/// twice and what is too far. `sides`: of the last step; those of this one are added to scratch.nextSides.
void keepMinima(const Meeting& meeting, const std::vector<SideKept>& sides, ProximityScratch& scratch,
                std::vector<Proximity>& found);

} // namespace filasofia::engine
