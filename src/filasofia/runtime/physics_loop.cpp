#include "filasofia/runtime/physics_loop.h"

#include "filasofia/physics/physics_server.h"

#include <algorithm>
#include <limits>

namespace filasofia::runtime {
namespace {

constexpr std::size_t kMaxTimings = 200'000; // 5 MB

std::uint32_t flagsOf(const Tick& tick)
{
    std::uint32_t flags = 0;
    if (tick.late) flags |= static_cast<std::uint32_t>(physics::StepFlag::Late);
    if (tick.clamped) flags |= static_cast<std::uint32_t>(physics::StepFlag::Clamped);
    return flags;
}

/// The sum of both; the largest time if the sum would overflow.
Nanoseconds later(Nanoseconds time, Nanoseconds by)
{
    constexpr Nanoseconds end = std::numeric_limits<Nanoseconds>::max();
    return by > end - time ? end : time + by;
}

} // namespace

RunTiming runPhysics(physics::PhysicsServer& server, const PhysicsLoopDef& def, const Clock& clock,
                     const std::atomic<bool>& stop, const AfterStep& afterStep, const BeforeStep& beforeStep)
{
    const physics::PhysicsServer::Stepping stepping(server);
    RunTiming timing;
    timing.steps.resize(kMaxTimings); // touched now, so that no step of the loop takes a page fault
    timing.steps.clear();
    FixedStepScheduler scheduler(def.period, def.slack);
    const Nanoseconds start = clock.now();
    scheduler.start(start);
    physics::StepBudget budget{.now = clock.now};
    std::uint32_t flags = 0;
    Nanoseconds last = start, behind = 0;
    while (!stop.load(std::memory_order_relaxed) && (def.maxSteps == 0 || timing.stepCount < def.maxSteps)) {
        if (!def.freeRunning) clock.sleepUntil(scheduler.nextWake());
        const Nanoseconds now = clock.now();
        const Tick tick = def.freeRunning ? Tick{.dt = def.period} : scheduler.wake(now);
        if (def.deadline) budget.deadline = later(now, *def.deadline);
        const double dt = def.freeRunning && def.step > 0.0 ? def.step : toSeconds(tick.dt);
        if (beforeStep) beforeStep(dt);
        const physics::StepReport report = server.step(dt, flags | flagsOf(tick), budget);
        const Nanoseconds cost = clock.now() - now;
        flags = afterStep(report);

        if (timing.steps.size() < kMaxTimings) timing.steps.push_back({now - start, tick.dt, cost});
        ++timing.stepCount;
        timing.late += tick.late;
        timing.clamped += tick.clamped;
        behind = tick.clamped ? behind + now - last : 0;
        last = now;
        timing.longestBehind = std::max(timing.longestBehind, toSeconds(behind));
        timing.simulatedSeconds += report.dt;
    }
    timing.wallSeconds = toSeconds(clock.now() - start);
    return timing;
}

} // namespace filasofia::runtime
