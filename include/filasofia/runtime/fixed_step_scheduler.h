#pragma once

#include <cmath>
#include <cstdint>

/// When physics steps. Pure arithmetic: it reads no clock, so that a test can feed it any time.
namespace filasofia::runtime {

/// Nanoseconds on a steady clock; integers, so sums are exact.
using Nanoseconds = std::int64_t;

inline Nanoseconds toNanoseconds(double seconds) { return std::llround(seconds * 1e9); }
constexpr double toSeconds(Nanoseconds time) { return static_cast<double>(time) * 1e-9; }

/// The length of a step: the time since the last wake-up, but at most period + slack. With the lateness t_d of the
/// wake-up counted from the last one this is the paper's dt = min(T + t_d, T + t_s).
constexpr Nanoseconds clampStep(Nanoseconds sinceLastWake, Nanoseconds period, Nanoseconds slack)
{
    return sinceLastWake < period + slack ? sinceLastWake : period + slack;
}

/// What a wake-up means for the step that follows.
struct Tick {
    Nanoseconds dt = 0;   ///< length of the step
    bool late = false;    ///< woke up more than a period late: the schedule restarts here
    bool clamped = false; ///< dt was limited to period + slack: simulated time fell behind wall time
};

/// Schedules absolute wake-up times, a period apart. The sum of all dt is the time passed since start(), unless a dt
/// was clamped. After a wake-up more than a period late the schedule restarts there, so there is never a burst of
/// catch-up steps.
class FixedStepScheduler {
public:
    FixedStepScheduler(Nanoseconds period, Nanoseconds slack) : period_(period), slack_(slack) {}

    void start(Nanoseconds now)
    {
        last_ = now;
        next_ = now + period_;
    }
    /// When to wake up. In the past if a step took longer than the period: then wake up at once.
    [[nodiscard]] Nanoseconds nextWake() const { return next_; }

    /// Call it when the wake-up really happened, at nextWake() or later.
    Tick wake(Nanoseconds now)
    {
        Tick tick;
        tick.dt = clampStep(now - last_, period_, slack_);
        tick.clamped = now - last_ > period_ + slack_;
        tick.late = now - next_ > period_;
        next_ = (tick.late ? now : next_) + period_;
        last_ = now;
        return tick;
    }

private:
    Nanoseconds period_;
    Nanoseconds slack_;
    Nanoseconds last_ = 0;
    Nanoseconds next_ = 0;
};

} // namespace filasofia::runtime
