#pragma once

#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/geometry/triangle_mesh.h"
#include "filasofia/math/vec3.h"

#include <span>
#include <string>

namespace filasofia::surface {

/// Rings of equally many points around places on a path.
struct Rings {
    std::span<const Vec3> middles, points; ///< [m]
};

/// Throws an Error that begins with `object` if rings of this radius lie nowhere along their path at the wall around
/// it, which is the first surface that is seen from the middles towards the points. In solid tissue they may lie
/// anywhere inside it. Where the wall is open, as at an end of a tube, nothing is measured.
void checkRadius(double radius, const Rings& rings, const geometry::TetMesh& mesh,
                 std::span<const geometry::Triangle> skin, const std::string& object);

} // namespace filasofia::surface
