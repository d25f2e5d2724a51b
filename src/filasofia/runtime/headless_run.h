#pragma once

#include "filasofia/runtime/simulation_impl.h"

namespace filasofia::runtime {

/// Steps of one period in a plain loop; events are delivered between steps.
RunReport runHeadless(Simulation::Impl& impl, const RunDef& def);

} // namespace filasofia::runtime
