#pragma once

#include "filasofia/engine/rupture/editable_mesh.h"

#include <array>
#include <vector>

namespace filasofia::engine {

/// The boundary faces at a node, grouped into loops of faces that share edges. A node of a manifold has at most one.
using FaceLoop = std::vector<std::array<int, 2>>; ///< tetrahedron and face
std::vector<FaceLoop> boundaryLoops(const MeshTopology& mesh, int node);
/// True if the edge's elements form one fan, each the neighbour of another through a face at the edge.
bool isOneFan(const MeshTopology& mesh, int a, int b);

} // namespace filasofia::engine
