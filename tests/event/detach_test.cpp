#include "filasofia/event/event_dispatcher.h"

#include "event/test_events.h"

#include <latch>
#include <thread>

namespace detach_test {

using namespace filasofia;
using namespace filasofia::event;

TEST_CASE("an observer that detaches itself returns at once and is not called again")
{
    EventDispatcher dispatcher;
    int calls = 0;
    ObserverId self;
    const auto token = std::make_shared<int>(1);
    self = dispatcher.on<NumberEvent>([&, token](const NumberEvent&) {
        ++calls;
        CHECK(!dispatcher.detach(self)); // still running: this very call
        CHECK(*token == 1);              // and what it owns still exists
    });
    dispatcher.post(NumberEvent(1));
    dispatcher.post(NumberEvent(2));
    dispatcher.deliverAll();
    CHECK(calls == 1);
    CHECK(token.use_count() == 1);
    CHECK(dispatcher.detach(self)); // no such observer any more
    CHECK(dispatcher.detach({}));
}

TEST_CASE("detach frees what the callback holds, and that may call the dispatcher")
{
    EventDispatcher dispatcher;
    struct Detacher {
        EventDispatcher& dispatcher;
        ObserverId other;
        ~Detacher() { dispatcher.detach(other); }
    };
    int calls = 0;
    const ObserverId other = dispatcher.on<NumberEvent>([&](const NumberEvent&) { ++calls; });
    auto detacher = std::make_shared<Detacher>(Detacher{dispatcher, other});
    const ObserverId id = dispatcher.on<NumberEvent>([detacher](const NumberEvent&) {});
    detacher.reset();
    CHECK(dispatcher.detach(id));
    dispatcher.post(NumberEvent(1));
    dispatcher.deliverAll();
    CHECK(calls == 0);
}

TEST_CASE("detach from another thread waits for the running callback")
{
    EventDispatcher dispatcher;
    std::latch entered(1), mayLeave(1);
    std::atomic<bool> left = false, detached = false;
    auto token = std::make_shared<int>(1);
    const ObserverId id = dispatcher.on<NumberEvent>([&, token](const NumberEvent&) {
        entered.count_down();
        mayLeave.wait();
        left = true;
    });
    dispatcher.start();
    dispatcher.post(NumberEvent(1));
    entered.wait();
    bool leftFirst[2] = {}, ended[2] = {};
    std::vector<std::thread> waiters; // two at once: each gets its guarantee
    for (int i = 0; i < 2; ++i)
        waiters.emplace_back([&, i] {
            ended[i] = dispatcher.detach(id);
            leftFirst[i] = left;
            detached = true;
        });
    std::this_thread::sleep_for(std::chrono::milliseconds(20)); // time in which a bug would show
    CHECK(!detached);
    mayLeave.count_down();
    for (std::thread& waiter : waiters) waiter.join();
    CHECK(leftFirst[0]);
    CHECK(leftFirst[1]);
    CHECK(ended[0]);
    CHECK(ended[1]);
    CHECK(token.use_count() == 1); // what the callback owned is freed when detach() returns
    dispatcher.stop();
}

TEST_CASE("observers of two dispatchers that detach each other at the same time do not wait for ever")
{
    for (int round = 0; round < 50; ++round) {
        EventDispatcher left, right;
        std::latch bothRun(2);
        std::atomic<int> waited = 0, refused = 0, calls = 0;
        ObserverId onLeft, onRight;
        const auto meet = [&](EventDispatcher& other, const ObserverId& id) {
            ++calls;
            bothRun.arrive_and_wait();
            ++(other.detach(id) ? waited : refused);
        };
        onLeft = left.on<NumberEvent>([&](const NumberEvent&) { meet(right, onRight); });
        onRight = right.on<NumberEvent>([&](const NumberEvent&) { meet(left, onLeft); });
        left.start();
        right.start();
        for (int i = 0; i < 3; ++i) {
            left.post(NumberEvent(i));
            right.post(NumberEvent(i));
        }
        left.stop();
        right.stop();
        REQUIRE(calls == 2); // each was called once: both are detached
        REQUIRE(waited == 1);
        REQUIRE(refused == 1);
    }
}

TEST_CASE("a circle of three dispatchers is found as well")
{
    constexpr int kCount = 3;
    for (int round = 0; round < 50; ++round) {
        EventDispatcher dispatchers[kCount];
        ObserverId ids[kCount];
        std::latch allRun(kCount);
        std::atomic<int> waited = 0, refused = 0;
        for (int i = 0; i < kCount; ++i)
            ids[i] = dispatchers[i].on<NumberEvent>([&, i](const NumberEvent&) {
                allRun.arrive_and_wait();
                const int next = (i + 1) % kCount;
                ++(dispatchers[next].detach(ids[next]) ? waited : refused);
            });
        for (EventDispatcher& each : dispatchers) each.start();
        for (EventDispatcher& each : dispatchers) each.post(NumberEvent(1));
        for (EventDispatcher& each : dispatchers) each.stop();
        REQUIRE(waited == kCount - 1);
        REQUIRE(refused == 1);
    }
}

TEST_CASE("two observers of one dispatcher that detach each other: the first to run wins")
{
    EventDispatcher dispatcher;
    ObserverId first, second;
    int firstCalls = 0, secondCalls = 0;
    bool gone = false;
    first = dispatcher.on<NumberEvent>([&](const NumberEvent&) {
        if (++firstCalls > 1) return;
        gone = dispatcher.detach(second); // one dispatcher runs one callback at a time: no wait
    });
    second = dispatcher.on<NumberEvent>([&](const NumberEvent&) {
        ++secondCalls;
        dispatcher.detach(first);
    });
    dispatcher.start();
    dispatcher.post(NumberEvent(1));
    dispatcher.post(NumberEvent(2));
    dispatcher.stop();
    CHECK(gone);
    CHECK(firstCalls == 2);
    CHECK(secondCalls == 0);
}

} // namespace detach_test
