#pragma once

#include "filasofia/engine/body/soft_model.h"
#include "filasofia/engine/soft/mesh_edit.h"

#include <vector>

namespace filasofia::engine {

/// The elements, springs and triangles that pull at hard-pinned nodes, from which the reactions of pins are computed,
/// and the number of pin groups per node.
struct PinnedParts {
    std::vector<int> elements, springs, membranes, bends;
    std::vector<int> volumes; ///< the elements around the nodes of `elements`, if nodes share their volumes
    std::vector<int> holders; ///< per node: number of hard pin groups; empty if no node is pinned hard
};

PinnedParts pinnedParts(const SoftModel& model);

/// Updates them after an edit.
void updatePinnedParts(const SoftModel& model, const MeshEdit& edit, PinnedParts& parts);

/// Lists the volumes again after a change of the tissue.
void listVolumes(const SoftModel& model, PinnedParts& parts);

} // namespace filasofia::engine
