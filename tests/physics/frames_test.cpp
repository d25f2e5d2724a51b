#include "physics/fake_engine.h"

namespace frames_test {

using namespace filasofia;
using namespace filasofia::physics;

TEST_CASE("a frame is captured after every step")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    CHECK_FALSE(server.latest());
    for (int i = 1; i <= 10; ++i) {
        server.step(0.1);
        CHECK(calls.captures == i);
        CHECK(server.latest()->step == static_cast<std::uint64_t>(i));
    }
}

TEST_CASE("readers that hold every frame cost the engine nothing and lose nothing")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    std::vector<frame::FrameRef> held;
    for (int i = 0; i < 20; ++i) {
        server.step(0.1);
        held.push_back(server.latest());
    }
    CHECK(calls.captures == frame::FramePool::kFrames);
    for (int i = 0; i < frame::FramePool::kFrames; ++i) CHECK(held[i]->step == static_cast<std::uint64_t>(i + 1));
    held.clear();
    server.step(0.1);
    CHECK(server.latest()->step == 21);
}

} // namespace frames_test
