#pragma once

#include "apps/filasofia/bench/bench.h"
#include "apps/filasofia/bench/solver_cell.h"

namespace filasofia::app {

/// What one thread may take for a step of 5 ms, on a machine whose lower bound is that of the limits.
struct StepLimit {
    std::string mesh; ///< "10000", as in the file's name
    double seconds;
};
inline const std::array kStepLimits{StepLimit{"3004", 0.07e-3}, StepLimit{"10000", 0.24e-3}, StepLimit{"30000", 0.8e-3},
                                    StepLimit{"95680", 3.5e-3}};

/// Whether these steps of 5 ms [s] keep a limit that grows with the lower bound of a step at 3004 tetrahedra [s per
/// tetrahedron], if the machine is slower than that of the limits.
Verdict judgeSteps(const std::vector<Measured>& steps, const StepLimit& limit, double floorPerElement);

/// The project's limits for the solver. `simdTarget` is the machine's instruction set as engine::simdTargets() names
/// it. A limit stays undecided if its cells were not measured.
std::vector<Verdict> judgeSolver(const std::vector<SolverCell>& cells, const std::vector<StiffRun>& stiff,
                                 const std::string& simdTarget);

} // namespace filasofia::app
