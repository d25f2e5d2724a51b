#pragma once

#include "filasofia/filasofia.h"

namespace filasofia::app {

/// A tool in a hand presses a block of tissue (examples/11_haptics), for ever or in the person's own hand.
void addHaptics(Simulation& sim, int subdivision);
inline constexpr Box kHapticsRoom = {{-0.032, -0.015, -0.03}, {0.032, 0.06, 0.03}};

} // namespace filasofia::app
