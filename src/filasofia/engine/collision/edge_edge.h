#pragma once

#include "filasofia/engine/collision/surface_pair.h"

#include <vector>

namespace filasofia::engine {

/// Finds the place where two edges are nearest to each other, if it is a local minimum of the distance and near enough.
void collideEdges(const SurfacePair& meeting, int first, int second, std::vector<Proximity>& found);

} // namespace filasofia::engine
