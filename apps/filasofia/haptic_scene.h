#pragma once

#include "filasofia/filasofia.h"

namespace filasofia::app {

/// A tool in a scripted hand, or in the user's own, presses a block of tissue without end (examples/11_haptics).
void addHaptics(Simulation& sim, int subdivision);
inline constexpr Box kHapticsRoom = {{-0.032, -0.015, -0.03}, {0.032, 0.06, 0.03}};

} // namespace filasofia::app
