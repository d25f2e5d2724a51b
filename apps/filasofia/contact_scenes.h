#pragma once

#include "filasofia/filasofia.h"

namespace filasofia::app {

// The examples of the same names as endless scenes, each with the room that the camera looks at. `subdivision` [-], in
// [0, 3], applies to the drawn soft bodies.

/// A ball pokes a block of tissue once a second (examples/05_poke).
void addPoke(Simulation& sim, int subdivision);
inline constexpr Box kPokeRoom = {{-0.032, -0.015, -0.03}, {0.032, 0.03, 0.03}};

/// Two jaws lift a soft cube by friction, set it down and let go, every four seconds (examples/06_grasp).
void addGrasp(Simulation& sim, int subdivision);
inline constexpr Box kGraspRoom = {{-0.03, -0.005, -0.02}, {0.03, 0.062, 0.02}};

/// Two boxes on a slope: the rough one stays, the smooth one slides down to a ledge (examples/08_friction).
void addFriction(Simulation& sim);
inline constexpr Box kFrictionRoom = {{-0.10, -0.04, -0.05}, {0.11, 0.05, 0.05}};

} // namespace filasofia::app
