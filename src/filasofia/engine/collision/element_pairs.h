#pragma once

#include "filasofia/engine/collision/find_proximities.h"

namespace filasofia::engine {

/// Collects the pairs of elements of two surfaces whose boxes overlap in `scratch.elementPairs`; one surface with
/// itself gives each pair once. Descends both trees at once, the wider box first. To be called after findProximities()
/// or within it. `normals`: those of the surface, to leave out pairs that meet only if it is folded between them; or
/// nullptr.
void collectElementPairs(const CollisionSurface& a, const CollisionSurface& b, const NormalBounds* normals,
                         ProximityScratch& scratch);

} // namespace filasofia::engine
