#pragma once

#include "filasofia/geometry/tet_mesh.h"

namespace filasofia::geometry {

/// The mesh with every tetrahedron split into eight of an eighth of its volume: four at its corners, similar to it, and
/// four around the shortest diagonal of the octahedron between them (red refinement, Bey 1995). Faces still meet whole:
/// neighbours split theirs alike. Nodes keep their indices; the middles of the edges follow, in the order of edges().
/// The eight lie where their tetrahedron lay in the list. The mesh is one that check() accepts.
TetMesh refined(const TetMesh& mesh);

} // namespace filasofia::geometry
