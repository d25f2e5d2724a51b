#pragma once

#include "filasofia/frame/frame.h"
#include "filasofia/physics/defs.h"

#include <optional>

/// Points of bodies that tasks and sensors look at.
namespace filasofia::prefab {

/// [m] The middle of a body: the mean of a soft one's nodes, the origin of a rigid one's first element. None if the
/// frame does not have the body.
std::optional<Vec3> middleOf(const frame::Frame& frame, BodyId id);

/// How many nodes a soft body or a rod has before it is cut.
std::size_t nodeCount(const physics::BodyDef& def);

} // namespace filasofia::prefab
