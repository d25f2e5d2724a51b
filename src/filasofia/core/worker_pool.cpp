#include "filasofia/core/worker_pool.h"

#include "filasofia/core/assert.h"

#include <pthread.h>
#include <sched.h>
#include <time.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace filasofia {
namespace {

// The clock decides which thread works and when, never what the result is.
using Clock = std::chrono::steady_clock;
using Time = Clock::time_point;
using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr microseconds kIdleSpin{
    40}; // how long a worker spins before it sleeps: longer than the pause between two loops
constexpr microseconds kPatience{20};  // how long the caller waits for begun parts before it asks why they are not done
constexpr microseconds kWaitSpin{50};  // how long the caller spins for begun parts before it sleeps
constexpr microseconds kMinLoss{50};   // a smaller loss does not pay for doing without the worker
constexpr milliseconds kMinRest{1};    // the first rest of a worker that lost its core
constexpr milliseconds kMaxRest{1000}; // the longest rest, for a worker that loses its core again and again
constexpr milliseconds kRare{50};      // if losses are further apart, they cost less than doing without the worker
constexpr milliseconds kCrowdedRest{2}; // the rest of a worker that runs on the caller's core
constexpr int kClockEvery = 32;         // pauses between two readings of the clock, some 0.5 µs

// Neighbouring cache lines are fetched in pairs, so data that two threads write is kept two lines apart.
constexpr std::size_t kApart = 128;

thread_local bool insidePart = false;

struct InsidePart {
    InsidePart() { insidePart = true; }
    ~InsidePart() { insidePart = before; }
    InsidePart(const InsidePart&) = delete;
    InsidePart& operator=(const InsidePart&) = delete;
    const bool before = insidePart;
};

inline void relax()
{
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#elif defined(__aarch64__) || defined(__arm__)
    asm volatile("yield" ::: "memory");
#endif
}

// The parts of one range that nobody has claimed: [next, end) in one word. Whoever exchanges that word owns the part,
// and the loop cannot end before the part is done. So call and context, read after the claim, belong to the part, even
// if the word was read in one loop and exchanged in another. The range's owner claims from the front and all others
// from the back, so that an owner that is a little late loses the same parts each time.
struct alignas(kApart) ClaimRange {
    std::atomic<std::uint64_t> unclaimed = 0;

    void publish(int begin, int end)
    {
        unclaimed.store(std::uint64_t(end) << 32 | std::uint32_t(begin), std::memory_order_release);
    }
    int claimFront() // -1 if none is left
    {
        std::uint64_t now = unclaimed.load(std::memory_order_relaxed);
        while (std::uint32_t(now) < now >> 32)
            if (exchange(now, now + 1)) return int(std::uint32_t(now));
        return -1;
    }
    int claimBack()
    {
        std::uint64_t now = unclaimed.load(std::memory_order_relaxed);
        while (std::uint32_t(now) < now >> 32)
            if (exchange(now, now - (std::uint64_t(1) << 32))) return int((now >> 32) - 1);
        return -1;
    }

private:
    bool exchange(std::uint64_t& now, std::uint64_t next)
    {
        return unclaimed.compare_exchange_weak(now, next, std::memory_order_acquire, std::memory_order_relaxed);
    }
};

struct alignas(kApart) Worker {
    std::atomic<bool> working = false; // the worker may have begun parts
    std::atomic<Time> restUntil{}; // set by the caller: the worker takes no part before this time, and then clears it
    std::thread thread;

    // The caller's notes.
    clockid_t cpuClock = {};
    bool awaited = false;
    std::chrono::nanoseconds cpuTime{}; // the worker's CPU time when the caller began to watch it
    milliseconds lastRest = kMinRest;
    Time lastRestEnd{};

    [[nodiscard]] std::chrono::nanoseconds readCpuTime() const
    {
        timespec spent{};
        clock_gettime(cpuClock, &spent);
        return std::chrono::seconds(spent.tv_sec) + std::chrono::nanoseconds(spent.tv_nsec);
    }

    // A loss soon after the last rest doubles the next one, a later loss halves it.
    void sendToRest(Time now)
    {
        const bool rare = now - lastRestEnd > kRare;
        lastRest = rare ? std::max(lastRest / 2, kMinRest) : std::min(2 * lastRest, kMaxRest);
        lastRestEnd = now + lastRest;
        restUntil.store(lastRestEnd, std::memory_order_relaxed);
    }
};

} // namespace

int usableCores()
{
    cpu_set_t usable;
    if (sched_getaffinity(0, sizeof usable, &usable) == 0) return std::max(1, CPU_COUNT(&usable));
    return std::max(1, int(std::thread::hardware_concurrency())); // the set has no room for so many cores
}

struct WorkerPool::Impl {
    explicit Impl(int count) : threads(count), ranges(std::size_t(count)) {}
    ~Impl();

    void start();
    void run(int count, Call newCall, const void* newContext);
    void publish(int count, Call newCall, const void* newContext);
    int work(int self);
    void await(Time begun);
    void awaitLong(Time begun);
    void watchLateWorkers();
    void judgeLateWorkers(Time begun, Time watched);

    void workerLoop(int self);
    std::uint32_t awaitLoop(std::uint32_t seen);
    bool rested(Worker& me);
    [[nodiscard]] bool onCallersCore() const { return sched_getcpu() == callerCore.load(std::memory_order_relaxed); }

    const int threads;
    bool started = false;
    std::vector<Worker> workers;    // threads - 1, or fewer if the system granted fewer
    std::vector<ClaimRange> ranges; // thread i prefers range i; range 0 is the caller's
    std::atomic<bool> inUse = false;

    // What workers read about a loop; the caller writes it.
    alignas(kApart) std::atomic<std::uint32_t> loop = 0; // number of the newest loop
    std::atomic<int> usedRanges = 0;
    std::atomic<int> callerCore = -1;
    std::atomic<bool> stopping = false;
    Call call = nullptr;
    const void* context = nullptr;

    // The parts that are not done, with the mark of a caller that sleeps until there are none.
    static constexpr std::uint32_t kCallerSleeps = std::uint32_t(1) << 31;
    alignas(kApart) std::atomic<std::uint32_t> remaining = 0;

    alignas(kApart) std::atomic<bool> sleepers = false; // a worker sleeps, or is about to

    std::mutex restMutex; // only for the workers' rests, which end with the pool
    std::condition_variable restEnd;
};

WorkerPool::Impl::~Impl()
{
    {
        const std::lock_guard lock(restMutex);
        stopping.store(true, std::memory_order_relaxed);
    }
    restEnd.notify_all();
    loop.fetch_add(1, std::memory_order_release);
    loop.notify_all();
    for (Worker& worker : workers)
        if (worker.thread.joinable()) worker.thread.join();
}

void WorkerPool::Impl::start()
{
    started = true;
    workers = std::vector<Worker>(std::size_t(threads) - 1);
    for (std::size_t i = 0; i < workers.size(); ++i) {
        Worker& worker = workers[i];
        try {
            worker.thread = std::thread([this, i] { workerLoop(int(i) + 1); });
        } catch (const std::system_error&) {
            return; // the threads that did start do all the work: the claims do not rely on any one of them
        }
        if (pthread_getcpuclockid(worker.thread.native_handle(), &worker.cpuClock) != 0)
            worker.cpuClock =
                CLOCK_MONOTONIC; // then a late worker always seems busy, and the caller goes on waiting for it
    }
}

// ---- the caller -----------------------------------------------------------------------------------------------------

void WorkerPool::Impl::run(int count, Call newCall, const void* newContext)
{
    if (!started) start();
    const Time begun = Clock::now();
    publish(count, newCall, newContext);
    const int done = work(0);
    if (remaining.fetch_sub(std::uint32_t(done), std::memory_order_acquire) != std::uint32_t(done)) await(begun);
}

void WorkerPool::Impl::publish(int count, Call newCall, const void* newContext)
{
    // A worker late for the last loop may claim a part of this one as soon as its range is published, so the ranges
    // come last.
    call = newCall;
    context = newContext;
    remaining.store(std::uint32_t(count), std::memory_order_relaxed);
    callerCore.store(sched_getcpu(), std::memory_order_relaxed);
    const int used = std::min(threads, count);
    usedRanges.store(used, std::memory_order_relaxed);
    for (int i = used - 1; i >= 0; --i) {
        const auto bound = [&](int k) { return int(std::int64_t(count) * k / used); };
        ranges[std::size_t(i)].publish(bound(i), bound(i + 1));
    }

    // The flag is cleared before the loop's number changes. A worker that sets it later either finds the new number and
    // does not sleep, or sleeps through this one loop, which does not need it. Each worker that wakes up wakes the
    // next.
    const bool wake = sleepers.load(std::memory_order_relaxed) && sleepers.exchange(false);
    loop.fetch_add(1, std::memory_order_release);
    if (wake) loop.notify_one();
}

/// Claims and does parts until none is left to claim; returns how many it did.
int WorkerPool::Impl::work(int self)
{
    const int used = usedRanges.load(std::memory_order_relaxed);
    int done = 0;
    if (self < used)
        for (int i; (i = ranges[std::size_t(self)].claimFront()) >= 0; ++done) call(context, i);
    for (int k = self < used ? 1 : 0; k < used; ++k)
        for (int i; (i = ranges[std::size_t((self + k) % used)].claimBack()) >= 0; ++done) call(context, i);
    return done;
}

void WorkerPool::Impl::await(Time begun)
{
    for (int i = 0; i < kClockEvery; ++i) {
        if (remaining.load(std::memory_order_acquire) == 0) return;
        relax();
    }
    awaitLong(begun);
}

// A begun part is late either because it is long or because its worker lost the core. Only in the second case is the
// caller better off without that worker. The worker's own CPU clock, which stands still meanwhile, tells the two apart.
void WorkerPool::Impl::awaitLong(Time begun)
{
    const Time asked = Clock::now();
    Time watched{};
    for (Time now = asked; now - asked < kWaitSpin; now = Clock::now()) {
        for (int i = 0; i < kClockEvery; ++i) {
            if (remaining.load(std::memory_order_acquire) == 0) return;
            relax();
        }
        if (watched != Time{} || now - asked < kPatience) continue;
        watched = now;
        watchLateWorkers();
    }

    if (watched == Time{}) { // the caller itself lost its core meanwhile
        watched = Clock::now();
        watchLateWorkers();
    }

    // While it sleeps, the caller leaves its core to a worker that may have none.
    std::uint32_t left = remaining.fetch_or(kCallerSleeps, std::memory_order_acquire) | kCallerSleeps;
    while (left != kCallerSleeps) {
        remaining.wait(left, std::memory_order_acquire);
        left = remaining.load(std::memory_order_acquire);
    }
    judgeLateWorkers(begun, watched);
}

void WorkerPool::Impl::watchLateWorkers()
{
    for (Worker& worker : workers) {
        worker.awaited = worker.working.load(std::memory_order_relaxed);
        if (worker.awaited) worker.cpuTime = worker.readCpuTime();
    }
}

void WorkerPool::Impl::judgeLateWorkers(Time begun, Time watched)
{
    for (Worker& worker : workers) {
        if (!worker.awaited) continue;
        const Time now = Clock::now();
        const std::chrono::nanoseconds lost = now - watched - (worker.readCpuTime() - worker.cpuTime);
        // With two threads, the loop took longer than the caller alone would have taken.
        if (lost > kMinLoss && lost > (now - begun) / 2) worker.sendToRest(now);
    }
}

// ---- a worker -------------------------------------------------------------------------------------------------------

void WorkerPool::Impl::workerLoop(int self)
{
    pthread_setname_np(pthread_self(), "filasofia-work");
    insidePart = true;
    Worker& me = workers[std::size_t(self) - 1];
    for (std::uint32_t seen = 0;;) {
        seen = awaitLoop(seen);
        if (stopping.load(std::memory_order_relaxed)) return;
        if (!rested(me)) continue;
        me.working.store(true, std::memory_order_relaxed);
        const auto done = std::uint32_t(work(self));
        // All parts that this worker has done are subtracted at once: fewer writes to the cache line that the caller
        // watches.
        if (done > 0 && remaining.fetch_sub(done, std::memory_order_acq_rel) - done == kCallerSleeps)
            remaining.notify_one();
        me.working.store(false, std::memory_order_relaxed);
    }
}

/// False if the worker must rest: it is not ready for this loop, but for one that comes after the rest.
bool WorkerPool::Impl::rested(Worker& me)
{
    Time until = me.restUntil.load(std::memory_order_relaxed);
    if (until != Time{} && Clock::now() >= until) {
        until = {};
        me.restUntil.store(until, std::memory_order_relaxed);
    }
    if (until == Time{}) {
        if (!onCallersCore()) return true;
        until = Clock::now() + kCrowdedRest; // each part done here would delay the caller
    }
    std::unique_lock lock(restMutex);
    restEnd.wait_until(lock, until, [&] { return stopping.load(std::memory_order_relaxed); });
    return false;
}

/// Spins, then sleeps, until there is a loop other than `seen`; returns its number.
std::uint32_t WorkerPool::Impl::awaitLoop(std::uint32_t seen)
{
    Time start{};
    for (;;) {
        for (int i = 0; i < kClockEvery; ++i) {
            const std::uint32_t now = loop.load(std::memory_order_acquire);
            if (now != seen) return now;
            relax();
        }
        const Time now = Clock::now();
        if (start == Time{}) start = now;
        if (now - start > kIdleSpin || onCallersCore()) break; // on its core the caller would wait for this spinning
    }
    sleepers.store(true); // a later publish() sees it, before or after the kernel compares the number
    loop.wait(seen, std::memory_order_acquire);
    loop.notify_one();
    return loop.load(std::memory_order_acquire);
}

// ---- the pool -------------------------------------------------------------------------------------------------------

WorkerPool::WorkerPool(int threads)
{
    FILASOFIA_ASSERT(threads >= 1);
    impl_ = std::make_unique<Impl>(threads);
}

WorkerPool::~WorkerPool() { FILASOFIA_ASSERT(!impl_->inUse.load()); }

int WorkerPool::threads() const { return impl_->threads; }

void WorkerPool::runParts(int count, Call call, const void* context) noexcept
{
    FILASOFIA_ASSERT(count >= 0);
    const InsidePart mark;
    if (mark.before || count <= 1 || impl_->threads == 1) {
        for (int i = 0; i < count; ++i) call(context, i);
        return;
    }
    const bool alreadyInUse = impl_->inUse.exchange(true, std::memory_order_acquire);
    FILASOFIA_ASSERT(!alreadyInUse);
    impl_->run(count, call, context);
    impl_->inUse.store(false, std::memory_order_release);
}

} // namespace filasofia
