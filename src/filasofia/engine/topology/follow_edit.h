#pragma once

#include "filasofia/engine/body/body_topology.h"

namespace filasofia::engine {

/// Points that ride on the body's nodes (attachments, collision meshes other than its surface) stay where they are in
/// the tissue, on whichever side of a cut that is. Called before applyEdit: they are found by what the model was.
void followRiders(const frame::TopologyEdit& edit, const EditableMesh& mesh, SoftModel& soft,
                  std::vector<Attachment>& attachments);

} // namespace filasofia::engine
