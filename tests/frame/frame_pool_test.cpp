#include "filasofia/frame/frame_pool.h"

#include <array>
#include <thread>

namespace frame_pool_test {

using namespace filasofia;
using namespace filasofia::frame;

namespace {

constexpr int kReadable = FramePool::kFrames - 2; // the number that readers may hold without stopping the writer

/// Every number of the frame is its step, so that a torn frame is noticed.
void fill(Frame& frame, std::uint64_t step)
{
    const auto value = static_cast<double>(step);
    frame.step = step;
    frame.time = value;
    frame.softBodies.resize(1);
    frame.softBodies[0].positions.assign(40, {value, value, value});
}

bool whole(const Frame& frame)
{
    const auto value = static_cast<double>(frame.step);
    bool same = frame.time == value && frame.softBodies.size() == 1 && frame.softBodies[0].positions.size() == 40;
    for (const Vec3& p : frame.softBodies[0].positions) same = same && p == Vec3{value, value, value};
    return same;
}

bool write(FramePool& pool, std::uint64_t step)
{
    Frame* frame = pool.beginWrite();
    if (!frame) return false;
    fill(*frame, step);
    pool.publish();
    return true;
}

} // namespace

TEST_CASE("before the first frame there is none")
{
    FramePool pool;
    CHECK_FALSE(pool.latest());
}

TEST_CASE("the newest frame wins")
{
    FramePool pool;
    for (std::uint64_t step = 1; step <= 50; ++step) REQUIRE(write(pool, step));
    CHECK(pool.latest()->step == 50);
    CHECK(pool.latest()->step == 50); // it stays the newest until there is a newer one
    write(pool, 51);
    CHECK(pool.latest()->step == 51);
}

TEST_CASE("a held frame does not change while the writer goes on")
{
    FramePool pool;
    write(pool, 1);
    const FrameRef held = pool.latest();
    for (std::uint64_t step = 2; step <= 100; ++step) {
        REQUIRE(write(pool, step));
        CHECK(held->step == 1);
        CHECK(whole(*held));
    }
    CHECK(pool.latest()->step == 100);
}

TEST_CASE("a frame being written is not seen before it is published")
{
    FramePool pool;
    write(pool, 1);
    Frame* frame = pool.beginWrite();
    REQUIRE(frame != nullptr);
    fill(*frame, 2);
    CHECK(pool.latest()->step == 1);
    pool.publish();
    CHECK(pool.latest()->step == 2);
}

TEST_CASE("when readers hold too many frames the writer skips, and goes on once one is given back")
{
    FramePool pool;
    std::vector<FrameRef> held;
    std::uint64_t step = 0;
    for (int i = 0; i < kReadable; ++i) {
        REQUIRE(write(pool, ++step));
        held.push_back(pool.latest());
    }
    for (int i = 0; i < 2; ++i) REQUIRE(write(pool, ++step)); // as many as promised: the writer still has two
    held.push_back(pool.latest());
    REQUIRE(write(pool, ++step));
    held.push_back(pool.latest());
    CHECK_FALSE(write(pool, 999));
    CHECK(pool.latest()->step == step);
    for (const FrameRef& each : held) CHECK(whole(*each));

    held.erase(held.begin());
    CHECK(write(pool, ++step));
    CHECK(pool.latest()->step == step);
}

TEST_CASE("a hold can be moved and is given back once")
{
    FramePool pool;
    write(pool, 1);
    FrameRef a = pool.latest();
    FrameRef b = std::move(a);
    CHECK(b);
    CHECK(b->step == 1);
    FrameRef c;
    c = std::move(b);
    CHECK(c->step == 1);
    CHECK((*c).time == 1.0);
    c = FrameRef();
    // Nothing is held any more: readers can take all the frames.
    std::vector<FrameRef> held;
    for (std::uint64_t step = 2; step < 2 + kReadable; ++step) {
        REQUIRE(write(pool, step));
        held.push_back(pool.latest());
    }
    CHECK(write(pool, 100));
}

TEST_CASE("written frames keep their memory")
{
    FramePool pool;
    for (std::uint64_t step = 1; step <= 4; ++step) write(pool, step);
    Frame* frame = pool.beginWrite();
    REQUIRE(frame != nullptr);
    REQUIRE(frame->softBodies.size() == 1);
    const Vec3* memory = frame->softBodies[0].positions.data();
    fill(*frame, 5);
    CHECK(frame->softBodies[0].positions.data() == memory);
    pool.publish();
}

TEST_CASE("one writer and three readers: no frame is torn, no reader goes back in time")
{
    constexpr std::uint64_t kSteps = 100000;
    FramePool pool;
    std::atomic<bool> done = false;
    std::array<int, 3> torn{}, backwards{};
    std::vector<std::thread> readers;
    for (std::size_t r = 0; r < 3; ++r)
        readers.emplace_back([&, r] {
            std::uint64_t last = 0;
            FrameRef previous;
            while (!done || last < kSteps) {
                FrameRef frame = pool.latest();
                if (!frame) continue;
                torn[r] += !whole(*frame);
                torn[r] += previous && !whole(*previous);
                backwards[r] += frame->step < last;
                last = frame->step;
                previous = std::move(frame);
            }
        });
    std::uint64_t skipped = 0;
    for (std::uint64_t step = 1; step <= kSteps; ++step) skipped += !write(pool, step);
    done = true;
    for (std::thread& reader : readers) reader.join();
    for (std::size_t r = 0; r < 3; ++r) {
        CHECK(torn[r] == 0);
        CHECK(backwards[r] == 0);
    }
    CHECK(skipped == 0); // two frames held by each of three readers are within the pool's promise
}

} // namespace frame_pool_test
