#pragma once

#include "filasofia/engine/contact/coupling.h"
#include "filasofia/engine/scene/scene.h"

namespace filasofia::engine {

/// Adds a constraint for each pair of points that a clip draws together in a step of dt [s]: a spring along the line
/// between them, as long as they are farther apart than the legs leave.
void addClipLegs(double dt, const Scene& scene, Coupling& coupling);

} // namespace filasofia::engine
