#pragma once

#include "filasofia/engine/collision/surface_pair.h"

#include <vector>

namespace filasofia::engine {

/// Finds the local minima of the distance from one point to the features that an element owns (and to its face), within
/// the reach of both.
void collidePoint(const SurfacePair& meeting, int source, int point, int element, std::vector<PointMinimum>& found);

} // namespace filasofia::engine
