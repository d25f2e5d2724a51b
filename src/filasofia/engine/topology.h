#pragma once

#include "filasofia/engine/rupture/editable_mesh.h"
#include "filasofia/engine/soft_system.h"
#include "filasofia/frame/boundary.h"

namespace filasofia::engine {

/// What a body that may be cut is besides its model: the mesh as edits know it, and what follows it triangle by
/// triangle. Elements have the same numbers there and in the model.
struct BodyTopology {
    std::unique_ptr<EditableMesh> mesh;              ///< none: it is never edited
    std::vector<std::array<int, 4>> boundaryPlaces;  ///< per element and face, in the boundary; -1: inside
    std::vector<std::array<int, 2>> boundaryFaces;   ///< per triangle of the boundary: its element and face
    std::shared_ptr<const frame::Boundary> boundary; ///< as everyone outside sees it
    std::shared_ptr<const SoftModel> start;          ///< what it was before the first edit
};
using Topologies = std::vector<BodyTopology>; ///< one per soft body, in the model's order

/// Nothing but for a body with dynamicTopology.
BodyTopology makeTopology(const SoftModel& model);

/// Brings all that is kept of a body in line with an edit of its mesh, once: nodes, elements, masses, pins, surface,
/// state and solver. Momentum is kept. Attachments and contacts are followed elsewhere.
void applyEdit(const frame::TopologyEdit& edit, double period, BodyTopology& topology, SoftModel& model,
               SoftState& state, SoftSystem& system);

} // namespace filasofia::engine
