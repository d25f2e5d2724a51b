#pragma once

#include <atomic>
#include <functional>
#include <memory>

namespace filasofia {

/// Work whose result is needed at a known moment and not before. Whoever comes first does it: a BackgroundThread, or
/// who needs it. So the moment, and what follows from it, is the same however busy the machine is.
class BackgroundJob {
public:
    /// `work` must not throw, and owns or shares all that it touches: nobody looks at it before finish() has returned.
    explicit BackgroundJob(std::function<void()> work);
    BackgroundJob(const BackgroundJob&) = delete;
    BackgroundJob& operator=(const BackgroundJob&) = delete;

    /// Does the work unless somebody has begun with it.
    void tryRun() noexcept;
    /// Returns when the work is done; does it itself where nobody has begun.
    void finish() noexcept;
    /// Nobody needs it any more: it is not begun, if it was not yet.
    void drop() noexcept;

private:
    enum Stage { kWaits, kBegun, kDone };
    bool claim() noexcept;

    std::function<void()> work_;
    std::atomic<int> stage_{kWaits};
};

/// One thread that does jobs in the order in which they are given, as an ordinary one even where who gives them is a
/// real-time one. It starts with the first job; where the system grants no thread, finish() does all the work.
class BackgroundThread {
public:
    BackgroundThread();
    /// Waits for the job being done; those not begun are left.
    ~BackgroundThread();
    BackgroundThread(const BackgroundThread&) = delete;
    BackgroundThread& operator=(const BackgroundThread&) = delete;

    void give(std::shared_ptr<BackgroundJob> job);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia
