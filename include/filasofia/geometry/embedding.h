#pragma once

#include "filasofia/geometry/tet_mesh.h"

#include <span>

namespace filasofia::geometry {

/// Points that ride on a tetrahedral mesh: each is a weighted mean of the four nodes of one tetrahedron.
struct Embedding {
    std::vector<Tetrahedron> nodes;             ///< per point, the nodes of its tetrahedron
    std::vector<std::array<double, 4>> weights; ///< per point, barycentric; they sum to 1; negative outside
};

/// Embeds every point in the tetrahedron that holds it (weights down to -1e-12 count as inside), or in the nearest one
/// where none does (then the weights extrapolate, and grow with distance over size of that tetrahedron). Ties go to the
/// lowest index. The mesh is one that check() accepts and the points are finite.
Embedding embed(const TetMesh& mesh, std::span<const Vec3> points);

} // namespace filasofia::geometry
