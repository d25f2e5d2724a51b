#include "apps/filasofia/bench/haptics_run.h"

#include "apps/filasofia/bench/load.h"
#include "filasofia/core/real_time.h"
#include "filasofia/filasofia.h"
#include "filasofia/runtime/clock.h"

#include <numbers>
#include <random>
#include <thread>

namespace filasofia::app {
namespace {

using device::DeviceSample;
using device::Nanoseconds;

constexpr double kPi = std::numbers::pi;
constexpr double kRadius = 5e-3; ///< [m] radius of the ball

/// The pose of a hand that pokes twice a second, 8 mm deep, from 8 mm above, and trembles a little.
DeviceSample pokingHand(double t)
{
    const double w = 4 * kPi, u = 18 * kPi, deep = 8e-3, tremor = 2e-4;
    DeviceSample sample;
    sample.hand.pose.position = {0, deep * std::cos(w * t) + tremor * std::sin(u * t), 0};
    sample.hand.velocity = {0, -deep * w * std::sin(w * t) + tremor * u * std::cos(u * t), 0};
    return sample;
}

/// The poking hand as a device that records each force it receives, and when.
class WatchedHand final : public device::HapticDevice {
public:
    struct Push {
        Nanoseconds time = 0;
        double force = 0.0; ///< [N]
    };

    explicit WatchedHand(std::size_t ticks) { pushes.reserve(ticks); }

    [[nodiscard]] std::string name() const override { return "bench"; }
    void open() override {}
    void close() noexcept override {}
    [[nodiscard]] device::Capabilities capabilities() const override { return {.force = true}; }
    DeviceSample read(double time) noexcept override { return pokingHand(time); }
    bool write(const CouplingForce& onHand) noexcept override
    {
        if (pushes.size() < pushes.capacity()) pushes.push_back({clock_.now(), length(onHand.force)});
        return true;
    }

    std::vector<Push> pushes;

private:
    runtime::Clock clock_ = runtime::steadyClock();
};

/// Evaluates the forces on the hand during the stall and after it.
void readStall(const std::vector<WatchedHand::Push>& pushes, Nanoseconds begin, Nanoseconds end, ServoTimes& out)
{
    // If no tick without force is found, this stays the length of the stall.
    out.zeroAfter = 1e-9 * static_cast<double>(end - begin);
    bool zero = false;
    double last = 0.0;
    for (const auto& push : pushes) {
        if (push.time >= end) out.ramp = std::max(out.ramp, std::abs(push.force - last));
        last = push.force;
        if (push.time < begin || push.time >= end) continue;
        if (!zero && push.force == 0.0 && push.time - begin > 10'000'000) { // excludes the time between two pokes
            zero = true;
            out.zeroAfter = 1e-9 * static_cast<double>(push.time - begin);
        }
        out.pushesInStall += zero && push.force != 0.0;
    }
}

} // namespace

ServoTimes timeServo(const ServoScene& scene)
{
    Simulation sim({.physics = {.rate = scene.physicsRate}});
    sim.add(RigidBodyDef{
        .name = "wall", .elements = {{{0, -20_mm, 0}, {}}}, .mesh = shapes::box({0.1, 0.04, 0.1}), .collision = {{}}});
    const BodyId ball = sim.add(RigidBodyDef{.name = "ball",
                                             .elements = {{{0, kRadius + 8e-3, 0}, {}}},
                                             .mesh = shapes::sphere(kRadius),
                                             .dynamic = true,
                                             .mass = TotalMass{0.03},
                                             .gravity = false,
                                             .collision = {{}}});
    auto made = std::make_unique<WatchedHand>(static_cast<std::size_t>(1100.0 * (scene.seconds + 1.0)));
    const WatchedHand& watched = *made;
    const HapticId hand =
        sim.add({.origin = Pose{{0, kRadius, 0}, {}}, .body = ball, .forceLimit = 10.0}, std::move(made));

    const runtime::Clock clock = runtime::steadyClock();
    Nanoseconds begin = 0, end = 0;
    sim.everyStep([&](double time) {
        // In the second half of the run, while the ball is pressed to the wall.
        if (scene.stall == 0.0 || begin != 0 || time < 0.5 * (scene.seconds - scene.stall)) return;
        if (!(length(sim.haptic(hand).onBody.force) > 1.0)) return;
        begin = clock.now();
        std::this_thread::sleep_for(std::chrono::duration<double>(scene.stall));
        end = clock.now();
    });
    const OthersLoad others;
    sim.run({.backend = Backend::Null, .seconds = scene.seconds});

    ServoTimes out{.scene = scene, .servo = sim.haptic(hand).servo, .others = others.cores()};
    for (const auto& push : watched.pushes) out.maxForce = std::max(out.maxForce, push.force);
    out.zeroWithin = device::watchdogOf(1.0 / scene.physicsRate);
    if (begin != 0) readStall(watched.pushes, begin, end, out);
    return out;
}

ServoTimes timeClock(double seconds)
{
    ServoTimes out{.scene = {.name = "the clock alone", .physicsRate = 0.0, .seconds = seconds}};
    const OthersLoad others;
    std::thread([&] {
        requestRealTime(1);
        const device::ServoClock clock = device::steadyServoClock();
        constexpr Nanoseconds kPeriod = 1'000'000;
        constexpr auto kBin = static_cast<Nanoseconds>(1e9 * device::JitterHistogram::kWidth);
        const Nanoseconds start = clock.now(), end = start + static_cast<Nanoseconds>(1e9 * seconds);
        for (Nanoseconds next = start + kPeriod; next < end; next += kPeriod) {
            clock.sleepUntil(next);
            const Nanoseconds late = std::max<Nanoseconds>(0, clock.now() - next);
            ++out.servo.jitter.counts[static_cast<std::size_t>(
                std::min<Nanoseconds>(late / kBin, device::JitterHistogram::kBins - 1))];
            ++out.servo.ticks;
            out.servo.latest = std::max(out.servo.latest, 1e-9 * static_cast<double>(late));
            if (late > kPeriod) next += late; // like the servo: the time grid restarts
        }
        out.servo.rate = static_cast<double>(out.servo.ticks) / (1e-9 * static_cast<double>(clock.now() - start));
    }).join();
    out.others = others.cores();
    return out;
}

WallEnergy pokeWall(double physicsRate, double stiffness, double jitter)
{
    WallEnergy out{.physicsRate = physicsRate, .stiffness = stiffness, .jitter = jitter};
    device::ServoLoop loop({.coupling = {.linearStiffness = stiffness, .linearDamping = 0.0},
                            .forceLimit = 10.0,
                            .rampIn = 0.0,
                            .stepPeriod = 1.0 / physicsRate});
    loop.setCapabilities({.force = true});
    std::mt19937 random(1);
    std::uniform_real_distribution<double> late(0.0, std::max(jitter, 1e-12));
    device::BodySample body;
    device::ServoTick tick;
    Nanoseconds stepDue = 0, seen = 0;
    Vec3 lastPlace = pokingHand(0.0).hand.pose.position, lastForce;
    double work = 0.0;
    for (int i = 1; i < 20000; ++i) {
        const Nanoseconds now = i * Nanoseconds{1'000'000} + static_cast<Nanoseconds>(1e9 * late(random));
        if (now >= stepDue) { // a massless body: it is at the hand, or at the wall
            stepDue = now + static_cast<Nanoseconds>(1e9 / physicsRate);
            const bool free = tick.hand.pose.position.y > 0.0;
            ++body.number;
            body.time = seen;
            body.body.pose.position = free ? tick.hand.pose.position : Vec3{};
            body.body.velocity = free ? tick.hand.velocity : Vec3{};
        }
        const DeviceSample sample = pokingHand(1e-9 * static_cast<double>(now));
        tick = loop.tick(now, sample, &body);
        seen = now;
        work += dot(lastForce, sample.hand.pose.position - lastPlace); // computed here, independently of the servo loop
        lastPlace = sample.hand.pose.position;
        lastForce = tick.onHand.force;
        out.netEnergy = i == 1 ? work : std::max(out.netEnergy, work);
        out.handWork = std::max(out.handWork, -work);
        out.force = std::max(out.force, length(lastForce));
    }
    return out;
}

} // namespace filasofia::app
