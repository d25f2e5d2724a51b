#pragma once

#include "filasofia/engine/contact/coupling.h"

namespace filasofia::engine {

/// Makes what the coarse levels of soft bodies know of the attachments between them (TiedCoarse) if it is not known
/// yet, and marks the constraints of these attachments. To be called when the bodies are assembled for the step.
void tieBodies(double dt, Scene& scene, Coupling& coupling);

} // namespace filasofia::engine
