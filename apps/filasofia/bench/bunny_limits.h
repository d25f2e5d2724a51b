#pragma once

#include "apps/filasofia/bench/bench.h"

namespace filasofia::app {

/// The result of one cell of the bench.
struct CellResult {
    int tets = 0;
    int subdivision = 0;
    std::string picture;      ///< "null" or "filament"
    bool freeRunning = false; ///< without a clock; otherwise one step each 5 ms
    runtime::Spread rate;     ///< [1/s]
    runtime::Spread cost;     ///< [s] cost of one step
};

/// The project's limits. A limit stays undecided if its cells were not measured.
std::vector<Verdict> judgeBunny(const std::vector<CellResult>& cells);

/// The sizes whose step costs more than the 5 ms it simulates at some level, taken from their free-running cells; in
/// ascending order.
std::vector<int> slowerThanRealTime(const std::vector<CellResult>& cells);

} // namespace filasofia::app
