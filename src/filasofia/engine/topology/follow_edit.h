#pragma once

#include "filasofia/engine/body/body_topology.h"

namespace filasofia::engine {

/// Keeps points that ride on the body's nodes (attachments, clips, channels of needles, collision meshes other than its
/// surface) at their places in the tissue, on the correct side of a cut. Call it before applyEdit(): the points are
/// located in the old model.
void followRiders(const frame::TopologyEdit& edit, const EditableMesh& mesh, SoftModel& soft, std::vector<Clip>& clips,
                  std::vector<Attachment>& attachments, std::vector<Channel>& channels);

} // namespace filasofia::engine
