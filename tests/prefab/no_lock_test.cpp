#include "filasofia/filasofia.h"

#include "filasofia/physics/registry_hold.h"
#include "filasofia/prefab/articulated_instrument.h"
#include "filasofia/prefab/endoscope.h"
#include "filasofia/prefab/metric_tracker.h"
#include "filasofia/prefab/overlays.h"
#include "filasofia/prefab/perforation.h"
#include "filasofia/prefab/scope_hands.h"
#include "filasofia/prefab/task.h"

#include "runtime/fake_device.h"

#include <catch2/catch.hpp>

#include <atomic>
#include <chrono>
#include <thread>

namespace no_lock_test {

using namespace filasofia;
using namespace filasofia::prefab;

namespace {

constexpr int kSteps = 150; ///< steps computed while all locks are held

/// Blocks its caller until goOn is set.
struct HoldUp {
    std::atomic<bool> reached = false, goOn = false;
    void operator()()
    {
        reached = true;
        while (!goOn) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
};

bool within10s(const std::function<bool()>& happens)
{
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (!happens()) {
        if (std::chrono::steady_clock::now() > end) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return true;
}

} // namespace

TEST_CASE("steps go on with prefabs, a script and a haptic interface while other threads hold all their shared state")
{
    // Forceps that hold a block, so that opening them calls onGrasp, which blocks.
    HoldUp opening, playing;
    Simulation sim({.physics = {.gravity = {}}});
    const BodyId block = sim.add(SoftBodyDef{.name = "block",
                                             .mesh = shapes::block({2_mm, 2_mm, 4_mm}, {2, 2, 4}),
                                             .pose = {{0, 0, -4.5_mm}, {}},
                                             .material = FemMaterial{.youngModulus = 30_kPa},
                                             .collision = {{.proximity = 0.1_mm}},
                                             .friction = 0.8});
    ArticulatedInstrument forceps(sim, {.name = "forceps", .opening = 1.0, .onGrasp = [&](BodyId, bool on) {
                                            if (!on) opening();
                                        }});
    forceps.close();
    sim.run({.headless = true, .backend = Backend::Null, .steps = 800});
    REQUIRE(forceps.holding() == block);

    // A scope with its hands. The end of their last script blocks the thread that removes it.
    Endoscope scope(sim, {.pose = {{0.2, 0, 0}, {}}, .groups = {}});
    ArticulatedInstrument grasper(sim, {.name = "grasper", .pose = {{0.2, 0, 0}, {}}, .groups = {}});
    ScopeHands hands(sim, scope, grasper, {.fulcrum = {0.2, 20_mm, 0}, .up = {0, 0, 1}, .start = {.aim = {0, 1, 0}}});
    std::shared_ptr<int> ended(new int, [&](int* end) {
        delete end;
        playing();
    });
    const auto script = [&hands](const std::function<void()>& end) {
        hands.play({{.seconds = 1000.0, .to = {.aim = {0, 1, 0}, .depth = 1_mm}, .end = end}});
    };

    const BodyId tool =
        sim.add(RigidBodyDef{.name = "tool", .dynamic = true, .mass = GivenInertia{}, .gravity = false});
    sim.add(HapticInterfaceDef{.body = tool}, std::make_unique<runtime::FakeDevice>([](double t) {
                return device::DeviceSample{.hand = {{{0.01 * std::sin(t), 0, 0}, {}}}};
            }));
    const BodyId probe = sim.add(RigidBodyDef{.name = "probe", .elements = {{{0, 0.5, 0}, {}}}});
    MetricTracker tracker(sim, {.bodies = {{.body = probe}}, .write = [](std::string_view) {}});
    const Task task(sim, {.name = "task",
                          .steps = {{.name = "never", .done = [](const frame::Frame&) { return false; }}},
                          .tracker = &tracker});
    const ForceBar bar(sim, {.bodies = {probe}});
    const PerforationWatch watch(sim, {.wall = block, .tools = {{.body = probe}}});
    std::atomic<int> steps = 0;
    sim.everyStep([&](double time) {
        sim.physics().setPose(probe, {{0.01 * std::sin(time), 0.5, 0}, {}});
        scope.roll(0.01 * time);
        static_cast<void>(scope.tip());
        static_cast<void>(forceps.holding());
        static_cast<void>(task.progress());
        ++steps;
    });

    bool wentOn = false, allHeld = false;
    std::thread holder([&] {
        const auto atLeast = [&](int count) { return [&steps, count] { return steps >= count; }; };
        static_cast<void>(within10s(atLeast(20)));
        std::thread opener([&] { forceps.open(); });
        std::thread player([&] {
            script([last = std::move(ended)] {});
            script({}); // destroys the first script
        });
        allHeld = within10s([&] { return opening.reached && playing.reached; });
        {
            const physics::RegistryHold hold(sim.physics());
            wentOn = within10s(atLeast(steps + kSteps));
        }
        opening.goOn = playing.goOn = true;
        opener.join();
        player.join();
        static_cast<void>(within10s(atLeast(steps + 20)));
        sim.finish("held long enough");
    });
    sim.run({.backend = Backend::Null});
    holder.join();
    CHECK(allHeld);
    CHECK(wentOn);
    CHECK_FALSE(forceps.holding());
    CHECK(tracker.lost() == 0);
}

} // namespace no_lock_test
