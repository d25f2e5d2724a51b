#pragma once

#include <atomic>
#include <functional>
#include <memory>

namespace filasofia {

/// Work whose result is needed at a known moment and not before. Whoever comes first does it: a BackgroundThread, or
/// the thread that needs the result. So the moment at which the result is used, and everything that follows from it, is
/// the same however busy the machine is.
class BackgroundJob {
public:
    /// `work` must not throw, and must own or share everything that it touches: nobody looks at it before finish() has
    /// returned.
    explicit BackgroundJob(std::function<void()> work);
    BackgroundJob(const BackgroundJob&) = delete;
    BackgroundJob& operator=(const BackgroundJob&) = delete;

    /// Does the work unless a thread has already begun it.
    void tryRun() noexcept;
    /// Returns when the work is done. If no thread has begun it, the calling thread does it.
    void finish() noexcept;
    /// The result is no longer needed: if no thread has begun the work, none will.
    void drop() noexcept;

private:
    enum Stage { kWaits, kBegun, kDone };
    bool claim() noexcept;

    std::function<void()> work_;
    std::atomic<int> stage_{kWaits};
};

/// One thread that does jobs in the order in which they were submitted. It has ordinary scheduling even if the
/// submitting thread has real-time scheduling. It starts with the first job; if the system grants no thread, finish()
/// does all the work.
class BackgroundThread {
public:
    BackgroundThread();
    /// Waits for the job in progress; jobs that are not begun are left undone.
    ~BackgroundThread();
    BackgroundThread(const BackgroundThread&) = delete;
    BackgroundThread& operator=(const BackgroundThread&) = delete;

    void submit(std::shared_ptr<BackgroundJob> job);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia
