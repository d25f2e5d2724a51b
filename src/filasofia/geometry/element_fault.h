#pragma once

#include "filasofia/geometry/tet_mesh.h"

#include <optional>
#include <string>

namespace filasofia::geometry {

/// What is wrong with one tetrahedron (its indices, its numbers, its volume), worded to follow its name in a sentence;
/// empty if it is sound. check() and the file readers share this bound.
std::string elementFault(const TetMesh& mesh, const Tetrahedron& tetrahedron);

/// How many tetrahedra from `first` on are not sound either, as the end of such a sentence; empty if all are.
std::string furtherFaults(const TetMesh& mesh, std::size_t first);

/// Two tetrahedra, the lower index first, that have a face on the same side: one listed twice, or two that overlap.
/// Every element of the mesh must pass elementFault().
std::optional<std::array<int, 2>> sameSidePair(const TetMesh& mesh);

} // namespace filasofia::geometry
