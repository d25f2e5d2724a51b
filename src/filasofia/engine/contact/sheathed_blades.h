#pragma once

#include "filasofia/engine/rupture/elements_at.h"
#include "filasofia/engine/scene/scene.h"
#include "filasofia/physics/step.h"

#include <span>

/// Blades that are switched off inside tissue. There the blade is partly in its cut, whose walls lie exactly on it, and
/// partly in elements that are not open yet. A wall has no side of the blade then, and contact has no way out of an
/// element: it pushed with up to 1e12 N. So such a blade is *sheathed*: it touches nothing that it could cut until it
/// is out of all of that.
namespace filasofia::engine {

/// The elements of all bodies that a rigid body's blades could cut.
ElementsAtBlade elementsAtBlades(const Scene& scene, const RigidBody& body);

/// Draws blades that are out of the tissue, and counts those that were pushed on into it
/// (physics::TopologyReport::bladeOff).
void followSheaths(Scene& scene, physics::TopologyReport& report);

} // namespace filasofia::engine
