#pragma once

#include "filasofia/runtime/clock.h"
#include "filasofia/runtime/timing.h"

#include "filasofia/physics/step.h"

#include <atomic>
#include <optional>

namespace filasofia::physics {
class PhysicsServer;
}

namespace filasofia::runtime {

struct PhysicsLoopDef {
    Nanoseconds period = 1'000'000;
    Nanoseconds slack = 2'000'000;
    std::optional<Nanoseconds> deadline = {}; ///< [ns] after a step's start; not given: no deadline
    bool freeRunning = false;                 ///< runs steps back to back without waiting, to measure their cost
    double step = 0.0;          ///< [s] the step while freeRunning: exact, as no clock counts it; 0: the period
    std::uint64_t maxSteps = 0; ///< 0: until stopped
};

/// Called after every step, on the stepping thread; returns StepFlag bits for the next step's report.
using AfterStep = std::function<std::uint32_t(const physics::StepReport&)>;

/// Called before every step, on the stepping thread, with the step's length [s].
using BeforeStep = std::function<void(double)>;

/// The periodic task: wakes at the scheduled times, steps and sleeps until `stop` is set. Runs on the caller's thread.
/// Every step gets the clock, so that it can measure its stages.
RunTiming runPhysics(physics::PhysicsServer& server, const PhysicsLoopDef& def, const Clock& clock,
                     const std::atomic<bool>& stop, const AfterStep& afterStep, const BeforeStep& beforeStep = {});

} // namespace filasofia::runtime
