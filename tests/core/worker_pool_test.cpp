#include "filasofia/core/worker_pool.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <numeric>
#include <thread>

namespace worker_pool_test {

using namespace filasofia;

namespace {

/// The sum over the parts of a loop, each of which wrote to its own place.
double sumOf(WorkerPool& pool, int count)
{
    std::vector<double> terms(static_cast<std::size_t>(count));
    pool.run(count, [&](int i) { terms[static_cast<std::size_t>(i)] = 1.0 / (1.0 + i) * std::sqrt(double(i)); });
    return std::accumulate(terms.begin(), terms.end(), 0.0);
}

/// A part's worth of work that no compiler can remove.
double turn(double x, int times)
{
    for (int i = 0; i < times; ++i) x = std::sin(x + i);
    return x;
}

} // namespace

TEST_CASE("every part is done exactly once, whatever the counts of parts and threads")
{
    for (const int threads : {1, 2, 3, 8, 64}) {
        WorkerPool pool(threads);
        CHECK(pool.threads() == threads);
        for (const int count : {0, 1, 2, 7, 1000, 3, 63, 64, 65, 0, 100'000}) {
            std::vector<int> done(static_cast<std::size_t>(count)); // not atomic: no two threads share a part
            pool.run(count, [&](int i) { ++done[static_cast<std::size_t>(i)]; });
            INFO(threads << " threads, " << count << " parts");
            CHECK(std::count(done.begin(), done.end(), 1) == count);
        }
    }
}

TEST_CASE("the sum over a loop has the same bits for every number of threads")
{
    WorkerPool one(1);
    for (const int threads : {2, 3, 8, 64}) {
        WorkerPool pool(threads);
        for (const int count : {1, 2, 7, 1000}) CHECK(sumOf(pool, count) == sumOf(one, count));
    }
}

TEST_CASE("a hundred thousand tiny loops, back to back, each see what the one before wrote")
{
    for (const int threads : {2, 4}) {
        WorkerPool pool(threads);
        constexpr int kParts = 5;
        std::vector<int> now(kParts), next(kParts);
        for (int loop = 0; loop < 100'000; ++loop) {
            // Each part reads its neighbour's last value: a part run late, early or with an old context breaks the
            // sequence.
            pool.run(kParts, [&](int i) {
                next[static_cast<std::size_t>(i)] = now[static_cast<std::size_t>((i + 1) % kParts)] + 1;
            });
            std::swap(now, next);
        }
        CHECK(now == std::vector<int>(kParts, 100'000));
    }
}

TEST_CASE("loops of changing length and content keep their parts apart")
{
    WorkerPool pool(3);
    std::mt19937 random(7);
    bool right = true;
    for (int loop = 0; loop < 20'000; ++loop) {
        const int count = static_cast<int>(random() % 20);
        int got[20] = {};
        if (loop % 2 == 0)
            pool.run(count, [&got, loop](int i) { got[i] += loop + i; });
        else
            pool.run(count, [&got, loop](int i) { got[i] += loop - i; });
        for (int i = 0; i < 20; ++i) right = right && got[i] == (i >= count ? 0 : loop % 2 == 0 ? loop + i : loop - i);
    }
    CHECK(right);
}

TEST_CASE("a loop inside a part is worked off on that part's thread")
{
    for (const int threads : {1, 4}) {
        WorkerPool pool(threads), other(threads);
        std::vector<int> done(16 * 20);
        std::atomic<bool> strayed = false;
        for (const int outer : {16, 1})
            pool.run(outer, [&](int i) {
                const auto self = std::this_thread::get_id();
                const auto inner = [&](int k) {
                    if (std::this_thread::get_id() != self) strayed = true;
                    ++done[static_cast<std::size_t>(i * 20 + k)];
                };
                pool.run(20, inner);
                other.run(20, inner);
            });
        CHECK(!strayed);
        CHECK(std::count(done.begin(), done.begin() + 20, 4) == 20);
        CHECK(std::count(done.begin() + 20, done.end(), 2) == 15 * 20);
    }
}

TEST_CASE("workers that fell asleep come back")
{
    WorkerPool pool(3);
    for (int loop = 0; loop < 50; ++loop) {
        // Pauses around the time for which workers spin: some loops find them spinning, asleep, or on their way.
        std::this_thread::sleep_for(std::chrono::microseconds(loop % 5 == 0 ? 2000 : 3 * loop));
        std::vector<int> done(40);
        pool.run(40, [&](int i) { done[static_cast<std::size_t>(i)] = turn(i, 50) < 2 ? i : -1; });
        std::vector<int> all(40);
        std::iota(all.begin(), all.end(), 0);
        CHECK(done == all);
    }
}

TEST_CASE("a pool may end unused, while its workers spin, and while they sleep")
{
    for (int round = 0; round < 60; ++round) {
        WorkerPool pool(1 + round % 5);
        if (round % 3 == 0) continue;
        CHECK(sumOf(pool, 100) > 0);
        if (round % 3 == 1) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
}

TEST_CASE("one thread after another may use the same pool")
{
    WorkerPool pool(2);
    const double here = sumOf(pool, 1000);
    for (int i = 0; i < 10; ++i) {
        double there = 0;
        std::thread([&] { there = sumOf(pool, 1000); }).join();
        CHECK(there == here);
        CHECK(sumOf(pool, 1000) == here);
    }
}

TEST_CASE("two pools work at the same time")
{
    WorkerPool a(3), b(3);
    double sumA = 0, sumB = 0;
    std::thread other([&] {
        for (int i = 0; i < 300; ++i) sumB = sumOf(b, 1000);
    });
    for (int i = 0; i < 300; ++i) sumA = sumOf(a, 1000);
    other.join();
    CHECK(sumA == sumB);
}

TEST_CASE("a pool with more threads than cores loses nothing")
{
    WorkerPool pool(4 * usableCores() + 1);
    WorkerPool one(1);
    const auto sumOfTurns = [](WorkerPool& who) {
        std::vector<double> terms(97);
        for (int loop = 0; loop < 100; ++loop)
            who.run(97, [&](int i) { terms[static_cast<std::size_t>(i)] += turn(i + loop, 20); });
        return std::accumulate(terms.begin(), terms.end(), 0.0);
    };
    CHECK(sumOfTurns(pool) == sumOfTurns(one));
}

TEST_CASE("workers that keep coming late are left out most of the time, and tried again")
{
    WorkerPool pool(4);
    const auto caller = std::this_thread::get_id();
    std::atomic<bool> late = true, helped = false;
    double out[16] = {};
    const auto part = [&](int i) {
        out[i] = turn(out[i], 20);
        if (std::this_thread::get_id() == caller) return;
        helped = true;
        // To its caller, a worker that sleeps looks like one that lost its core.
        if (late) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    };
    int together = 0;
    constexpr int kLoops = 20'000;
    for (int loop = 0; loop < kLoops; ++loop) {
        helped = false;
        pool.run(16, part);
        together += helped ? 1 : 0;
    }
    CHECK(together < kLoops / 10);

    // On one core nobody can help; with more, each worker is tried at least once a second.
    late = false;
    helped = usableCores() == 1;
    while (!helped) pool.run(16, part);
    CHECK(helped);
}

TEST_CASE("a worker takes part if there is a core for it")
{
    WorkerPool pool(4);
    const auto caller = std::this_thread::get_id();
    std::atomic<bool> helped = usableCores() == 1;
    double out[16] = {};
    const auto part = [&](int i) {
        out[i] = turn(out[i], 100);
        if (std::this_thread::get_id() != caller) helped = true;
    };
    while (!helped) pool.run(16, part);
    CHECK(helped);
}

TEST_CASE("a thread may run on one core at least") { CHECK(usableCores() >= 1); }

} // namespace worker_pool_test
