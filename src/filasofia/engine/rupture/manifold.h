#pragma once

#include "filasofia/engine/rupture/editable_mesh.h"

#include <array>
#include <vector>

namespace filasofia::engine {

/// The boundary faces at a node as loops of faces that hang together by edges: a manifold has one or none.
using FaceLoop = std::vector<std::array<int, 2>>; ///< tetrahedron and face
std::vector<FaceLoop> boundaryLoops(const MeshTopology& mesh, int node);
/// Are the edge's elements one fan, each next to another by a face at the edge?
bool isOneFan(const MeshTopology& mesh, int a, int b);

} // namespace filasofia::engine
