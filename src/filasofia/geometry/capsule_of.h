#pragma once

#include "filasofia/geometry/triangle_mesh.h"

#include <array>
#include <optional>

namespace filasofia::geometry {

/// All points within `radius` [m] of a line; a ball if its ends [m] coincide.
struct Capsule {
    std::array<Vec3, 2> ends = {};
    double radius = 0.0;
};

/// The ball or capsule that a surface stands for: all vertices lie on it, and no triangle's middle is deeper inside
/// than 6 % of its radius. None if there is no such, or if the surface is inside out. The mesh must pass check() and be
/// closed.
std::optional<Capsule> capsuleOf(const TriangleMesh& mesh);

} // namespace filasofia::geometry
