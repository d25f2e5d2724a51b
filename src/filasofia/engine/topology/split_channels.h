#pragma once

#include "filasofia/engine/scene/scene.h"

namespace filasofia::engine {

/// After an edge of a rod was cut at the fraction s of it: a channel that it runs through becomes two, with what of the
/// lines is before the cut and behind it. Only that in front cuts on.
void splitChannels(const SoftBody& rod, int edge, double s, Scene& scene);

} // namespace filasofia::engine
