#include "filasofia/event/event_queue.h"

#include "event/test_events.h"

#include <latch>
#include <thread>

namespace event_queue_test {

using namespace filasofia;
using namespace filasofia::event;

TEST_CASE("a bounded queue refuses when full, hands over in order and goes round many times")
{
    BoundedQueue<int> queue(3); // not a power of two
    int in = 0, out = 0;
    for (int round = 0; round < 10; ++round) {
        while (queue.tryPush(in)) ++in;
        CHECK(in - out == 3);
        CHECK(queue.claimed() == static_cast<std::uint64_t>(in));
        for (int i = 0; i < 2; ++i, ++out) {
            REQUIRE(queue.front() != nullptr);
            CHECK(*queue.front() == out);
            queue.pop();
        }
    }
}

TEST_CASE("an empty bounded queue has no front")
{
    BoundedQueue<int> queue(2);
    CHECK(queue.front() == nullptr);
    int value = 1;
    CHECK(queue.tryPush(value));
    queue.pop();
    CHECK(queue.front() == nullptr);
    CHECK(queue.read() == queue.claimed());
}

TEST_CASE("a collected batch is in the order of posting, across ring and merge places")
{
    EventQueue queue(64, 16);
    const auto push = [&](std::unique_ptr<Event> event) { REQUIRE(queue.tryPush(event)); };
    push(std::make_unique<TouchEvent>(1, 0));
    push(std::make_unique<NumberEvent>(1));
    push(std::make_unique<TouchEvent>(2, 2));
    push(std::make_unique<NumberEvent>(3));
    push(std::make_unique<TouchEvent>(1, 4));
    std::vector<QueuedEvent> batch;
    queue.collect(batch);
    std::vector<int> numbers;
    for (const QueuedEvent& item : batch) {
        const auto* touch = dynamic_cast<const TouchEvent*>(item.event.get());
        numbers.push_back(touch ? touch->number : dynamic_cast<const NumberEvent&>(*item.event).number);
    }
    CHECK(numbers == std::vector<int>{1, 2, 3, 4});
    queue.collect(batch);
    CHECK(batch.empty());
}

namespace {
/// Merges with its like, and stays in absorb() for as long as the test wants.
class SlowEvent final : public Event {
public:
    SlowEvent(std::latch& itsEntered, std::latch& itsMayLeave)
        : Event(EventType::Custom3), entered(itsEntered), mayLeave(itsMayLeave)
    {
    }
    [[nodiscard]] std::optional<MergeKey> mergeKey() const override { return MergeKey{type}; }
    void absorb(const Event&) noexcept override
    {
        entered.count_down();
        mayLeave.wait();
        ++absorbed;
    }
    std::latch &entered, &mayLeave;
    int absorbed = 0;
};
} // namespace

TEST_CASE("a writer does not wait for another that is in the place of the same key")
{
    EventQueue queue(4, 1);
    std::latch entered(1), mayLeave(1);
    const auto push = [&] {
        std::unique_ptr<Event> event = std::make_unique<SlowEvent>(entered, mayLeave);
        return queue.tryPush(event);
    };
    REQUIRE(push());
    std::thread inside([&] { (void)push(); });
    entered.wait();
    CHECK(push()); // hangs if it waits
    mayLeave.count_down();
    inside.join();
    CHECK(queue.merged() == 1);
    std::vector<QueuedEvent> batch;
    queue.collect(batch); // what took another path merges here
    REQUIRE(batch.size() == 1);
    CHECK(batch[0].stamp == 2);
    CHECK(queue.merged() == 2);
}

TEST_CASE("each thread's events keep their order while a reader collects, mergeable or not")
{
    constexpr int kWriters = 3, kEach = 4000;
    EventQueue queue(128, 4); // small: the ring is often full, and keys compete for places
    std::atomic<int> writing = kWriters;
    std::vector<std::thread> writers;
    for (int w = 0; w < kWriters; ++w)
        writers.emplace_back([&, w] {
            for (int i = 0; i < kEach; ++i) {
                // Every third event merges; two keys per thread, and one that all threads share.
                std::unique_ptr<Event> event = std::make_unique<NumberEvent>(w * kEach + i);
                if (i % 3 == 1) {
                    const auto key = static_cast<std::uint64_t>(i % 9 == 1 ? 100 : 2 * w + i % 2);
                    event = std::make_unique<TouchEvent>(key, w * kEach + i);
                }
                while (!queue.tryPush(event)) std::this_thread::yield();
            }
            --writing;
        });

    int last[kWriters] = {-1, -1, -1}, plain = 0, touches = 0;
    bool ordered = true;
    std::vector<QueuedEvent> batch;
    for (bool more = true; more;) {
        more = writing > 0;
        queue.collect(batch);
        for (const QueuedEvent& item : batch) {
            const auto* touch = dynamic_cast<const TouchEvent*>(item.event.get());
            const int number = touch ? touch->number : dynamic_cast<const NumberEvent&>(*item.event).number;
            (touch ? touches : plain) += touch ? touch->absorbed : 1;
            int& before = last[number / kEach];
            ordered = ordered && number % kEach > before;
            before = number % kEach;
        }
    }
    for (std::thread& writer : writers) writer.join();
    CHECK(ordered);
    const int merging = (kEach + 1) / 3;
    CHECK(plain == kWriters * (kEach - merging));
    CHECK(touches == kWriters * merging); // each counts those that it replaced: none is lost
    CHECK(queue.merged() > 0);
}

} // namespace event_queue_test
