#pragma once

#include "filasofia/engine/contact/coupling.h"

namespace filasofia::engine {

/// Computes new velocities and positions: bodies that constraints connect are solved together, the others each by
/// itself. A body whose new state is not finite is put back, at rest, and its step made again with damping; if that
/// fails too, the body stays where it is. The impulses stay in the constraints.
void advance(const StepContext& context, Scene& scene, Coupling& coupling);

} // namespace filasofia::engine
