#pragma once

#include "apps/filasofia/bench/bench.h"

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

/// The project's limits. Cells that were not measured are not judged.
std::vector<Verdict> judgeBunny(const std::vector<CellResult>& cells);

/// The sizes whose step costs more than the 5 ms it simulates at some level, by their free-running cells; ascending.
std::vector<int> slowerThanRealTime(const std::vector<CellResult>& cells);

} // namespace filasofia::app
