#pragma once

#include "filasofia/math/vec3.h"

namespace filasofia::geometry {

/// [sr] The solid angle of a triangle as seen from a point (Van Oosterom and Strackee 1983, equation 8), from -2 pi to
/// 2 pi: positive if its corners are counter-clockwise as seen from the other side. The angles of a closed surface
/// whose normals point outwards add up to 4 pi around a point inside, and to 0 around one outside. It is zero if the
/// point is a corner.
double solidAngle(Vec3 point, Vec3 a, Vec3 b, Vec3 c);

} // namespace filasofia::geometry
