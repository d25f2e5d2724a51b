#pragma once

#include "filasofia/filasofia.h"

namespace filasofia::app {

// The scenes of the examples of the same names, each with its own look. `subdivision` [-], in [0, 3], applies to the
// drawn soft bodies.

/// A scalpel opens stretched tissue with three strokes side by side, then rests (examples/09_cut).
void addCut(Simulation& sim, int subdivision);
inline constexpr Box kCutRoom = {{-0.030, -0.006, -0.020}, {0.030, 0.010, 0.022}};

/// Forceps tear the tissue that they hold off a flap, then rest (examples/10_tear).
void addTear(Simulation& sim, int subdivision);
inline constexpr Box kTearRoom = {{-0.024, -0.004, -0.010}, {0.024, 0.016, 0.042}};

} // namespace filasofia::app
