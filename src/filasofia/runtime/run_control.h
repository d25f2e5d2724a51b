#pragma once

#include <atomic>
#include <string>

namespace filasofia::runtime {

/// Whether a run is going on, whether it is to stop, and why. Any thread.
class RunControl {
public:
    RunControl() = default;
    ~RunControl();
    RunControl(const RunControl&) = delete;
    RunControl& operator=(const RunControl&) = delete;

    /// Begins a run; returns false if one is going on.
    [[nodiscard]] bool begin()
    {
        if (running_.exchange(true)) return false;
        resting_.store(false);
        return true;
    }
    /// Ends the run and makes the next one possible.
    void end();
    [[nodiscard]] bool running() const { return running_.load(); }
    /// A stepped run has come to rest between two steps, or makes one. Its thread.
    void rest(bool resting) { resting_.store(resting); }
    /// Whether what a run calls may be changed now: none is going on, or a stepped one is between two steps.
    [[nodiscard]] bool changeable() const { return !running() || resting_.load(); }

    /// Asks the run to stop, without waiting for other threads that do. The report gives the reason that came first.
    void finish(std::string why);
    /// Asks the run to stop without giving a reason.
    void stop() { stop_.store(true); }
    [[nodiscard]] const std::atomic<bool>& stopAsked() const { return stop_; }
    [[nodiscard]] std::string reason() const; ///< the thread of begin() and end()
    /// Returns to a reason that was given before, or to none. The thread of begin() and end().
    void goBack(std::string reason);

private:
    std::atomic<bool> running_ = false;
    std::atomic<bool> resting_ = false;
    std::atomic<bool> stop_ = false;
    std::atomic<const std::string*> reason_ = nullptr; ///< owned; the first that was given
};

} // namespace filasofia::runtime
