#pragma once

#include "filasofia/engine/scene/scene.h"

namespace filasofia::testing {

/// Its tetrahedra whose volume is surely below zero, so that single precision cannot see it otherwise.
int surelyInverted(const engine::SoftBody& body);

/// [-] By how much a principal stretch of a tetrahedron or a triangle differs from 1 at most.
double largestStrain(const engine::SoftBody& body);
/// [-] The largest i1 - 3 over the range of the body's law (physics::rangeOf), 0 if that is infinite. Elements below a
/// fifth of their volume are left out: laws count their volume as larger.
double largestInvariant(const engine::SoftBody& body);

} // namespace filasofia::testing
