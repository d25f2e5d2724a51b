#pragma once

#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/geometry/triangle_mesh.h"

namespace filasofia::geometry {

/// The boundary of a tetrahedral mesh.
struct Surface {
    TriangleMesh mesh;      ///< vertices are numbered anew, in the order of the nodes they are
    std::vector<int> nodes; ///< the node that each vertex is, ascending
};

/// The faces that belong to one tetrahedron only, oriented outwards, in the order of the tetrahedra. The mesh is one
/// that check() accepts; its surface is then closed: every edge is walked as often in one direction as in the other.
Surface extractSurface(const TetMesh& mesh);

} // namespace filasofia::geometry
