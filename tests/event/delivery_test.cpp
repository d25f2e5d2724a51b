#include "filasofia/event/event_dispatcher.h"

#include "event/test_events.h"
#include "filasofia/core/error.h"

#include <thread>

namespace delivery_test {

using namespace filasofia;
using namespace filasofia::event;

TEST_CASE("observers of a type hear its events with payload, time and step, in the order of attachment")
{
    EventDispatcher dispatcher;
    std::string heard;
    dispatcher.on<NumberEvent>(
        [&](const NumberEvent& event) { heard += text("a", event.number, "@", event.time, "/", event.step, " "); });
    dispatcher.on<NumberEvent>([&](const NumberEvent& event) { heard += text("b", event.number, " "); });
    dispatcher.attach(EventType::Custom2, [&](const Event&) { heard += "never "; });
    NumberEvent event(7);
    event.time = 0.5;
    event.step = 100;
    dispatcher.post(event);
    dispatcher.post(NumberEvent(8));
    CHECK(heard.empty()); // nothing before delivery
    CHECK(dispatcher.deliverAll() == 2);
    CHECK(heard == "a7@0.5/100 b7 a8@0/0 b8 ");
    CHECK(dispatcher.delivered() == 2);
    CHECK(dispatcher.deliverAll() == 0);
}

TEST_CASE("what one thread posts arrives in order, a merged event at the place of the newest")
{
    EventDispatcher dispatcher;
    std::string heard;
    dispatcher.on<NumberEvent>([&](const NumberEvent& event) { heard += text("n", event.number, " "); });
    dispatcher.on<TouchEvent>(
        [&](const TouchEvent& event) { heard += text("t", event.pair, ".", event.number, "x", event.absorbed, " "); });
    dispatcher.post(TouchEvent(1, 1));
    dispatcher.post(NumberEvent(1));
    dispatcher.post(TouchEvent(2, 2)); // another pair: does not merge with the first
    dispatcher.post(TouchEvent(1, 3));
    dispatcher.post(NumberEvent(2));
    dispatcher.post(TouchEvent(1, 4));
    CHECK(dispatcher.deliverAll() == 4);
    CHECK(heard == "n1 t2.2x1 n2 t1.4x3 ");
    CHECK(dispatcher.merged() == 2);
}

TEST_CASE("more merge keys than merge places still merge and keep their order")
{
    EventDispatcher dispatcher({.capacity = 1024, .mergePlaces = 2});
    std::string heard;
    dispatcher.on<TouchEvent>([&](const TouchEvent& event) { heard += text(event.number, "x", event.absorbed, " "); });
    for (int i = 0; i < 30; ++i) dispatcher.post(TouchEvent(static_cast<std::uint64_t>(i % 10), i));
    CHECK(dispatcher.deliverAll() == 10);
    CHECK(heard == "20x3 21x3 22x3 23x3 24x3 25x3 26x3 27x3 28x3 29x3 ");
    CHECK(dispatcher.merged() == 20);
}

TEST_CASE("a full queue throws for post, refuses for tryPost and loses nothing that was accepted")
{
    EventDispatcher dispatcher({.capacity = 3});
    std::vector<int> heard;
    dispatcher.on<NumberEvent>([&](const NumberEvent& event) { heard.push_back(event.number); });
    for (int i = 0; i < 3; ++i) dispatcher.post(NumberEvent(i));
    CHECK_THROWS_WITH(
        dispatcher.post(NumberEvent(3)),
        "event dispatcher: the queue is full: 3 events are waiting (capacity); the Custom1 event was refused");
    std::unique_ptr<Event> kept = std::make_unique<NumberEvent>(4);
    CHECK(!dispatcher.tryPost(std::move(kept)));
    REQUIRE(kept); // refused: still owned by the caller
    CHECK(dispatcher.refused() == 2);
    // A merge key has its own place.
    for (int i = 0; i < 100; ++i) CHECK(dispatcher.tryPost(std::make_unique<PhysicsUpdateEvent>()));
    CHECK(dispatcher.deliverAll() == 4);
    CHECK(dispatcher.tryPost(std::move(kept)));
    CHECK(!kept);
    dispatcher.deliverAll();
    CHECK(heard == std::vector<int>{0, 1, 2, 4});
}

TEST_CASE("an event of another class under the same type is skipped, counted and logged once")
{
    LogLines log;
    EventDispatcher dispatcher;
    int typed = 0, any = 0;
    dispatcher.on<NumberEvent>(EventType::Custom2, [&](const NumberEvent&) { ++typed; });
    dispatcher.attach(EventType::Custom2, [&](const Event&) { ++any; });
    std::atomic<int> alive = 0;
    dispatcher.post(std::make_unique<CountedEvent>(alive));
    dispatcher.post(NumberEvent(1, EventType::Custom2));
    dispatcher.post(std::make_unique<CountedEvent>(alive));
    dispatcher.deliverAll();
    CHECK(typed == 1);
    CHECK(any == 3);
    CHECK(dispatcher.skipped() == 2);
    CHECK(log.lines().size() == 1);
    CHECK(alive == 0);
}

TEST_CASE("a callback that throws is logged once and detached, the others go on")
{
    LogLines log;
    EventDispatcher dispatcher;
    int thrown = 0, others = 0;
    dispatcher.on<NumberEvent>([&](const NumberEvent&) {
        ++thrown;
        fail("no such polyp");
    });
    dispatcher.on<NumberEvent>([&](const NumberEvent&) { ++others; });
    dispatcher.on<NumberEvent>([&, first = true](const NumberEvent&) mutable {
        if (std::exchange(first, false)) throw 42; // not a std::exception
    });
    for (int i = 0; i < 3; ++i) dispatcher.post(NumberEvent(i));
    dispatcher.deliverAll();
    CHECK(thrown == 1);
    CHECK(others == 3);
    REQUIRE(log.lines().size() == 2);
    CHECK(log.lines()[0] ==
          "event dispatcher: an observer of Custom1 events threw at step 0 and was detached: no such polyp");
    CHECK(log.lines()[1] == "event dispatcher: an observer of Custom1 events threw at step 0 and was detached: it "
                            "threw something that is not a std::exception");
}

TEST_CASE("deliverAll also delivers what observers post in answer, and what those observers answer")
{
    EventDispatcher dispatcher;
    std::vector<int> heard;
    dispatcher.on<NumberEvent>([&](const NumberEvent& event) {
        heard.push_back(event.number);
        if (event.number < 5) dispatcher.post(NumberEvent(event.number + 1));
    });
    dispatcher.post(NumberEvent(1));
    CHECK(dispatcher.deliverAll() == 5);
    CHECK(heard == std::vector<int>{1, 2, 3, 4, 5});
}

TEST_CASE("observers that answer each other for ever are an error, in deliverAll and in stop")
{
    EventDispatcher dispatcher({.maximumRounds = 10});
    std::atomic<int> heard = 0;
    const ObserverId id = dispatcher.on<NumberEvent>([&](const NumberEvent& event) {
        ++heard;
        dispatcher.post(event);
    });
    dispatcher.post(NumberEvent(1));
    CHECK_THROWS_AS(dispatcher.deliverAll(), Error);
    CHECK(heard == 10);
    dispatcher.start();
    CHECK_THROWS_AS(dispatcher.stop(), Error);
    CHECK(dispatcher.detach(id));
    CHECK(dispatcher.deliverAll() == 1); // the last answer was still queued
    dispatcher.stop();
}

TEST_CASE("callbacks attach and detach others while being called")
{
    EventDispatcher dispatcher;
    std::string heard;
    ObserverId second;
    dispatcher.on<NumberEvent>([&](const NumberEvent& event) {
        heard += "a";
        if (event.number == 1) {
            CHECK(dispatcher.detach(second)); // not running: removed at once, does not get this event any more
            dispatcher.on<NumberEvent>([&](const NumberEvent&) { heard += "c"; });
        }
    });
    second = dispatcher.on<NumberEvent>([&](const NumberEvent&) { heard += "b"; });
    for (int i = 0; i < 3; ++i) {
        dispatcher.post(NumberEvent(i));
        dispatcher.deliverAll();
        heard += " ";
    }
    CHECK(heard == "ab a ac "); // c gets the events after the one during which it was attached
}

TEST_CASE("nobody delivers while somebody delivers")
{
    EventDispatcher dispatcher;
    LogLines log;
    dispatcher.on<NumberEvent>([&](const NumberEvent&) {
        CHECK_THROWS_AS(dispatcher.deliverAll(), Error);
        CHECK_THROWS_AS(dispatcher.start(), Error);
        CHECK_THROWS_AS(dispatcher.stop(), Error);
    });
    dispatcher.post(NumberEvent(1));
    CHECK(dispatcher.deliverAll() == 1);
    dispatcher.start();
    CHECK_THROWS_AS(dispatcher.start(), Error);
    CHECK_THROWS_AS(dispatcher.deliverAll(), Error);
    dispatcher.stop();
    CHECK(dispatcher.deliverAll() == 0);
}

TEST_CASE("the own thread delivers, stop delivers the rest, and both can be had again")
{
    EventDispatcher dispatcher;
    std::vector<int> heard;
    std::thread::id where;
    dispatcher.on<NumberEvent>([&](const NumberEvent& event) {
        heard.push_back(event.number);
        where = std::this_thread::get_id();
    });
    for (int round = 0; round < 3; ++round) {
        dispatcher.start();
        for (int i = 0; i < 50; ++i) dispatcher.post(NumberEvent(50 * round + i));
        dispatcher.stop();
        CHECK(heard.size() == static_cast<std::size_t>(50 * (round + 1)));
        CHECK(where != std::this_thread::get_id());
    }
    CHECK(std::is_sorted(heard.begin(), heard.end()));
}

TEST_CASE("the own thread wakes for a single event")
{
    EventDispatcher dispatcher;
    std::atomic<int> heard = 0;
    dispatcher.on<NumberEvent>([&](const NumberEvent& event) {
        heard = event.number;
        heard.notify_one();
    });
    dispatcher.start();
    for (int i = 1; i <= 200; ++i) { // hangs if a wake-up is lost
        dispatcher.post(NumberEvent(i));
        heard.wait(i - 1);
        REQUIRE(heard == i);
    }
    dispatcher.stop();
}

TEST_CASE("a dispatcher that goes frees what is queued and delivers none of it")
{
    std::atomic<int> alive = 0;
    int heard = 0;
    {
        EventDispatcher dispatcher;
        dispatcher.attach(EventType::Custom2, [&](const Event&) { ++heard; });
        for (int i = 0; i < 10; ++i) dispatcher.post(std::make_unique<CountedEvent>(alive));
        for (int i = 0; i < 10; ++i) dispatcher.post(std::make_unique<CountedEvent>(alive, true));
        CHECK(alive == 11); // merged ones are freed at once
    }
    CHECK(alive == 0);
    CHECK(heard == 0);
}

TEST_CASE("a dispatcher that goes while its thread is busy waits for the callback and drops the rest")
{
    std::atomic<int> alive = 0, heard = 0;
    std::atomic<bool> entered = false;
    {
        EventDispatcher dispatcher;
        dispatcher.attach(EventType::Custom2, [&](const Event&) {
            entered = true;
            entered.notify_one();
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
            ++heard;
        });
        for (int i = 0; i < 100; ++i) dispatcher.post(std::make_unique<CountedEvent>(alive));
        dispatcher.start();
        entered.wait(false);
    }
    CHECK(alive == 0);
    CHECK(heard >= 1);
    CHECK(heard < 100);
}

} // namespace delivery_test
