#pragma once

#include <memory>

namespace filasofia {

/// Cores that the calling thread may run on, at least 1.
[[nodiscard]] int usableCores();

/// Threads for parallel loops shorter than a millisecond.
///
/// Results must not depend on who does what: a loop's parts each write their own place. The calling thread works too
/// and never waits for a worker that has not come: it waits only for parts that were begun. Workers spin for some 40 µs
/// after a loop and then sleep. A worker that loses its core to something else while it works, and so holds up the
/// caller, takes no part for 1 ms at first, and up to 1 s where it happens again and again; then it is tried anew.
class WorkerPool {
public:
    /// `threads` >= 1, the caller's among them. The others start with the first loop that can use them, and take over
    /// the scheduling and the permitted cores that the thread calling it then has. Where the system grants fewer
    /// threads, the pool works with those.
    explicit WorkerPool(int threads);
    ~WorkerPool();
    WorkerPool(const WorkerPool&) = delete;
    WorkerPool& operator=(const WorkerPool&) = delete;

    /// As many as were asked for.
    [[nodiscard]] int threads() const;

    /// Calls part(i) once for every i in [0, count) and returns when all are done; what the parts wrote is then visible
    /// to the caller. count >= 0. The same i falls to the same thread in most loops of the same count, so that its data
    /// stays in one cache. From any thread, but one loop at a time; where a part itself calls run(), of this pool or
    /// another, that loop is worked off at once on its own thread. A part must not throw.
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
