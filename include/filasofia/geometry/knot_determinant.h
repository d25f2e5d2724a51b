#pragma once

#include "filasofia/math/vec3.h"

#include <span>
#include <vector>

namespace filasofia::geometry {

/// The determinant of the knot that a closed line forms: 1 if it is none, 3 for a throw of one turn, 5 for one of two,
/// 2 t + 1 for one of t; that of a square knot is the product of its throws'. It is that of the colouring matrix of a
/// projection (Livingston, Knot Theory, 1993): a row for each crossing, a column for each arc from one crossing below
/// to the next. The time grows with the square of the number of points, and the cube of that of crossings.
int knotDeterminant(std::vector<Vec3> line);

/// The same of a line whose ends lie on both sides along `across`: both go on outwards, and meet far above. `across`
/// and `up` are unit vectors at right angles.
int knotDeterminantOpen(std::span<const Vec3> line, Vec3 across, Vec3 up);

} // namespace filasofia::geometry
