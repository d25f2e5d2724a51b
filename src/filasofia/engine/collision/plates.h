#pragma once

#include "filasofia/engine/collision/bounds.h"
#include "filasofia/math/vec3.h"

#include <vector>

namespace filasofia::engine {

struct CollisionSurface;

/// An element in float, in one place of memory: most pairs of elements whose boxes overlap are too far apart for
/// anything, and this tells so in a tenth of the time that a test of their features takes.
struct Plate {
    FourFloats x, y, z; ///< [m] its corners; the fourth, and those that a line or a point lacks, repeat the last
    FourFloats centre;  ///< [m] and, as the fourth, by how much rounding may displace what is computed from it
    FourFloats normal;  ///< [-] unit; 0 if the element is no triangle or has no area
};

/// Writes the surface's plates from its current vertices.
void makePlates(CollisionSurface& surface);
/// Writes those at rest, if its shape is not the one for which they were written last.
void makeRestPlates(CollisionSurface& surface);

/// Whether the line between the centres, or the normal of one of the two, shows that they are farther than `far` [m]
/// from each other. False if a corner is not finite.
bool farApart(const Plate& a, const Plate& b, float far);

/// [m] How far each of two triangles is behind the other, at least: the thickness of a wall of which they are the two
/// sides. <= 0 if they are not, and if a corner is not finite.
float wallBetween(const Plate& a, const Plate& b);

} // namespace filasofia::engine
