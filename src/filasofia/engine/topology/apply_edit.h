#pragma once

#include "filasofia/engine/scene/scene.h"
#include "filasofia/engine/topology/edit_collision.h"

namespace filasofia::engine {

/// Brings everything that the engine keeps about a body in line with one edit of its mesh: nodes, elements, masses,
/// pins, surface, state and solver. Momentum is conserved. Each edit must be applied once. Attachments and contacts are
/// updated elsewhere; the returned edit of the surface is what they need.
OwnSurfaceEdit applyEdit(const frame::TopologyEdit& edit, double period, SoftBody& body);

} // namespace filasofia::engine
