#pragma once

#include "filasofia/engine/scene/scene.h"

/// From what an attachment asks for to the points that it holds, at the present state.
namespace filasofia::engine {

using AttachedPairs = std::vector<std::array<AttachedPoint, 2>>;

/// Does a body's Def hold this in space by pins.
inline bool isPins(const physics::AttachmentDef& def) { return !def.to && def.breakForce == physics::kNever; }

/// The nodes that are named, in the box or in the ball; ascending, each once.
std::vector<int> nodesOf(const physics::AttachmentDef& def, std::span<const Vec3> x);

/// What is held of soft body `body` (a place in the list), and where; empty where no node is in the regions. The body
/// that holds is there. Pieces that were removed neither are held nor hold.
AttachedPairs pairsOf(const physics::AttachmentDef& def, std::size_t body, const Scene& scene);
/// The same of a rigid body.
AttachedPairs pairsOf(const physics::RigidAttachmentDef& def, std::size_t body, const Scene& scene);

} // namespace filasofia::engine
