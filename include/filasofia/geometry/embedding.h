#pragma once

#include "filasofia/geometry/tet_mesh.h"

#include <span>

namespace filasofia::geometry {

/// Points that move with a tetrahedral mesh: each is a weighted mean of the four nodes of one tetrahedron.
struct Embedding {
    std::vector<Tetrahedron> nodes;             ///< per point, the nodes of its tetrahedron
    std::vector<std::array<double, 4>> weights; ///< per point, barycentric; they sum to 1 and are negative outside
};

/// Embeds every point in the tetrahedron that contains it (weights down to -1e-12 count as inside). If none contains
/// it, the nearest tetrahedron is used: the weights then extrapolate, and grow with the distance divided by the size of
/// that tetrahedron. Ties go to the lowest index. The mesh must pass check() and the points must be finite.
Embedding embed(const TetMesh& mesh, std::span<const Vec3> points);

} // namespace filasofia::geometry
