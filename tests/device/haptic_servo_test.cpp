#include "filasofia/device/haptic_servo.h"

#include "filasofia/core/error.h"

#include <atomic>
#include <functional>
#include <thread>

namespace haptic_servo_test {

using namespace filasofia;
using namespace filasofia::device;

namespace {

constexpr Nanoseconds kMs = 1'000'000;

/// A device and a clock under the test's control.
struct Hand final : HapticDevice {
    [[nodiscard]] std::string name() const override { return "hand"; }
    void open() override
    {
        ++opened;
        if (missing) fail("there is none");
    }
    void close() noexcept override { ++closed; }
    [[nodiscard]] Capabilities capabilities() const override { return {.force = true}; }
    DeviceSample read(double) noexcept override
    {
        now += readTakes;
        return sample;
    }
    bool write(const CouplingForce& onHand) noexcept override
    {
        now += writeTakes;
        given = onHand;
        return !refuses;
    }
    [[nodiscard]] std::string problem() const override { return "a word"; }

    Nanoseconds now = 0, readTakes = 0, writeTakes = 0;
    bool missing = false, refuses = false;
    int opened = 0, closed = 0;
    DeviceSample sample;
    CouplingForce given;
};

struct Held {
    Hand hand;
    std::vector<DeviceNotice> notices;
    HapticServo servo{hand,
                      {.coupling = {.linearStiffness = 100, .linearDamping = 0}, .rampIn = 0.0},
                      {[this] { return hand.now; }, [](Nanoseconds) {}},
                      [this](const DeviceNotice& notice) { notices.push_back(notice); }};
    std::uint64_t states = 0;

    void tick(int times = 1)
    {
        for (int i = 0; i < times; ++i) {
            hand.now += kMs;
            servo.setBody({++states, hand.now, {}, {}});
            servo.tick(1e-9 * static_cast<double>(hand.now));
        }
    }
};

} // namespace

TEST_CASE("a tick reads the device, pushes the hand and publishes a snapshot")
{
    Held held;
    held.servo.open();
    held.hand.sample.hand.pose.position = {0.01, 0, 0};
    held.tick();
    CHECK(held.hand.given.force == Vec3{-1, 0, 0});
    ServoSnapshot seen;
    REQUIRE(held.servo.latest(seen));
    CHECK(seen.time == kMs);
    CHECK(seen.tick.onHand.force == Vec3{-1, 0, 0});
    CHECK(seen.tick.hand.pose.position == Vec3{0.01, 0, 0});
    CHECK(held.servo.statistics().ticks == 1);
    held.servo.close();
    CHECK(held.hand.given == CouplingForce{}); // no force is left
    CHECK(held.hand.closed == 1);
    REQUIRE(held.notices.size() == 1);
    CHECK(held.notices[0].kind == DeviceNotice::Kind::Connected);
}

TEST_CASE("a fault is reported once, and so is its end")
{
    Held held;
    held.servo.open();
    held.tick(10);
    held.hand.sample.hand.pose.position.x = std::numeric_limits<double>::quiet_NaN();
    held.tick(500);
    CHECK(held.hand.given == CouplingForce{});
    held.hand.sample.hand.pose.position.x = 0.01;
    held.tick(99);
    CHECK(held.notices.size() == 2);
    CHECK(held.hand.given == CouplingForce{});
    held.tick(10);
    REQUIRE(held.notices.size() == 3);
    CHECK(held.notices[1].kind == DeviceNotice::Kind::Error);
    CHECK(held.notices[1].problem == "implausible: a word");
    CHECK(held.notices[2].kind == DeviceNotice::Kind::Connected);
    CHECK(length(held.hand.given.force) > 0.0);
}

TEST_CASE("a call that blocks is reported, and the force rises from zero again")
{
    for (const bool reading : {true, false}) {
        Held held;
        held.servo.open();
        held.hand.sample.hand.pose.position = {0.01, 0, 0};
        held.tick(5);
        (reading ? held.hand.readTakes : held.hand.writeTakes) = 100 * kMs;
        held.tick();
        held.hand.readTakes = held.hand.writeTakes = 0;
        held.tick(2000);
        REQUIRE(held.notices.size() == 2);
        CHECK(held.notices[1].kind == DeviceNotice::Kind::Error);
        CHECK(held.notices[1].problem ==
              text(reading ? "a read" : "a write", " took 100 ms; the force rises from zero again"));
        CHECK(held.servo.statistics().longestCall == Approx(0.1));
        CHECK(held.hand.given.force == Vec3{-1, 0, 0});
    }
}

TEST_CASE("a device that is not there is reported once and tried every second")
{
    Held held;
    held.hand.missing = true;
    held.servo.open();
    held.tick(2500);
    CHECK(held.hand.opened == 3);
    REQUIRE(held.notices.size() == 1);
    CHECK(held.notices[0].problem == "there is none");
    held.hand.missing = false;
    held.tick(1000);
    CHECK(held.hand.opened == 4);
    REQUIRE(held.notices.size() == 2);
    CHECK(held.notices[1].kind == DeviceNotice::Kind::Connected);

    held.hand.sample.status = DeviceStatus::Lost; // it is unplugged, and comes back
    held.tick(100);
    CHECK(held.notices.size() == 3);
    CHECK(held.notices.back().kind == DeviceNotice::Kind::Lost);
    CHECK(held.notices.back().problem == "lost: a word");
    held.tick(1000);
    CHECK(held.hand.opened == 5);
    const std::size_t before = held.notices.size();
    held.hand.sample.status = DeviceStatus::Ready;
    held.tick(2000);
    CHECK(held.notices.size() <= before + 1);
    CHECK(held.notices.back().kind == DeviceNotice::Kind::Connected);
}

TEST_CASE("buttons, refused forces and another placement are reported and applied")
{
    Held held;
    held.servo.open();
    held.hand.sample.buttons = 0b101;
    held.tick(3);
    held.hand.sample.buttons = 0b100;
    held.tick(3);
    REQUIRE(held.notices.size() == 4);
    CHECK((held.notices[1].button == 0 && held.notices[1].pressed));
    CHECK((held.notices[2].button == 2 && held.notices[2].pressed));
    CHECK((held.notices[3].button == 0 && !held.notices[3].pressed));
    held.hand.refuses = true;
    held.tick(50);
    REQUIRE(held.notices.size() == 5);
    CHECK(held.notices[4].problem == "the device refuses the force: a word");
    held.hand.refuses = false;

    held.hand.sample.hand.pose.position = {0.01, 0, 0};
    CHECK(held.servo.place(2.0, {{1, 0, 0}, {}}) == 1);
    held.tick();
    ServoSnapshot seen;
    REQUIRE(held.servo.latest(seen));
    CHECK(seen.placing == 1);
    CHECK(seen.tick.hand.pose.position == Vec3{1.02, 0, 0});
}

TEST_CASE("the last of 32 buttons is reported, too")
{
    Held held;
    held.servo.open();
    held.hand.sample.buttons = 1u << 31 | 1u; // a motion file may have any of them
    held.tick();
    held.hand.sample.buttons = 0;
    held.tick();
    REQUIRE(held.notices.size() == 5);
    CHECK((held.notices[2].button == 31 && held.notices[2].pressed));
    CHECK((held.notices[4].button == 31 && !held.notices[4].pressed));
}

TEST_CASE("the lateness of wake-ups is counted, and percentiles are upper ends of bins")
{
    Hand hand;
    std::atomic<bool> enough = false;
    int wakes =
        0; // out of a hundred wake-ups, 90 are on time, 9 a tenth of a millisecond late, and one ten milliseconds late
    const ServoClock clock{[&] { return hand.now; },
                           [&](Nanoseconds time) {
                               const int each = wakes++ % 100;
                               hand.now = time + (each < 90 ? 5'000 : each < 99 ? 105'000 : 10 * kMs);
                               enough = enough || wakes == 1000;
                           }};
    HapticServo servo(hand, {.rate = 1000}, clock, [](const DeviceNotice&) {});
    servo.start(false);
    while (!enough) std::this_thread::yield();
    servo.stop();
    const ServoStatistics all = servo.statistics();
    CHECK(all.jitter.percentile(0.5) == Approx(10e-6));
    CHECK(all.jitter.percentile(0.9) == Approx(10e-6));
    CHECK(all.jitter.percentile(0.98) == Approx(110e-6));
    CHECK(all.latest == Approx(10e-3));
    CHECK(JitterHistogram{}.percentile(0.5) == 0.0);
    JitterHistogram one;
    one.counts[255] = 1;
    CHECK(one.percentile(0.5) == std::numeric_limits<double>::infinity());
}

TEST_CASE("the newest of a value is read whole while it is written")
{
    struct Pair {
        std::uint64_t a = 0, b = 0, c[40] = {};
    };
    Latest<Pair> latest;
    Pair out;
    CHECK_FALSE(latest.read(out));
    std::atomic<bool> stop = false;
    std::thread writer([&] {
        for (std::uint64_t i = 1; !stop; ++i) {
            Pair value{i, 2 * i, {}};
            value.c[39] = 3 * i;
            latest.write(value);
        }
    });
    std::uint64_t last = 0;
    for (int reads = 0; reads < 20000;) {
        if (!latest.read(out)) continue;
        ++reads;
        REQUIRE(out.b == 2 * out.a);
        REQUIRE(out.c[39] == 3 * out.a);
        REQUIRE(out.a >= last);
        last = out.a;
    }
    stop = true;
    writer.join();
}

} // namespace haptic_servo_test
