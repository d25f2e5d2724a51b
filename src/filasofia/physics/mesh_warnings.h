#pragma once

#include "filasofia/physics/defs.h"

namespace filasofia::physics {

/// Warns if the mesh of a soft body, which loaded() has read, or the line of a rod can hardly be what was meant: if it
/// is very large, or in pieces, or open along doubled nodes, if a collision mesh is elsewhere or in other units, if a
/// proximity or a thickness is more than a quarter of it, or if the rod's edges are very short or very twisted.
void warnOfMesh(const BodyDef& def);

} // namespace filasofia::physics
