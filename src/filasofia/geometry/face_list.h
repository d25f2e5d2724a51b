#pragma once

#include "filasofia/geometry/tet_mesh.h"

namespace filasofia::geometry {

/// One face of one tetrahedron, under a name that both its tetrahedra give it.
struct Face {
    std::array<int, 3> nodes; ///< ascending
    int tetrahedron = 0;
    int side = 0;      ///< place in kTetrahedronFaces
    bool even = false; ///< whether `nodes` is an even permutation of the face as its tetrahedron walks it
};

/// All faces of all tetrahedra, ascending by nodes, then tetrahedron: those two that coincide stand side by side.
/// Every tetrahedron must name nodes of the mesh.
std::vector<Face> sortedFaces(const TetMesh& mesh);

} // namespace filasofia::geometry
