#pragma once

#include "filasofia/frame/frame.h"
#include "filasofia/physics/defs.h"

#include <optional>
#include <string>

/// Points of bodies that tasks and sensors look at.
namespace filasofia::prefab {

/// [m] The middle of a body: the mean of a soft one's nodes, the origin of a rigid one's first element. None if the
/// frame does not have the body.
std::optional<Vec3> middleOf(const frame::Frame& frame, BodyId id);

/// [m] The point `tip` of an element of a rigid body; a node of a soft body or a rod, or its middle. None if the frame
/// does not have it.
std::optional<Vec3> pointOf(const frame::Frame& frame, BodyId id, int element, Vec3 tip,
                            const std::optional<int>& node);

/// Throws an Error that begins with `path`, "sensors[0].", unless the body has the element and the node.
void checkBodyPoint(const physics::BodyDef& def, int element, const std::optional<int>& node, const std::string& path);

} // namespace filasofia::prefab
