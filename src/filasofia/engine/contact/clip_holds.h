#pragma once

#include "filasofia/engine/scene/scene.h"
#include "filasofia/physics/step.h"

/// How a clip, a rigid body, hangs on the tissue that is between its legs.
namespace filasofia::engine {

/// The points at which the rigid body, at this pose, hangs on the tissue: the middles of those pairs that are nearest
/// to the corners of its legs; fewer if one is nearest to several. Notes which pairs they are.
AttachedPairs holdPoints(const Pose& pose, const SoftState& tissue, Clip& clip);

/// After the pairs have followed an edit of the mesh, the rigid bodies hang on their middles again.
void followHolds(std::span<const Clip> clips, std::vector<Attachment>& attachments);

/// Lets go of nodes that are gone for good: the pairs that had one, and the points at which a clip hung on one. A clip
/// that has no pair left is gone: it is counted as slipped, with a warning in the log.
void forgetClipNodes(const std::vector<bool>& gone, SoftBody& body, Scene& scene, physics::StepReport& report);

} // namespace filasofia::engine
