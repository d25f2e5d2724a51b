#pragma once

#include <atomic>
#include <mutex>
#include <string>

namespace filasofia::runtime {

/// Whether a run is going on, whether it is to stop, and why. Any thread.
class RunControl {
public:
    /// Begins a run; returns false if one is going on.
    [[nodiscard]] bool begin() { return !running_.exchange(true); }
    /// Ends the run and makes the next one possible.
    void end();
    [[nodiscard]] bool running() const { return running_.load(); }

    /// Asks the run to stop. The report gives the reason that came first.
    void finish(std::string why);
    /// Asks the run to stop without giving a reason.
    void stop() { stop_.store(true); }
    [[nodiscard]] const std::atomic<bool>& stopAsked() const { return stop_; }
    [[nodiscard]] std::string reason() const;

private:
    std::atomic<bool> running_ = false;
    std::atomic<bool> stop_ = false;
    mutable std::mutex mutex_;
    std::string reason_; ///< under the lock
};

} // namespace filasofia::runtime
