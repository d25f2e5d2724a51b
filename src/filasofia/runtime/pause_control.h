#pragma once

#include <atomic>

namespace filasofia::physics {
class PhysicsServer;
}

namespace filasofia::runtime {

/// Pausing and single steps. A single step consists of the commands "go on" and "pause", so that a recording has it.
class PauseControl {
public:
    /// Asks for one step; nothing happens if the simulation is not paused. Any thread.
    void askSingleStep()
    {
        told_.store(false);
        asked_.store(true);
    }
    /// Somebody says that it goes on or pauses: the last word counts, also during a single step. Any thread.
    void tell() { told_.store(true); }
    /// Whether the last step was paused. Any thread.
    [[nodiscard]] bool paused() const { return paused_.load(std::memory_order_relaxed); }

    /// Before each step, on the stepping thread: begins the single step that was asked for. Returns whether the bodies
    /// move in this step.
    bool beginStep(physics::PhysicsServer& physics);
    /// After each step, on the stepping thread.
    void endStep(physics::PhysicsServer& physics);

private:
    std::atomic<bool> paused_ = false; ///< in the last step
    std::atomic<bool> asked_ = false;  ///< a single step
    std::atomic<bool> told_ = false;   ///< to go on or to pause, since a single step was asked for
    bool stepping_ = false;            ///< a single step is being made; stepping thread only
    bool pauseComes_ = false;          ///< the next step applies the command "pause"; stepping thread only
};

} // namespace filasofia::runtime
