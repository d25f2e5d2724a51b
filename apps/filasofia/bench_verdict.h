#pragma once

#include "filasofia/runtime/timing.h"

#include <optional>
#include <string>
#include <vector>

namespace filasofia::app {

/// What one cell of the bench measured.
struct CellResult {
    int tets = 0;
    int subdivision = 0;
    std::string picture;      ///< "null" or "filament"
    bool freeRunning = false; ///< without a clock; else one step each 5 ms
    runtime::Spread rate;     ///< [1/s]
    runtime::Spread cost;     ///< [s] of one step
};

/// One limit of the project, held against what was measured.
struct Verdict {
    std::string limit;       ///< what is asked
    std::optional<bool> met; ///< nothing where no cell says anything about it
    std::string measured;    ///< the worst case, in words
};

/// The project's limits. Cells that were not measured are not judged.
std::vector<Verdict> judge(const std::vector<CellResult>& cells);

/// The sizes whose step costs more than the 5 ms it simulates at some level, by their free-running cells; ascending.
std::vector<int> slowerThanRealTime(const std::vector<CellResult>& cells);

} // namespace filasofia::app
