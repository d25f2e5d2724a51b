#pragma once

#include "apps/filasofia/bench/bench.h"
#include "apps/filasofia/bench/solver_cell.h"

namespace filasofia::app {

/// The project's limits for the solver. `simdTarget`: what the machine has, as engine::simdTargets() says it. What was
/// not measured is not judged.
std::vector<Verdict> judgeSolver(const std::vector<SolverCell>& cells, const std::vector<StiffRun>& stiff,
                                 const std::string& simdTarget);

} // namespace filasofia::app
