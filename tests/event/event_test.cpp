#include "filasofia/event/event.h"

#include "event/test_events.h"
#include "filasofia/core/error.h"
#include "filasofia/event/input_events.h"

#include <set>

namespace event_test {

using namespace filasofia;
using namespace filasofia::event;

TEST_CASE("every event type has its own name")
{
    std::set<std::string_view> names;
    for (std::size_t i = 0; i < kEventTypes; ++i) names.insert(name(static_cast<EventType>(i)));
    CHECK(names.size() == kEventTypes);
    CHECK(names.count("unknown") == 0);
    CHECK(name(EventType::PhysicsUpdate) == "PhysicsUpdate");
    CHECK(name(EventType::Custom4) == "Custom4");
    CHECK(static_cast<std::size_t>(EventType::Custom4) + 1 == kEventTypes);
}

TEST_CASE("updates and mouse moves merge, clicks, wheel, keys, text and window events do not")
{
    CHECK(PhysicsUpdateEvent().mergeKey() == MergeKey{EventType::PhysicsUpdate, 0});
    CHECK(VisualUpdateEvent().mergeKey() == MergeKey{EventType::VisualUpdate, 0});
    CHECK(MouseMoveEvent().mergeKey() == MergeKey{EventType::MouseMove, 0});
    CHECK(!MouseButtonEvent().mergeKey());
    CHECK(!MouseWheelEvent().mergeKey());
    CHECK(!KeyEvent().mergeKey());
    CHECK(!TextInputEvent().mergeKey());
    CHECK(!WindowEvent().mergeKey());
}

TEST_CASE("a merged mouse move is at the newest place and keeps the whole way")
{
    EventDispatcher dispatcher;
    std::vector<MouseMoveEvent> seen;
    dispatcher.on<MouseMoveEvent>([&](const MouseMoveEvent& move) { seen.push_back(move); });
    for (int i = 1; i <= 5; ++i) {
        MouseMoveEvent move;
        move.x = 10.0 * i;
        move.dx = 10.0;
        move.dy = -1.0;
        move.step = static_cast<std::uint64_t>(i);
        dispatcher.post(move);
    }
    CHECK(dispatcher.deliverAll() == 1);
    REQUIRE(seen.size() == 1);
    CHECK(seen[0].x == 50.0);
    CHECK(seen[0].dx == 50.0);
    CHECK(seen[0].dy == -5.0);
    CHECK(seen[0].step == 5);
    CHECK(dispatcher.merged() == 4);
}

TEST_CASE("a dispatcher's fields are checked against their ranges")
{
    CHECK_THROWS_WITH(EventDispatcher({.capacity = 1}),
                      "event dispatcher: capacity must be in [2, 1048576] events, got 1");
    CHECK_THROWS_AS(EventDispatcher({.mergePlaces = 0}), Error);
    CHECK_THROWS_AS(EventDispatcher({.maximumRounds = 0}), Error);
}

} // namespace event_test
