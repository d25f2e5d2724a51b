#pragma once

#include "filasofia/engine/scene/scene.h"

namespace filasofia::engine {

/// Resets every body to the pose, shape and velocity with which it was added. Forces, wrenches, virtual couplings,
/// pressures and materials that were set since then are kept. Bodies that were cut or torn are whole again.
void resetScene(Scene& scene);

} // namespace filasofia::engine
