#pragma once

#include "filasofia/engine/collision/find_proximities.h"

#include <array>
#include <vector>

namespace filasofia::engine {

/// Finds the points and edges of two surfaces, or of a surface and itself, that would pass through each other within
/// `dt` [s] as their vertices move with CollisionSurface::v: the two places that meet first, where they are now. A pair
/// of features of which one is through the other already is left out: it must get apart. So are features that are near
/// each other at rest, of a surface that meets itself. `places`: indices of the surfaces. Bounds them anew. The same
/// for any number of threads.
std::vector<Proximity> findSurfacePasses(double dt, CollisionSurface& one, CollisionSurface& two,
                                         std::array<int, 2> places, ProximityScratch& scratch, WorkerPool& pool);

} // namespace filasofia::engine
