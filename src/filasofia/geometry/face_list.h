#pragma once

#include "filasofia/geometry/tet_mesh.h"

namespace filasofia::geometry {

/// One face of one tetrahedron, identified by its sorted nodes, which are the same for both tetrahedra of the face.
struct Face {
    std::array<int, 3> nodes; ///< ascending
    int tetrahedron = 0;
    int side = 0;      ///< place in kTetrahedronFaces
    bool even = false; ///< true if `nodes` is an even permutation of the face as its tetrahedron orients it
};

/// All faces of all tetrahedra, sorted by nodes, then tetrahedron, so that two coincident faces are adjacent.
/// Every tetrahedron must name nodes of the mesh.
std::vector<Face> sortedFaces(const TetMesh& mesh);

} // namespace filasofia::geometry
