#include "filasofia/event/event_dispatcher.h"

#include "event/test_events.h"

#include <latch>
#include <thread>

namespace stress_test {

using namespace filasofia;
using namespace filasofia::event;

namespace {
constexpr int kPosters = 4, kEach = 3000;
} // namespace

TEST_CASE("four posting threads: nothing is lost, each one's order is kept, merged ones are all accounted for")
{
    EventDispatcher dispatcher({.capacity = 256});
    std::vector<int> next(kPosters, 0);
    bool ordered = true;
    int heard = 0, touches = 0, touchCalls = 0;
    dispatcher.on<NumberEvent>([&](const NumberEvent& event) {
        ordered = ordered && event.number % kEach == next[static_cast<std::size_t>(event.number / kEach)]++;
        ++heard;
    });
    dispatcher.on<TouchEvent>([&](const TouchEvent& event) {
        touches += event.absorbed;
        ++touchCalls;
    });
    dispatcher.start();
    std::atomic<std::uint64_t> refused = 0;
    std::vector<std::thread> posters;
    for (int p = 0; p < kPosters; ++p)
        posters.emplace_back([&, p] {
            for (int i = 0; i < kEach; ++i) {
                std::unique_ptr<Event> event = std::make_unique<NumberEvent>(p * kEach + i);
                while (!dispatcher.tryPost(std::move(event))) {
                    ++refused;
                    std::this_thread::yield();
                }
                while (!dispatcher.tryPost(std::make_unique<TouchEvent>(static_cast<std::uint64_t>(i % 5), i)))
                    ++refused;
            }
        });
    for (std::thread& poster : posters) poster.join();
    dispatcher.stop();
    CHECK(ordered);
    CHECK(heard == kPosters * kEach);
    CHECK(touches == kPosters * kEach);
    CHECK(dispatcher.merged() == static_cast<std::uint64_t>(kPosters * kEach - touchCalls));
    CHECK(dispatcher.delivered() == static_cast<std::uint64_t>(heard + touchCalls));
    CHECK(dispatcher.refused() == refused);
}

TEST_CASE("an observer that never comes back keeps nobody from posting, attaching and detaching others")
{
    EventDispatcher dispatcher;
    std::latch entered(1), mayLeave(1);
    int heard = 0;
    const ObserverId stuck = dispatcher.on<NumberEvent>([&](const NumberEvent& event) {
        if (event.number != 0) return;
        entered.count_down();
        mayLeave.wait();
    });
    dispatcher.start();
    dispatcher.post(NumberEvent(0));
    entered.wait();
    for (int i = 1; i <= 100; ++i) dispatcher.post(NumberEvent(i));
    for (int i = 0; i < 100; ++i) CHECK(dispatcher.tryPost(std::make_unique<PhysicsUpdateEvent>()));
    dispatcher.on<NumberEvent>([&](const NumberEvent&) { ++heard; });
    CHECK(dispatcher.detach(dispatcher.on<NumberEvent>([&](const NumberEvent&) { heard = -1000; })));
    mayLeave.count_down();
    dispatcher.stop();
    CHECK(heard == 100); // attached during the delivery of event 0: gets the ones after it
    CHECK(dispatcher.merged() == 99);
    CHECK(dispatcher.detach(stuck));
}

TEST_CASE("posters that outlive stop do not keep it from ending")
{
    EventDispatcher dispatcher;
    std::atomic<bool> done = false;
    std::atomic<std::uint64_t> heard = 0;
    dispatcher.on<NumberEvent>([&](const NumberEvent&) { ++heard; });
    dispatcher.start();
    std::uint64_t posted = 0;
    std::thread poster([&] {
        while (!done) posted += dispatcher.tryPost(std::make_unique<NumberEvent>(0)) ? 1 : 0;
    });
    while (heard < 1000) std::this_thread::yield();
    dispatcher.stop();
    done = true;
    poster.join();
    dispatcher.deliverAll();
    CHECK(heard == posted);
}

TEST_CASE("attach and detach from many threads: no call after detach, and every steady observer hears all")
{
    EventDispatcher dispatcher;
    int steady = 0;
    dispatcher.on<NumberEvent>([&](const NumberEvent&) { ++steady; });
    dispatcher.start();
    std::atomic<bool> done = false;
    std::atomic<int> late = 0, calls = 0;
    std::vector<std::thread> stormers;
    for (int s = 0; s < 3; ++s)
        stormers.emplace_back([&] {
            while (!done) {
                // Lives on this stack: a call after detach() would also use a dead object.
                std::atomic<bool> attached = true;
                const ObserverId id = dispatcher.on<NumberEvent>([&](const NumberEvent&) {
                    ++calls;
                    if (!attached) ++late;
                });
                if (!dispatcher.detach(id)) ++late; // this thread runs no callback, so detach() must wait
                attached = false;
            }
        });
    constexpr int kCount = 5000;
    for (int i = 0; i < kCount; ++i) {
        std::unique_ptr<Event> event = std::make_unique<NumberEvent>(i);
        while (!dispatcher.tryPost(std::move(event))) std::this_thread::yield();
    }
    int extra = 0;
    while (calls == 0) // until one of the short-lived observers was called
        extra += dispatcher.tryPost(std::make_unique<NumberEvent>(0)) ? 1 : 0;
    done = true;
    for (std::thread& stormer : stormers) stormer.join();
    dispatcher.stop();
    CHECK(late == 0);
    CHECK(steady == kCount + extra);
}

TEST_CASE("callbacks that post, attach, detach themselves and throw, from a storm of posters")
{
    LogLines log;
    EventDispatcher dispatcher({.capacity = 20000});
    std::atomic<int> answers = 0, shortLived = 0;
    int heard = 0, thrown = 0;
    dispatcher.on<NumberEvent>([&](const NumberEvent& event) {
        ++heard;
        dispatcher.post(NumberEvent(event.number, EventType::Custom2));
        if (event.number % 100 != 0) return;
        const auto id = std::make_shared<ObserverId>();
        *id = dispatcher.on<NumberEvent>(EventType::Custom2, [&, id](const NumberEvent&) {
            ++shortLived;
            dispatcher.detach(*id);
            if (shortLived % 2 == 0) {
                ++thrown;
                throw std::runtime_error("thrown after detaching itself");
            }
        });
    });
    dispatcher.on<NumberEvent>(EventType::Custom2, [&](const NumberEvent&) { ++answers; });
    dispatcher.start();
    std::vector<std::thread> posters;
    for (int p = 0; p < kPosters; ++p)
        posters.emplace_back([&] {
            for (int i = 0; i < 1000; ++i) dispatcher.post(NumberEvent(i));
        });
    for (std::thread& poster : posters) poster.join();
    dispatcher.stop();
    CHECK(heard == 4000);
    CHECK(answers == 4000);
    CHECK(shortLived == 40); // each was called once and never again
    CHECK(thrown == 20);
    CHECK(log.lines().size() == 20);
}

} // namespace stress_test
