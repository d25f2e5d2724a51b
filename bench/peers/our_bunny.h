#pragma once

#include "bench/peers/problem.h"

#include "filasofia/physics/defs.h"

namespace filasofia::peers {

/// The native engine on one thread.
Run runOurs(const Problem& problem, const physics::Solver& solver);

} // namespace filasofia::peers
