#pragma once

#include "filasofia/engine/scene/scene.h"
#include "filasofia/engine/topology/edit_collision.h"

namespace filasofia::engine {

/// Brings a body's surface in line with an edit of its mesh: triangles that are gone, others that have other nodes, new
/// ones behind. The model has its new nodes already. What became of the surface, by nodes and by vertices.
OwnSurfaceEdit followSurface(const frame::TopologyEdit& edit, BodyTopology& topology, SoftModel& model);

/// Takes the triangles of these elements off the surface. What became of it.
OwnSurfaceEdit takeOffSurface(const std::vector<char>& elements, BodyTopology& topology, SoftModel& model);

/// Carries what became of the surface into the collision models that are the body's own surface.
void editOwnCollision(const OwnSurfaceEdit& surface, SoftModel& model, Scene& scene);

} // namespace filasofia::engine
