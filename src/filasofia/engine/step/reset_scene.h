#pragma once

#include "filasofia/engine/scene/scene.h"

namespace filasofia::engine {

/// Every body where and as it was when it was added, at the start's velocities. Forces, wrenches, couplings, pressures
/// and materials given meanwhile stay given. Bodies that were cut or torn are whole again.
void resetScene(Scene& scene);

} // namespace filasofia::engine
