#pragma once

#include "filasofia/runtime/simulation_impl.h"

namespace filasofia::runtime {

/// Physics in a thread of its own, the picture on this one.
RunReport runLive(Simulation::Impl& impl, const RunDef& def);

} // namespace filasofia::runtime
