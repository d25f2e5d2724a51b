#include "filasofia/device/servo_loop.h"

#include "filasofia/core/error.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace servo_loop_test {

using namespace filasofia;
using namespace filasofia::device;

namespace {

constexpr Nanoseconds kMs = 1'000'000;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

ServoDef plain()
{
    return {.coupling = {.linearStiffness = 200, .linearDamping = 0, .angularDamping = 0},
            .forceLimit = 100,
            .torqueLimit = 100,
            .rampIn = 0.0};
}

DeviceSample handAt(Vec3 position, Vec3 velocity = {}) { return {.hand = {{position, {}}, velocity, {}}}; }

/// A loop with a device that exerts force and torque, and a body that rests at the origin and reports it every
/// millisecond.
struct Bench {
    explicit Bench(const ServoDef& def) : loop(def)
    {
        loop.setCapabilities({.orientation = true, .force = true, .torque = true});
    }
    ServoTick tick(const DeviceSample& sample)
    {
        now += kMs;
        ++body.number;
        body.time = now;
        return loop.tick(now, sample, &body);
    }
    ServoLoop loop;
    Nanoseconds now = 0;
    BodySample body;
};

} // namespace

TEST_CASE("the hand is pulled by the coupling, towards the body")
{
    Bench bench(plain());
    const ServoTick tick = bench.tick(handAt({0.01, 0, 0}));
    CHECK(tick.state == ServoState::Running);
    CHECK(distance(tick.onHand.force, {-2.0, 0, 0}) < 1e-12);
    CHECK(length(tick.onHand.torque) < 1e-12);

    DeviceSample turned = handAt({});
    turned.hand.pose.orientation = axisAngle({0, 0, 1}, 0.2);
    CHECK(distance(bench.tick(turned).onHand.torque, {0, 0, -0.1}) < 1e-12);
}

TEST_CASE("scale, origin and force scale map into the scene and back, and create no energy")
{
    ServoDef def = plain();
    def.scale = 4.0;
    def.forceScale = 0.5;
    def.origin = {{1, 2, 3}, axisAngle({0, 0, 1}, 0.5 * std::numbers::pi)}; // the device's x is the scene's y
    Bench bench(def);
    bench.body.body.pose = def.origin;
    bench.body.centre = {0.1, 0, 0};
    const ServoTick tick = bench.tick(handAt({0.01, 0, 0}));
    CHECK(distance(tick.hand.pose.position, {1, 2.04, 3}) < 1e-12);
    CHECK(distance(tick.onHand.force, {-0.5 * 200 * 0.04, 0, 0}) < 1e-12);

    // The work on the hand is force scale over scale times the loss of the coupling's energy, for rotations as for
    // displacements.
    const auto energy = [&](const MotionState& hand) {
        const MotionState there = atPoint(inScene(def, hand), bench.body.centre),
                          here = atPoint(bench.body.body, {0.1, 0, 0});
        const Vec3 turn = rotationVector(there.pose.orientation * conjugate(here.pose.orientation));
        return 0.5 * 200 * lengthSquared(there.pose.position - here.pose.position) + 0.5 * 0.5 * lengthSquared(turn);
    };
    DeviceSample sample = handAt({0.01, 0.02, -0.01});
    sample.hand.pose.orientation = axisAngle({1, 2, 3}, 0.3);
    bench.tick(sample);
    const CouplingForce force = bench.tick(sample).onHand;
    const double h = 1e-6;
    for (int k = 0; k < 3; ++k) {
        Vec3 step;
        step[k] = h;
        MotionState more = sample.hand, less = sample.hand;
        more.pose.position += step;
        less.pose.position -= step;
        CHECK(2 * h * force.force[k] == Approx(-0.5 / 4.0 * (energy(more) - energy(less))).epsilon(1e-6));
        more = less = sample.hand;
        more.pose.orientation = axisAngle(step, h) * more.pose.orientation;
        less.pose.orientation = axisAngle(step, -h) * less.pose.orientation;
        CHECK(2 * h * force.torque[k] == Approx(-0.5 / 4.0 * (energy(more) - energy(less))).epsilon(1e-5));
    }
}

TEST_CASE("the body's last state is extrapolated by its velocity, for two steps at most")
{
    ServoDef def = plain();
    def.stepPeriod = 0.05;
    Bench bench(def);
    bench.body.body.velocity = {0.1, 0, 0};
    CHECK(bench.tick(handAt({})).onHand.force.x == Approx(0.0).margin(1e-12));
    const auto later = [&](int ms) {
        return bench.loop.tick(bench.now + ms * kMs, handAt({}), &bench.body).onHand.force.x;
    };
    CHECK(later(10) == Approx(200 * 0.001));
    CHECK(later(99) == Approx(200 * 0.0099));
    CHECK(later(140) == Approx(200 * 0.01)); // no farther
}

TEST_CASE("force and torque are clamped, and keep their direction")
{
    ServoDef def = plain();
    def.forceLimit = 3.0;
    def.torqueLimit = 0.05;
    Bench bench(def);
    DeviceSample sample = handAt({0.3, 0.4, 0});
    sample.hand.pose.orientation = axisAngle({0, 1, 0}, 1.0);
    const CouplingForce force = bench.tick(sample).onHand;
    CHECK(distance(force.force, {-1.8, -2.4, 0}) < 1e-12);
    CHECK(distance(force.torque, {0, -0.05, 0}) < 1e-12);

    bench.loop.setCapabilities({.orientation = true, .force = true, .forceLimit = 1.0}); // the device's limit
    CHECK(length(bench.tick(sample).onHand.force) == Approx(1.0));
    CHECK(bench.tick(sample).onHand.torque == Vec3{});
    // The body gets no larger force than the hand.
    CHECK(sceneCoupling(def).forceLimit == 3.0);
    def.forceScale = 0.5;
    def.scale = 2.0;
    CHECK(sceneCoupling(def).forceLimit == 6.0);
    CHECK(sceneCoupling(def).torqueLimit == Approx(0.2));
    def.forceScale = 0.0; // the body follows the hand, which gets no force
    CHECK(sceneCoupling(def).forceLimit == 3.0);
}

TEST_CASE("the force ramps in, and rises from zero again after every interruption")
{
    ServoDef def = plain();
    def.rampIn = 0.1;
    Bench bench(def);
    const DeviceSample sample = handAt({0.01, 0, 0});
    const auto pulled = [&] { return -bench.tick(sample).onHand.force.x; };
    CHECK(pulled() == 0.0);
    double last = 0.0;
    for (int i = 1; i <= 100; ++i) {
        const double now = pulled();
        CHECK(now == Approx(2.0 * i / 100.0));
        CHECK(now - last < 0.0201);
        last = now;
    }
    CHECK(pulled() == Approx(2.0));

    bench.loop.interrupt();
    CHECK(pulled() == Approx(0.02));
    while (pulled() < 1.99) continue;
    bench.now += 70 * kMs; // the tick itself is late
    CHECK(pulled() == 0.0);
    CHECK(pulled() == Approx(0.02));
}

TEST_CASE("without a new state of the body for max(50 ms, 3 periods) there is no force")
{
    for (const double period : {1e-3, 0.05}) {
        ServoDef def = plain();
        def.stepPeriod = period;
        Bench bench(def);
        const DeviceSample sample = handAt({0.01, 0, 0});
        CHECK(bench.loop.tick(0, sample, nullptr).state == ServoState::Waiting); // no state has arrived yet
        CHECK(bench.loop.tick(0, sample, nullptr).onHand == CouplingForce{});
        bench.tick(sample);
        const int allowed = period < 0.02 ? 50 : 150;
        for (int ms = 1; ms <= allowed; ++ms)
            CHECK(length(bench.loop.tick(bench.now + ms * kMs, sample, &bench.body).onHand.force) > 0.0);
        for (int ms = allowed + 1; ms < allowed + 100; ++ms) {
            const ServoTick tick = bench.loop.tick(bench.now + ms * kMs, sample, &bench.body);
            CHECK(tick.onHand == CouplingForce{});
            CHECK(tick.state == ServoState::Waiting);
        }
        bench.now += 500 * kMs;
        bench.tick(sample); // the tick was late too
        CHECK(bench.tick(sample).state == ServoState::Running);
    }
}

TEST_CASE("whatever is wrong with the device or the body, the hand gets no force, and at first none afterwards")
{
    const DeviceSample good = handAt({0.01, 0, 0});
    const auto with = [&](auto&& change) {
        DeviceSample bad = good;
        change(bad);
        return bad;
    };
    const DeviceSample bads[] = {
        with([](DeviceSample& s) { s.status = DeviceStatus::Lost; }),
        with([](DeviceSample& s) { s.status = DeviceStatus::Failed; }),
        with([](DeviceSample& s) { s.status = DeviceStatus::NotCalibrated; }),
        with([](DeviceSample& s) { s.hand.pose.position.y = kNan; }),
        with([](DeviceSample& s) { s.hand.pose.position.z = 1e30; }),
        with([](DeviceSample& s) { s.hand.pose.position.z = 0.2; }), // within a millisecond
        with([](DeviceSample& s) {
            s.hand.pose.orientation = {0, 0, 0, 0};
        }),
        with([](DeviceSample& s) { s.hand.pose.orientation.x = kNan; }),
        with([](DeviceSample& s) { s.hand.velocity.x = std::numeric_limits<double>::infinity(); }),
        with([](DeviceSample& s) { s.hand.angularVelocity.x = -1e9; }),
    };
    for (const DeviceSample& bad : bads) {
        Bench bench(plain());
        CHECK(length(bench.tick(good).onHand.force) > 0.0);
        const ServoTick tick = bench.tick(bad);
        CHECK(tick.onHand == CouplingForce{});
        CHECK_FALSE(isGood(tick.state));
        CHECK(tick.hand.pose.position == Vec3{0.01, 0, 0}); // the last valid one
        for (int ms = 1; ms < 100; ++ms) CHECK(bench.tick(good).onHand == CouplingForce{});
        CHECK(length(bench.tick(good).onHand.force) > 0.0);
    }
    Bench bench(plain());
    bench.body.body.velocity.x = kNan;
    CHECK(bench.tick(good).onHand == CouplingForce{});
    bench.body.body.velocity.x = 0.0;
    CHECK(length(bench.tick(good).onHand.force) > 0.0);
}

namespace {

/// A wall at x = 0 that the body cannot enter. Physics sees the hand of the last tick.
struct Wall {
    double period;
    Nanoseconds due = 0, seen = 0;

    void step(Nanoseconds now, const ServoTick& tick, BodySample& body)
    {
        const Nanoseconds before = std::exchange(seen, now);
        if (now < due) return;
        due = now + static_cast<Nanoseconds>(period * 1e9);
        ++body.number;
        body.time = before;
        body.body.pose.position = {std::max(0.0, tick.hand.pose.position.x), 0, 0};
        body.body.velocity = {tick.hand.pose.position.x > 0.0 ? tick.hand.velocity.x : 0.0, 0, 0};
    }
};

} // namespace

TEST_CASE("a hand that pokes a wall never gets more energy than it put in, up to 10 kN/m")
{
    for (const double period : {1e-3, 0.05})
        for (const double stiffness : {100.0, 500.0, 1e3, 2e3, 5e3, 1e4})
            for (const double jitter : {0.0, 0.2}) {
                ServoDef def = plain();
                def.coupling.linearStiffness = stiffness;
                def.forceLimit = 10.0;
                def.stepPeriod = period;
                ServoLoop loop(def);
                loop.setCapabilities({.force = true});
                Wall wall{period};
                BodySample body;
                std::mt19937 random(7);
                std::uniform_real_distribution<double> late(0.0, jitter);
                ServoTick tick;
                double most = -1.0, least = 0.0, work = 0.0;
                Vec3 lastPlace{0.01, 0, 0}, lastForce;
                for (int i = 1; i < 20000; ++i) { // 2 Hz and a tremor of 9 Hz, to 9 mm and beyond
                    const Nanoseconds now = i * kMs + static_cast<Nanoseconds>(late(random) * 1e6);
                    const double t = 1e-9 * static_cast<double>(now), w = 4 * std::numbers::pi,
                                 u = 18 * std::numbers::pi;
                    const DeviceSample sample =
                        handAt({0.01 * std::cos(w * t) + 3e-4 * std::sin(u * t), 0, 0},
                               {-0.01 * w * std::sin(w * t) + 3e-4 * u * std::cos(u * t), 0, 0});
                    wall.step(now, tick, body);
                    tick = loop.tick(now, sample, &body);
                    work += dot(lastForce, sample.hand.pose.position - lastPlace);
                    lastPlace = sample.hand.pose.position;
                    lastForce = tick.onHand.force;
                    CHECK(length(lastForce) <= 10.0 + 1e-12);
                    most = std::max(most, work);
                    least = std::min(least, work);
                    if (i % 5000 == 0) CHECK(tick.energy == Approx(work).margin(1e-12));
                }
                INFO("physics " << 1.0 / period << " Hz, " << stiffness << " N/m, jitter " << jitter);
                CHECK(most <= 0.0);
                CHECK(least < -2e-3); // and it did feel the wall
            }
}

TEST_CASE("a light device thrown at a stiff wall loses energy at every bounce")
{
    ServoDef def = plain();
    def.coupling.linearStiffness = 3000.0;
    def.forceLimit = 30.0;
    ServoLoop loop(def);
    loop.setCapabilities({.force = true});
    Wall wall{1e-3};
    BodySample body;
    ServoTick tick;
    double x = 0.01, v = -0.3, fastest = 0.0; // 80 g, held by nobody
    for (int i = 1; i < 3000; ++i) {
        const DeviceSample sample = handAt({x, 0, 0}, {v, 0, 0});
        wall.step(i * kMs, tick, body);
        tick = loop.tick(i * kMs, sample, &body);
        for (int k = 0; k < 100; ++k) { // it moves freely in between
            v += 1e-5 * tick.onHand.force.x / 0.08;
            x += 1e-5 * v;
        }
        fastest = std::max(fastest, v);
        if (x > 0.02 && v > 0.0) v = -v; // a second wall sends it back
    }
    CHECK(fastest <= 0.3);
    CHECK(fastest > 0.1);
}

TEST_CASE("a body that only pushes returns to the hand only energy that it put in first")
{
    ServoDef def = plain();
    def.energyLimit = 0.02;
    Bench bench(def);
    double x = 0.0, most = -1.0;
    ServoTick tick;
    for (int i = 0; i < 4000; ++i) { // the body is always 1 cm ahead of the hand
        const double v = 0.05 * std::cos(1e-3 * i);
        x += 1e-3 * v;
        bench.body.body.pose.position = {x + (v > 0 ? 0.01 : -0.01), 0, 0};
        tick = bench.tick(handAt({x, 0, 0}, {v, 0, 0}));
        most = std::max(most, tick.energy);
    }
    CHECK(most <= 1e-9);

    // And energy put in long ago is kept only up to a limit.
    for (int i = 0; i < 2000; ++i) { // pushing against the body, for 0.2 J
        x += 5e-5;
        bench.body.body.pose.position = {x - 0.01, 0, 0};
        tick = bench.tick(handAt({x, 0, 0}, {0.05, 0, 0}));
    }
    const double gave = tick.energy;
    CHECK(gave < -0.15);
    for (int i = 0; i < 2000; ++i) { // the body pulls
        x += 5e-5;
        bench.body.body.pose.position = {x + 0.01, 0, 0};
        tick = bench.tick(handAt({x, 0, 0}, {0.05, 0, 0}));
    }
    CHECK(tick.energy - gave == Approx(0.02).epsilon(0.05));
}

TEST_CASE("a servo that cannot be is refused")
{
    ServoDef def;
    def.rate = 0.0;
    CHECK_THROWS_WITH(ServoLoop(def), "haptic servo: rate must be in [1, 10000] Hz, got 0");
    def = {};
    def.forceLimit = 0.0;
    CHECK_THROWS_WITH(ServoLoop(def), "haptic servo: forceLimit must be > 0 N, got 0");
    def = {};
    def.coupling.linearDamping = -1.0;
    CHECK_THROWS_WITH(ServoLoop(def), Catch::Contains("coupling.linearDamping"));
    def = {};
    def.scale = kNan;
    CHECK_THROWS_AS(ServoLoop(def), Error);
}

} // namespace servo_loop_test
