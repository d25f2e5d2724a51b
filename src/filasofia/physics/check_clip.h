#pragma once

#include "filasofia/physics/clip_def.h"
#include "filasofia/physics/defs.h"

#include <string>

namespace filasofia::physics {

/// Throws an Error that begins with `object` if a field is out of its range, or if the legs do not close.
void check(const ClipDef& def, const std::string& object);

/// Throws an Error that begins with `object` if the solver or the integrator of a soft body knows no clips.
void checkClipped(const SoftBodyDef& tissue, const std::string& object);

} // namespace filasofia::physics
