#pragma once

#include <memory>

namespace filasofia {

/// The number of cores that the calling thread may run on, at least 1.
[[nodiscard]] int usableCores();

/// Threads for parallel loops shorter than a millisecond.
///
/// Results must not depend on which thread does what: each part of a loop writes to its own place. The calling thread
/// works too and never waits for a worker that has not come: it waits only for parts that were begun. Workers spin for
/// some 40 µs after a loop and then sleep. If a worker loses its core while it works, and so delays the caller, it is
/// left out for 1 ms at first, and for up to 1 s if this happens again and again; then it is tried again.
class WorkerPool {
public:
    /// `threads` >= 1 includes the caller. The others start with the first loop that can use them, and inherit the
    /// scheduling and the permitted cores of the thread that calls it. If the system grants fewer threads, the pool
    /// works with those.
    explicit WorkerPool(int threads);
    ~WorkerPool();
    WorkerPool(const WorkerPool&) = delete;
    WorkerPool& operator=(const WorkerPool&) = delete;

    /// The number that was asked for.
    [[nodiscard]] int threads() const;

    /// Calls part(i) once for every i in [0, count) and returns when all are done; what the parts wrote is then visible
    /// to the caller. count >= 0. The same i runs on the same thread in most loops of the same count, so that its data
    /// stays in one cache. Any thread may call it, but only one loop runs at a time. If a part itself calls run(), on
    /// this pool or another, that inner loop runs at once on its own thread. A part must not throw.
    template <class Part> void run(int count, const Part& part)
    {
        runParts(
            count, [](const void* context, int i) { (*static_cast<const Part*>(context))(i); }, &part);
    }

private:
    using Call = void (*)(const void* context, int i);
    void runParts(int count, Call call, const void* context) noexcept;

    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia
