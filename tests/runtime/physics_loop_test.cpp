#include "filasofia/runtime/physics_loop.h"

#include "filasofia/engine/native_engine.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/physics/physics_server.h"
#include "physics/fake_engine.h"

namespace physics_loop_test {

using namespace filasofia;
using namespace filasofia::runtime;

namespace {

constexpr Nanoseconds kMs = 1'000'000;

/// A clock that a test sets: sleeping moves it to the wake-up time plus a given lateness.
struct FakeClock {
    Nanoseconds time = 12345;
    Nanoseconds oversleep = 0;
    int sleeps = 0;

    Clock clock()
    {
        return {.now = [this] { return time; },
                .sleepUntil =
                    [this](Nanoseconds wake) {
                        ++sleeps;
                        time = std::max(time, wake) + oversleep;
                    }};
    }
};

physics::SoftBodyDef bunny()
{
    return {.name = "bunny",
            .mesh = FILASOFIA_SOURCE_DIR "/assets/meshes/bunny_756.msh",
            .attachments = {{.box = geometry::Box{{-1, 0.105, -1}, {1, 1, 1}}}}};
}

const std::atomic<bool> kNeverStop = false;

} // namespace

TEST_CASE("on a quiet machine simulated time equals wall time to the microsecond")
{
    FakeClock fake;
    fake.oversleep = 70'000;
    physics::PhysicsServer server(engine::makeNativeEngine());
    const Nanoseconds start = fake.time;
    double last = 0.0;
    const RunTiming timing = runPhysics(server, {.period = kMs, .slack = 2 * kMs, .maxSteps = 1000}, fake.clock(),
                                        kNeverStop, [&](const physics::StepReport& report) {
                                            last = report.time;
                                            fake.time += 400'000; // duration of the step
                                            return 0u;
                                        });
    const Nanoseconds lastWake = timing.steps.back().wake + start;
    CHECK(std::abs(last - toSeconds(lastWake - start)) < 1e-6);
    CHECK(timing.simulatedSeconds == Approx(last).epsilon(1e-12));
    CHECK(timing.late == 0);
    CHECK(timing.clamped == 0);
    CHECK(timing.stepCount == 1000);
}

TEST_CASE("under load no step is longer than period and slack, the report counts it, and the state stays finite")
{
    FakeClock fake;
    physics::PhysicsServer server(engine::makeNativeEngine());
    server.add(bunny());
    const Nanoseconds period = 5 * kMs, slack = 2 * kMs;
    std::mt19937 random(3);
    std::uniform_int_distribution<Nanoseconds> load(kMs, 20 * kMs);
    double longest = 0.0;
    std::uint64_t clampedReports = 0;
    const RunTiming timing = runPhysics(server, {.period = period, .slack = slack, .maxSteps = 200}, fake.clock(),
                                        kNeverStop, [&](const physics::StepReport& report) {
                                            longest = std::max(longest, report.dt);
                                            clampedReports += report.has(physics::StepFlag::Clamped);
                                            CHECK_FALSE(report.has(physics::StepFlag::Undone));
                                            fake.time += load(random);
                                            return 0u;
                                        });
    CHECK(longest <= toSeconds(period + slack));
    CHECK(longest == Approx(toSeconds(period + slack)));
    CHECK(timing.clamped > 20);
    CHECK(timing.clamped == clampedReports);
    CHECK(timing.realTimeFactor() < 0.9);
    const frame::FrameRef frame = server.latest();
    for (const Vec3& p : frame->softBodies[0].positions) CHECK(isFinite(p));
}

TEST_CASE("the longest time on end that was slower than real time is told")
{
    FakeClock fake;
    physics::PhysicsServer server(engine::makeNativeEngine());
    const std::vector<Nanoseconds> costs{0, 8, 9, 0, 0, 6, 6, 7, 6, 0}; // [ms]; a step of more than 7 ms is clamped
    const RunTiming timing = runPhysics(server, {.period = 5 * kMs, .slack = 2 * kMs, .maxSteps = costs.size()},
                                        fake.clock(), kNeverStop, [&](const physics::StepReport& report) {
                                            fake.time += costs[report.step - 1] * kMs;
                                            return 0u;
                                        });
    CHECK(timing.clamped == 2);
    CHECK(timing.longestBehind == Approx(0.017));
}

TEST_CASE("flags that the runtime knows reach the next report")
{
    FakeClock fake;
    physics::PhysicsServer server(engine::makeNativeEngine());
    int lost = 0;
    const auto flag = static_cast<std::uint32_t>(physics::StepFlag::EventLost);
    runPhysics(server, {.period = kMs, .maxSteps = 3}, fake.clock(), kNeverStop,
               [&](const physics::StepReport& report) {
                   lost += report.has(physics::StepFlag::EventLost);
                   return flag;
               });
    CHECK(lost == 2);
}

TEST_CASE("a free-running loop does not sleep and steps by the period")
{
    FakeClock fake;
    physics::PhysicsServer server(engine::makeNativeEngine());
    const RunTiming timing = runPhysics(server, {.period = kMs, .freeRunning = true, .maxSteps = 10}, fake.clock(),
                                        kNeverStop, [](const physics::StepReport&) { return 0u; });
    CHECK(fake.sleeps == 0);
    CHECK(timing.simulatedSeconds == Approx(0.01));
}

TEST_CASE("every live step is given the time until its deadline, counted from its start")
{
    FakeClock fake;
    fake.oversleep = 70'000;
    physics::EngineCalls calls;
    physics::PhysicsServer server = physics::fakeServer(calls);
    std::vector<Nanoseconds> expected;
    const Nanoseconds start = fake.time;
    const RunTiming timing = runPhysics(server, {.period = kMs, .slack = 2 * kMs, .deadline = kMs, .maxSteps = 50},
                                        fake.clock(), kNeverStop, [&](const physics::StepReport&) {
                                            fake.time += 400'000;
                                            return 0u;
                                        });
    for (const StepTiming& step : timing.steps) expected.push_back(start + step.wake + kMs);
    CHECK(expected.size() == 50);
    CHECK(calls.deadlines == expected);
}

TEST_CASE("an infinite deadline is the largest time, and so is none at all")
{
    constexpr Nanoseconds never = std::numeric_limits<Nanoseconds>::max();
    for (const std::optional<Nanoseconds> deadline :
         {std::optional<Nanoseconds>(), std::optional<Nanoseconds>(never)}) {
        FakeClock fake;
        physics::EngineCalls calls;
        physics::PhysicsServer server = physics::fakeServer(calls);
        runPhysics(server, {.period = kMs, .deadline = deadline, .maxSteps = 3}, fake.clock(), kNeverStop,
                   [](const physics::StepReport&) { return 0u; });
        CHECK(calls.deadlines == std::vector<Nanoseconds>(3, never)); // there is still a clock for the stages' times
    }
}

TEST_CASE("a step whose solver is stopped ends at its deadline and says so")
{
    FakeClock fake;
    physics::EngineCalls calls{.needed = 10};
    calls.iterate = [&] { fake.time += 300'000; };
    physics::PhysicsServer server = physics::fakeServer(calls);
    server.add(physics::SoftBodyDef{.mesh = physics::oneTetrahedron()});
    int outOfTime = 0;
    const RunTiming timing = runPhysics(server, {.period = kMs, .slack = 2 * kMs, .deadline = kMs, .maxSteps = 4},
                                        fake.clock(), kNeverStop, [&](const physics::StepReport& report) {
                                            outOfTime += report.has(physics::StepFlag::OutOfTime);
                                            return 0u;
                                        });
    CHECK(outOfTime == 4);
    // The fourth iteration goes over the deadline, which is checked after each one.
    CHECK(calls.iterations == std::vector<std::vector<int>>(4, {4}));
    for (const StepTiming& step : timing.steps) CHECK(step.cost == 1'200'000);
}

TEST_CASE("the loop ends when its stop flag is set")
{
    FakeClock fake;
    physics::PhysicsServer server(engine::makeNativeEngine());
    std::atomic<bool> stop = false;
    const RunTiming timing =
        runPhysics(server, {.period = kMs}, fake.clock(), stop, [&](const physics::StepReport& report) {
            if (report.step == 7) stop = true;
            return 0u;
        });
    CHECK(timing.stepCount == 7);
}

TEST_CASE("the machine's clock wakes no earlier than asked")
{
    const Clock clock = steadyClock();
    for (int i = 0; i < 20; ++i) {
        const Nanoseconds wake = clock.now() + 200'000;
        clock.sleepUntil(wake);
        CHECK(clock.now() >= wake);
    }
}

TEST_CASE("a callback before a step gets the length that the step then has")
{
    FakeClock fake;
    physics::PhysicsServer server(engine::makeNativeEngine());
    std::vector<double> announced, made;
    std::mt19937 random(5);
    std::uniform_int_distribution<Nanoseconds> load(kMs / 2, 5 * kMs); // some late, some clamped
    const auto afterStep = [&](const physics::StepReport& report) {
        made.push_back(report.dt);
        fake.time += load(random);
        return 0u;
    };
    runPhysics(server, {.period = kMs, .slack = kMs, .maxSteps = 50}, fake.clock(), kNeverStop, afterStep,
               [&](double dt) {
                   CHECK(announced.size() == made.size());
                   announced.push_back(dt);
               });
    CHECK(announced.size() == 50);
    CHECK(announced == made);
}

} // namespace physics_loop_test
