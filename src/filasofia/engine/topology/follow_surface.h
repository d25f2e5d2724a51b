#pragma once

#include "filasofia/engine/scene/scene.h"
#include "filasofia/engine/topology/edit_collision.h"

namespace filasofia::engine {

/// Brings a body's surface in line with an edit of its mesh: triangles are removed or changed, and new ones are
/// appended. The model must have its new nodes already. Returns the change of the surface, by nodes and by vertices.
OwnSurfaceEdit followSurface(const frame::TopologyEdit& edit, BodyTopology& topology, SoftModel& model);

/// Removes the triangles of these elements from the surface and returns the change.
OwnSurfaceEdit takeOffSurface(const std::vector<char>& elements, BodyTopology& topology, SoftModel& model);

/// Applies a change of the surface to the collision models that are the body's own surface.
void editOwnCollision(const OwnSurfaceEdit& surface, SoftModel& model, Scene& scene);

} // namespace filasofia::engine
