#pragma once

#include "filasofia/geometry/tet_mesh.h"

namespace filasofia::geometry {

/// The mesh with every tetrahedron split into eight, each of an eighth of its volume: four at its corners, similar to
/// it, and four around the shortest diagonal of the octahedron between them (red refinement, Bey 1995). The refined
/// mesh stays conforming, because neighbours split their common face in the same way. Nodes keep their indices; the
/// midpoints of the edges follow, in the order of edges(). The eight stand in the list where their tetrahedron stood.
/// The mesh must pass check().
TetMesh refined(const TetMesh& mesh);

} // namespace filasofia::geometry
