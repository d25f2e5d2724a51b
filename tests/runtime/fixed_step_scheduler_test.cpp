#include "filasofia/runtime/fixed_step_scheduler.h"

namespace fixed_step_scheduler_test {

using namespace filasofia::runtime;

namespace {
constexpr Nanoseconds kMs = 1'000'000;
}

TEST_CASE("a step is as long as the time since the last wake-up, but never longer than period and slack")
{
    CHECK(clampStep(5 * kMs, 5 * kMs, 2 * kMs) == 5 * kMs);
    CHECK(clampStep(6 * kMs, 5 * kMs, 2 * kMs) == 6 * kMs);
    CHECK(clampStep(4 * kMs, 5 * kMs, 2 * kMs) == 4 * kMs);
    CHECK(clampStep(9 * kMs, 5 * kMs, 2 * kMs) == 7 * kMs);
    CHECK(clampStep(9 * kMs, 5 * kMs, 0) == 5 * kMs);
}

TEST_CASE("wake-ups on time give steps of one period")
{
    FixedStepScheduler scheduler(kMs, kMs);
    scheduler.start(100 * kMs);
    for (int i = 1; i <= 10; ++i) {
        CHECK(scheduler.nextWake() == (100 + i) * kMs);
        const Tick tick = scheduler.wake(scheduler.nextWake());
        CHECK(tick.dt == kMs);
        CHECK_FALSE(tick.late);
        CHECK_FALSE(tick.clamped);
    }
}

TEST_CASE("simulated time is wall time, to the nanosecond, however unpunctual the wake-ups, unless slack bites")
{
    std::mt19937 random(11);
    std::uniform_int_distribution<Nanoseconds> lateness(0, 3 * kMs);
    FixedStepScheduler scheduler(kMs, 10 * kMs); // slack larger than any lateness
    Nanoseconds now = 0, simulated = 0;
    scheduler.start(now);
    for (int i = 0; i < 10000; ++i) {
        now = std::max(now, scheduler.nextWake()) + lateness(random);
        const Tick tick = scheduler.wake(now);
        CHECK_FALSE(tick.clamped);
        simulated += tick.dt;
    }
    CHECK(simulated == now);
}

TEST_CASE("a wake-up that is a little late does not move the schedule")
{
    FixedStepScheduler scheduler(kMs, 2 * kMs);
    scheduler.start(0);
    const Tick tick = scheduler.wake(kMs + 300'000);
    CHECK(tick.dt == kMs + 300'000);
    CHECK_FALSE(tick.late);
    CHECK(scheduler.nextWake() == 2 * kMs);
    CHECK(scheduler.wake(2 * kMs).dt == kMs - 300'000); // what was too long before is too short now
}

TEST_CASE("after a wake-up more than a period late the schedule restarts, without a burst of catch-up steps")
{
    FixedStepScheduler scheduler(kMs, kMs);
    scheduler.start(0);
    const Tick tick = scheduler.wake(50 * kMs);
    CHECK(tick.late);
    CHECK(tick.clamped);
    CHECK(tick.dt == 2 * kMs);
    CHECK(scheduler.nextWake() == 51 * kMs);
    const Tick next = scheduler.wake(51 * kMs);
    CHECK_FALSE(next.late);
    CHECK(next.dt == kMs);
}

} // namespace fixed_step_scheduler_test
