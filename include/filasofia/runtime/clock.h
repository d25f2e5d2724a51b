#pragma once

#include "filasofia/runtime/fixed_step_scheduler.h"

#include <functional>

namespace filasofia::runtime {

/// The clock of the physics thread; a test supplies another.
struct Clock {
    std::function<Nanoseconds()> now;
    std::function<void(Nanoseconds)> sleepUntil; ///< returns at that time or later; at once if the time has passed
};

/// The machine's steady clock; sleeps with clock_nanosleep to absolute times.
Clock steadyClock();

} // namespace filasofia::runtime
