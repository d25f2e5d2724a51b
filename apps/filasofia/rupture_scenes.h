#pragma once

#include "filasofia/filasofia.h"

namespace filasofia::app {

// What the examples of the same names show, with a look of their own. `subdivision` [-], in [0, 3], is of the drawn
// soft bodies.

/// A scalpel opens stretched tissue, three times beside each other, and then rests (examples/09_cut).
void addCut(Simulation& sim, int subdivision);
inline constexpr Box kCutRoom = {{-0.030, -0.006, -0.020}, {0.030, 0.010, 0.022}};

/// Forceps tear what they hold off a flap, and then rest (examples/10_tear).
void addTear(Simulation& sim, int subdivision);
inline constexpr Box kTearRoom = {{-0.024, -0.004, -0.010}, {0.024, 0.016, 0.042}};

} // namespace filasofia::app
