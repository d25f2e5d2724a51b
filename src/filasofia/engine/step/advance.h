#pragma once

#include "filasofia/engine/contact/coupling.h"

namespace filasofia::engine {

/// Computes new velocities and positions: bodies that constraints connect are solved together, the others each by
/// itself. If a soft body's new state is not usable, the body is rolled back, its velocities are cleared, and its step
/// is repeated with more mass; if that fails too, the body stays where it is. The impulses are left in the constraints.
void advance(const StepContext& context, Scene& scene, Coupling& coupling);

} // namespace filasofia::engine
