#pragma once

#include "filasofia/engine/collision/find_proximities.h"

#include <span>
#include <vector>

namespace filasofia::engine {

/// Collects the pairs of elements of two surfaces whose boxes overlap in `scratch.elementPairs`; one surface with
/// itself gives each pair once. Descends both trees at once, the wider box first. To be called after findProximities()
/// or within it. `normals`: those of the surface, to leave out pairs that meet only if it is folded between them; or
/// nullptr. `ownPiece`: per element the box of boundPieces(), by which pairs of one piece must also overlap; or empty.
void collectElementPairs(const CollisionSurface& a, const CollisionSurface& b, const NormalBounds* normals,
                         ProximityScratch& scratch, std::span<const Bounds> ownPiece = {});

/// Makes the boxes of the elements of a body in pieces, each as seen by who moves with its piece; `margin` [m] around
/// the vertices, `reach` [s] as in boundVertices(). None if no piece moves by more than `least` [m] in that time, as
/// seen by who moves with `drift` [m/s]: then the surface's own boxes are as tight.
void boundPieces(const CollisionSurface& surface, double reach, double margin, Vec3 drift, double least,
                 PieceBounds& out);

} // namespace filasofia::engine
