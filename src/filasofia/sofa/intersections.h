#pragma once

#include "filasofia/physics/step.h"
#include "filasofia/sofa/sofa_scene.h"

namespace filasofia::sofaengine {

/// Pairs of bodies that may collide and whose surfaces pass through each other, ascending: SOFA's detection has lost
/// them. Surfaces are where the last step began. Bodies that are tied to each other do not count, nor a body's own
/// surface.
std::vector<physics::Intersection> intersectionsOf(const SofaScene& scene);

} // namespace filasofia::sofaengine
