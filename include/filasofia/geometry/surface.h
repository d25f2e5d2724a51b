#pragma once

#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/geometry/triangle_mesh.h"

namespace filasofia::geometry {

/// The boundary of a tetrahedral mesh.
struct Surface {
    TriangleMesh mesh;      ///< vertices are renumbered, in the order of their nodes
    std::vector<int> nodes; ///< the node of each vertex, in ascending order
};

/// The faces that belong to one tetrahedron only, oriented outwards, in the order of the tetrahedra. The mesh must pass
/// check(); its surface is then closed: every edge is traversed as often in one direction as in the other.
Surface extractSurface(const TetMesh& mesh);

} // namespace filasofia::geometry
