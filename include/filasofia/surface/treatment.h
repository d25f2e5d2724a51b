#pragma once

#include "filasofia/surface/bleeding_def.h"
#include "filasofia/surface/burning_def.h"

namespace filasofia::surface {

/// What can be done to a living surface: to its blood, and to its heat.
using Treatment = std::variant<Perfuse, Injure, Seal, Suck, Rinse, Pour, Heat>;

} // namespace filasofia::surface
