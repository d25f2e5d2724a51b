#pragma once

#include "filasofia/engine/scene/scene.h"
#include "filasofia/engine/topology/edit_collision.h"

namespace filasofia::engine {

/// Adds what was refused, put off and left for later.
void add(const RuptureReport& from, physics::TopologyReport& to);

/// Brings all that is kept of a body in line with an edit of its mesh, once: nodes, elements, masses, pins, surface,
/// state and solver. Momentum is kept. Attachments and contacts are followed elsewhere; for these,
/// what became of the surface.
OwnSurfaceEdit applyEdit(const frame::TopologyEdit& edit, double period, SoftBody& body);

} // namespace filasofia::engine
