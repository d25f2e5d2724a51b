#pragma once

#include "filasofia/math/vec3.h"

#include <array>
#include <span>
#include <vector>

namespace filasofia::engine {

/// Divides the nodes of a mesh into clusters of at most linalg::kPieceNodes, along its shortest edges first: the
/// shorter an edge is, the stiffer it couples its ends. So clusters of thin tissue reach through its thickness. `edges`
/// may have duplicates; nodes that are not `active` are in no cluster, nor are those without an edge to another.
std::vector<std::vector<int>> nodeClusters(std::span<const Vec3> rest, std::span<const std::array<int, 2>> edges,
                                           const std::vector<bool>& active);

} // namespace filasofia::engine
