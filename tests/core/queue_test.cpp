#include "filasofia/core/mpsc_queue.h"
#include "filasofia/core/spsc_ring.h"

#include <memory>
#include <thread>

namespace queue_test {

using namespace filasofia;

TEST_CASE("an MPSC queue keeps each writer's order and loses nothing")
{
    constexpr int kWriters = 3, kEach = 20000;
    MpscQueue<std::unique_ptr<int>> queue;
    std::vector<std::thread> writers;
    for (int w = 0; w < kWriters; ++w)
        writers.emplace_back([&, w] {
            for (int i = 0; i < kEach; ++i) queue.push(std::make_unique<int>(w * kEach + i));
        });
    int next[kWriters] = {}, got = 0;
    bool ordered = true;
    while (got < kWriters * kEach) {
        const auto value = queue.pop();
        if (!value) continue;
        const int w = **value / kEach;
        ordered = ordered && **value % kEach == next[w]++;
        ++got;
    }
    for (std::thread& writer : writers) writer.join();
    CHECK(ordered);
    CHECK(!queue.pop());
}

TEST_CASE("an MPSC queue frees what nobody read")
{
    const auto token = std::make_shared<int>(1);
    {
        MpscQueue<std::shared_ptr<int>> queue;
        queue.push(token);
        queue.push(token);
        CHECK(token.use_count() == 3);
    }
    CHECK(token.use_count() == 1);
}

TEST_CASE("an SPSC ring refuses when full and hands elements over in order")
{
    SpscRing<int> ring(2);
    for (int i = 0; i < 2; ++i) {
        *ring.beginWrite() = i;
        ring.publish();
    }
    CHECK(ring.beginWrite() == nullptr);
    CHECK(*ring.beginRead() == 0);
    ring.release();
    CHECK(ring.beginWrite() != nullptr);
    CHECK(*ring.beginRead() == 1);
    ring.release();
    CHECK(ring.beginRead() == nullptr);
}

TEST_CASE("an SPSC ring between two threads loses nothing")
{
    SpscRing<int> ring(64);
    constexpr int kCount = 50000;
    std::thread writer([&] {
        for (int i = 0; i < kCount;) {
            if (int* slot = ring.beginWrite()) {
                *slot = i++;
                ring.publish();
            }
        }
    });
    bool ordered = true;
    for (int i = 0; i < kCount;) {
        if (const int* slot = ring.beginRead()) {
            ordered = ordered && *slot == i++;
            ring.release();
        }
    }
    writer.join();
    CHECK(ordered);
}

} // namespace queue_test
