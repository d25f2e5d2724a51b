#pragma once

#include "filasofia/runtime/step_grid.h"

#include <functional>

namespace filasofia::runtime {

/// Where the physics thread gets its time from; a test gives it another.
struct Clock {
    std::function<Nanoseconds()> now;
    std::function<void(Nanoseconds)> sleepUntil; ///< returns at that time or later; at once where it has passed
};

/// The machine's steady clock; sleeps with clock_nanosleep to absolute times.
Clock steadyClock();

} // namespace filasofia::runtime
