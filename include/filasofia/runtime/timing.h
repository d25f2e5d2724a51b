#pragma once

#include "filasofia/runtime/fixed_step_scheduler.h"

#include <vector>

namespace filasofia::runtime {

/// One step as the clock saw it.
struct StepTiming {
    Nanoseconds wake = 0; ///< when it began, since the run's start
    Nanoseconds dt = 0;   ///< simulated
    Nanoseconds cost = 0; ///< wall time it took
};

/// Three percentiles of a list of numbers.
struct Spread {
    double median = 0.0;
    double p1 = 0.0;  ///< 1 % lie below
    double p99 = 0.0; ///< 1 % lie above
};

/// Nearest-rank percentiles; zeros for an empty list.
Spread spreadOf(std::vector<double> values);

/// How the steps of a live run were paced.
struct RunTiming {
    std::vector<StepTiming> steps; ///< every step, or the first 200,000
    std::uint64_t stepCount = 0;   ///< [-]
    std::uint64_t late = 0;        ///< steps that began more than a period late
    std::uint64_t clamped = 0;     ///< steps whose dt was limited to period + slack
    double longestBehind = 0.0;    ///< [s] longest time in which every step was clamped: slower than real time
    double wallSeconds = 0.0;      ///< [s]
    double simulatedSeconds = 0.0; ///< [s], without paused steps

    [[nodiscard]] double realTimeFactor() const { return wallSeconds > 0.0 ? simulatedSeconds / wallSeconds : 0.0; }
    [[nodiscard]] Spread rate() const; ///< [1/s], the inverse of the time between wake-ups
    [[nodiscard]] Spread cost() const; ///< [s]
};

} // namespace filasofia::runtime
