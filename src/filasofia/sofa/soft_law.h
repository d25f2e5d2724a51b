#pragma once

#include "filasofia/sofa/collision_surface.h"
#include "filasofia/sofa/soft_plan.h"

namespace filasofia::sofaengine {

/// SOFA's force field for the material of a body, of the same energy as ours. Its node and its name are the caller's.
::sofa::core::objectmodel::BaseObject::SPtr lawOf(const SoftPlan& plan, SoftStates& state);

} // namespace filasofia::sofaengine
