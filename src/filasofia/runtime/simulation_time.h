#pragma once

#include "filasofia/event/event.h"

#include <atomic>
#include <cstdint>

namespace filasofia::runtime {

/// The simulated time and the number of the last step. The stepping thread sets them; any thread reads them.
class SimulationTime {
public:
    void set(double seconds, std::uint64_t step)
    {
        seconds_.store(seconds, std::memory_order_relaxed);
        step_.store(step, std::memory_order_relaxed);
    }
    [[nodiscard]] double seconds() const { return seconds_.load(std::memory_order_relaxed); }
    [[nodiscard]] std::uint64_t step() const { return step_.load(std::memory_order_relaxed); }
    /// Writes both into an event.
    void stamp(event::Event& event) const
    {
        event.time = seconds();
        event.step = step();
    }

private:
    std::atomic<double> seconds_ = 0.0; ///< [s], >= 0
    std::atomic<std::uint64_t> step_ = 0;
};

} // namespace filasofia::runtime
