#pragma once

#include "filasofia/engine/scene/scene.h"

/// The attached points of an attachment's Def in the current state.
namespace filasofia::engine {

/// Whether a body's Def fixes it in space by pins.
inline bool isPins(const physics::AttachmentDef& def) { return !def.to && def.breakForce == physics::kNever; }

/// A point of soft body `body` (an index), where it is and how it moves.
BodyPoint softPoint(const std::vector<NodeWeight>& nodes, std::size_t body, const SoftState& state);
/// The same, into a point that nothing was written to.
void writeSoftPoint(const std::vector<NodeWeight>& nodes, std::size_t body, const SoftState& state, BodyPoint& out);
/// The nodes and weights of a point of a soft body.
std::vector<NodeWeight> nodeWeights(const BodyPoint& point);

/// The nodes that are listed, in the box or in the ball; ascending, each once.
std::vector<int> nodesOf(const physics::AttachmentDef& def, std::span<const Vec3> x);

/// The points of soft body `body` (an index) that are attached, and the points they are attached to; empty if no node
/// is in the regions. The other body must exist. Pieces that were removed take no part on either side.
AttachedPairs pairsOf(const physics::AttachmentDef& def, std::size_t body, const Scene& scene);
/// The same for a rigid body.
AttachedPairs pairsOf(const physics::RigidAttachmentDef& def, std::size_t body, const Scene& scene);

} // namespace filasofia::engine
