#pragma once

#include "filasofia/core/spsc_ring.h"
#include "filasofia/physics/step.h"

#include <atomic>

namespace filasofia::runtime {

/// Carries step reports from the stepping thread to the main thread, for whoever watches the simulation. The stepping
/// thread never waits: reports are dropped if nobody reads them, or not fast enough.
class StepFeed {
public:
    /// Stepping thread.
    void write(const physics::StepReport& report)
    {
        if (!watched_.load(std::memory_order_relaxed)) return;
        physics::StepReport* place = ring_.beginWrite();
        if (!place) {
            lost_.fetch_add(1, std::memory_order_relaxed);
            return;
        }
        *place = report; // the copied list reuses the slot's memory
        ring_.publish();
    }

    // Main thread.
    void watch(bool on) { watched_.store(on, std::memory_order_relaxed); }
    /// Passes every report that has come to `take`, oldest first.
    template <class Take> void read(Take&& take)
    {
        for (; const physics::StepReport* report = ring_.beginRead(); ring_.release()) take(*report);
    }
    [[nodiscard]] std::uint64_t lost() const { return lost_.load(std::memory_order_relaxed); }

private:
    SpscRing<physics::StepReport> ring_{4096}; ///< at 10 kHz a picture may take 0.4 s
    std::atomic<bool> watched_ = false;
    std::atomic<std::uint64_t> lost_ = 0;
};

} // namespace filasofia::runtime
