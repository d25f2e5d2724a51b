#include "physics/fake_engine.h"

using namespace filasofia;
using namespace filasofia::physics;

TEST_CASE("a frame is captured only when a reader took the last one")
{
    Told told;
    PhysicsServer server = fakeServer(told);
    CHECK_FALSE(server.latest());
    for (int i = 0; i < 10; ++i) server.step(0.1);
    CHECK(told.captures == 1); // the first is made so that there is one
    CHECK(server.latest()->step == 1);
    for (int i = 0; i < 10; ++i) server.step(0.1);
    CHECK(told.captures == 2);
    CHECK(server.latest()->step == 11);
}

TEST_CASE("captureNow publishes a frame whether a reader asked or not")
{
    Told told;
    PhysicsServer server = fakeServer(told);
    for (int i = 0; i < 5; ++i) server.step(0.1);
    server.captureNow();
    CHECK(told.captures == 2);
    CHECK(server.latest()->step == 5);
}

TEST_CASE("readers that hold every frame cost the engine nothing and lose nothing")
{
    Told told;
    PhysicsServer server = fakeServer(told);
    std::vector<frame::FrameRef> held;
    for (int i = 0; i < 20; ++i) {
        server.step(0.1);
        held.push_back(server.latest());
    }
    CHECK(told.captures == frame::FramePool::kFrames);
    for (int i = 0; i < frame::FramePool::kFrames; ++i) CHECK(held[i]->step == static_cast<std::uint64_t>(i + 1));
    held.clear();
    server.step(0.1);
    CHECK(server.latest()->step == 21);
}
