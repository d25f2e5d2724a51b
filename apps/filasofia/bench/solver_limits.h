#pragma once

#include "apps/filasofia/bench/bench.h"
#include "apps/filasofia/bench/solver_cell.h"

namespace filasofia::app {

/// The project's limits for the solver. `simdTarget` is the machine's instruction set as engine::simdTargets() names
/// it. A limit stays undecided if its cells were not measured.
std::vector<Verdict> judgeSolver(const std::vector<SolverCell>& cells, const std::vector<StiffRun>& stiff,
                                 const std::string& simdTarget);

} // namespace filasofia::app
