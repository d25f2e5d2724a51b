#include "filasofia/filasofia.h"

#include "filasofia/core/log.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/record/recording.h"
#include "filasofia/record/replay.h"

#include "runtime/fake_device.h"

#include <unistd.h>

#include <filesystem>
#include <mutex>
#include <numbers>
#include <thread>

namespace haptics_test {

using namespace filasofia;
using device::DeviceNotice;
using device::DeviceSample;
using device::DeviceStatus;
using device::Motion;
using device::MotionSample;
using device::ServoState;
using runtime::FakeDevice;

namespace {

struct Folder {
    std::filesystem::path path = std::filesystem::temp_directory_path() / text("filasofia_haptics_test_", getpid());
    Folder() { std::filesystem::create_directory(path); }
    ~Folder() { std::filesystem::remove_all(path); }
    [[nodiscard]] std::string operator/(const char* name) const { return (path / name).string(); }
};

/// Collects the lines of the log that name an interface while it lives.
struct LogLines {
    LogLines()
    {
        setLogSink([this](LogLevel, std::string_view line) {
            const std::lock_guard lock(mutex);
            if (line.find("haptic interface") != std::string_view::npos) lines.emplace_back(line);
        });
    }
    ~LogLines() { setLogSink({}); }
    std::mutex mutex;
    std::vector<std::string> lines;
};

RigidBodyDef tool(Vec3 at = {})
{
    return {.name = "tool",
            .elements = {{at, {}}},
            .mesh = shapes::sphere(5_mm),
            .dynamic = true,
            .mass = TotalMass{0.05},
            .gravity = false,
            .collision = {{}}};
}

/// Down by 2 cm, there for a while, and back, with a rotation.
std::shared_ptr<const Motion> dip()
{
    const Quat turned = axisAngle({0, 1, 0}, 0.3);
    return std::make_shared<const Motion>(
        std::vector<MotionSample>{
            {0.0, {}, 0}, {0.2, {{0, -20_mm, 0}, turned}, 1}, {0.4, {{0, -20_mm, 0}, turned}, 1}, {0.6, {}, 0}},
        "dip");
}

/// A tool above a soft block, with its interface.
struct Scene {
    explicit Scene(Simulation& sim)
    {
        block = sim.add(SoftBodyDef{.name = "block",
                                    .mesh = shapes::block({60_mm, 30_mm, 60_mm}, {4, 2, 4}),
                                    .attachments = {{.box = Box{{-1, -1, -1}, {1, -14.9_mm, 1}}}},
                                    .collision = {{}}});
        body = sim.add(tool({0, 30_mm, 0}));
        hand = sim.add(HapticInterfaceDef{.device = device::ScriptedDevice{.motion = dip()}, .body = body});
    }
    BodyId block, body;
    HapticId hand;
};

} // namespace

TEST_CASE("a scripted hand moves the tool it holds, feels the tissue, and is replayed to the same bits")
{
    const Folder folder;
    std::uint64_t hash = 0;
    for (int again = 0; again < 2; ++again) {
        Simulation sim;
        const Scene scene(sim);
        std::vector<DeviceNotice> notices;
        sim.on<DeviceEvent>([&](const DeviceEvent& event) {
            CHECK(event.interface == scene.hand);
            notices.push_back(event.notice);
        });
        double pressed = 0.0, felt = 0.0, deepest = 1.0;
        sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent&) {
            const HapticState state = sim.haptic(scene.hand);
            felt = std::max(felt, state.onHand.force.y);
            pressed = std::max(pressed, -state.onBody.force.y);
            deepest = std::min(deepest, sim.physics().latest()->rigidBody(scene.body)->poses[0].position.y);
        });
        const RunReport report = sim.run({.headless = true, .steps = 700, .record = folder / "run.rec"});
        CHECK(deepest < 16_mm); // the tissue's top is at 15, the ball's radius 5
        CHECK(deepest > 10_mm); // the hand's height
        CHECK(pressed > 0.2);
        CHECK(felt == Approx(pressed).epsilon(0.1));
        const auto frame = sim.physics().latest();
        CHECK(distance(frame->rigidBody(scene.body)->poses[0].position, {0, 30_mm, 0}) < 0.1_mm); // it came back
        CHECK(sim.haptic(scene.hand).state == ServoState::Running);
        CHECK(sim.haptic(scene.hand).servo.energy <= 0.0);
        REQUIRE(notices.size() == 3);
        CHECK(notices[0].kind == DeviceNotice::Kind::Connected);
        CHECK((notices[1].kind == DeviceNotice::Kind::Button && notices[1].pressed));
        CHECK((notices[2].kind == DeviceNotice::Kind::Button && !notices[2].pressed));
        CHECK((again == 0 || report.hash == hash));
        hash = report.hash;

        const record::Recording recording = record::readRecording(folder / "run.rec");
        const auto engine = engine::makeNativeEngine({.period = recording.header.period});
        CHECK_FALSE(record::replay(recording.steps, *engine));
        CHECK(engine->hash() == hash);
    }
}

TEST_CASE("a hand holds a dynamic body with joints by a handle that its base hangs on, and bears its weight")
{
    Simulation sim;
    const BodyId handle = sim.add(RigidBodyDef{
        .name = "handle", .dynamic = true, .mass = physics::GivenInertia{.mass = 0.03, .moments = {1e-5, 1e-5, 1e-5}}});
    RigidBodyDef gripper{.name = "gripper", .dynamic = true};
    gripper.mass = physics::GivenInertia{.mass = 0.02, .moments = {1e-5, 1e-5, 1e-5}};
    gripper.articulation.joints = {{.axis = {0, 0, 1}, .parent = 0, .child = 1, .command = physics::JointForce{}}};
    gripper.articulation.joints[0].mass = physics::GivenInertia{.mass = 0.01, .moments = {1e-6, 1e-6, 1e-6}};
    gripper.articulation.joints[0].inertia = 1e-4;
    gripper.attachments = {{.to = handle}};
    const BodyId tool = sim.add(gripper);
    const HapticId hand = sim.add(
        HapticInterfaceDef{.device = device::ScriptedDevice{.motion = dip()}, .origin = Pose{}, .body = handle});
    CHECK_THROWS_WITH(
        sim.add(HapticInterfaceDef{.name = "second", .body = tool}),
        Catch::StartsWith("haptic interface 'second': body must not be a dynamic one with joints, got 'gripper'"));
    double apart = 0.0, lowest = 0.0;
    sim.everyStep([&](double) {
        const auto frame = sim.physics().latest();
        if (!frame) return;
        const Vec3 held = frame->rigidBody(handle)->poses[0].position, base = frame->rigidBody(tool)->poses[0].position;
        apart = std::max(apart, distance(held, base));
        lowest = std::min(lowest, base.y);
    });
    sim.run({.headless = true, .steps = 3000}); // the motion ends at 0.6 s
    CHECK(apart < 1e-4);
    CHECK(lowest < -0.015);
    // At rest the hand bears all three masses.
    CHECK(sim.haptic(hand).onBody.force.y == Approx(0.06 * 9.81).epsilon(0.02));
    CHECK(sim.haptic(hand).onHand.force.y == Approx(-0.06 * 9.81).epsilon(0.02));
}

TEST_CASE("without a body the user's own code reads the hand, which feels nothing")
{
    Simulation sim;
    const Vec3 origin{0.1, 0.2, 0.3};
    const HapticId hand = sim.add(HapticInterfaceDef{
        .device = device::ScriptedDevice{.motion = dip()}, .scale = 2.0, .origin = Pose{origin, {}}});
    std::vector<DeviceNotice::Kind> notices;
    sim.on<DeviceEvent>([&](const DeviceEvent& event) { notices.push_back(event.notice.kind); });
    double lowest = 1.0, felt = 0.0;
    bool pressed = false;
    sim.everyStep([&](double) {
        const HapticState state = sim.haptic(hand);
        lowest = std::min(lowest, state.hand.pose.position.y);
        felt = std::max(felt, length(state.onHand.force) + length(state.onBody.force));
        pressed = pressed || state.buttons == 1;
        const Vec3 p = state.hand.pose.position;
        if (state.state == ServoState::Running) CHECK((p.x == Approx(0.1) && p.z == Approx(0.3)));
    });
    const HapticId plain =
        sim.add(HapticInterfaceDef{.name = "plain", .device = device::ScriptedDevice{.motion = dip()}});
    double plainLowest = 1.0;
    sim.everyStep([&](double) { plainLowest = std::min(plainLowest, sim.haptic(plain).hand.pose.position.y); });
    sim.run({.headless = true, .steps = 700});
    CHECK(plainLowest == Approx(-0.02)); // without an origin the device's axes are the scene's
    CHECK(lowest == Approx(0.2 - 2.0 * 0.02));
    CHECK(felt == 0.0);
    CHECK(pressed);
    CHECK(sim.haptic(hand).state == ServoState::Running);
    CHECK(std::ranges::none_of(notices, [](DeviceNotice::Kind kind) {
        return kind == DeviceNotice::Kind::Lost || kind == DeviceNotice::Kind::Error;
    }));
    sim.add(HapticInterfaceDef{.name = "second"}); // any number without a body
    CHECK_THROWS_WITH(sim.add(HapticInterfaceDef{.name = "third", .element = 1}),
                      "haptic interface 'third': element must be 0 without a body, got 1");
}

TEST_CASE("over time the forces on hand and body are opposite and equal")
{
    for (const double rate : {1000.0, 100.0, 20.0}) {
        Simulation sim({.physics = {.rate = rate}});
        const BodyId wall =
            sim.add(RigidBodyDef{.name = "wall", .mesh = shapes::box({0.2, 0.02, 0.2}), .collision = {{}}});
        const BodyId body = sim.add(tool({0, 16_mm, 0}));
        HapticInterfaceDef def{.body = body, .coupling = {.linearDamping = 5.0}, .forceLimit = 20.0};
        // 4 mm into the wall and back, and to the side, at 0.5 Hz.
        const double w = std::numbers::pi;
        const HapticId hand =
            sim.add(def, std::make_unique<FakeDevice>([w](double t) {
                        DeviceSample s;
                        s.hand.pose.position = {5_mm * std::sin(w * t), -2.5_mm * (1 - std::cos(w * t)), 0};
                        s.hand.velocity = {5_mm * w * std::cos(w * t), -2.5_mm * w * std::sin(w * t), 0};
                        return s;
                    }));
        Vec3 onHand, onBody;
        double size = 0.0;
        sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent& update) {
            if (update.time <= 2.0) return; // the ramp is over, and whole periods follow
            const HapticState state = sim.haptic(hand);
            onHand += state.onHand.force;
            onBody += state.onBody.force;
            size += length(state.onBody.force);
        });
        sim.run({.headless = true, .steps = static_cast<int>(6.0 * rate)});
        INFO("physics at " << rate << " Hz: " << onHand.y << " and " << onBody.y);
        CHECK(size > 0.1 * 4.0 * rate); // 0.1 N on average
        CHECK(length(onHand + onBody) < 0.05 * length(onBody));
        static_cast<void>(wall);
    }
}

TEST_CASE("without an origin the tool stays where it was added, however the device lies at first, with one it comes")
{
    const Pose start{{0.1, 0.2, 0.3}, axisAngle({1, 0, 0}, 0.5)};
    const Pose lying{{0.05, -0.01, 0.02}, axisAngle({0, 0, 1}, 1.0)};
    for (const bool given : {false, true}) {
        Simulation sim;
        RigidBodyDef def = tool();
        def.elements = {start};
        const BodyId body = sim.add(def);
        HapticInterfaceDef interface {
            .scale = 2.0, .body = body, .coupling = {.linearDamping = 10, .angularDamping = 0.05 }
        };
        if (given) interface.origin = Pose{{0.1, 0.15, 0.3}, {}};
        sim.add(interface, std::make_unique<FakeDevice>([&](double t) {
                    DeviceSample s{.hand = {lying}};
                    if (t > 0.1) s.hand.pose.position.x += 5_mm;
                    return s;
                }));
        const auto pose = [&] { return sim.physics().latest()->rigidBody(body)->poses[0]; };
        sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent& update) {
            if (given || update.step > 90) return;
            CHECK(distance(pose().position, start.position) < 1e-9);
            CHECK(length(rotationVector(pose().orientation * conjugate(start.orientation))) < 2e-6);
        });
        sim.run({.headless = true, .steps = 3000});
        const Vec3 end = given ? interface.origin->position + 2.0 * (lying.position + Vec3{5_mm, 0, 0})
                               : start.position + 2.0 * Vec3{5_mm, 0, 0};
        CHECK(distance(pose().position, end) < 1e-4);
        const Quat turned = given ? lying.orientation : start.orientation;
        CHECK(length(rotationVector(pose().orientation * conjugate(turned))) < 1e-3);
    }
}

TEST_CASE("a kinematic body is where the hand is, and the hand feels nothing")
{
    Simulation sim;
    RigidBodyDef def{
        .name = "probe", .elements = {{{0, 30_mm, 0}, {}}}, .mesh = shapes::sphere(5_mm), .collision = {{}}};
    const BodyId body = sim.add(def);
    const HapticId hand = sim.add(HapticInterfaceDef{.device = device::ScriptedDevice{.motion = dip()}, .body = body});
    sim.run({.headless = true, .steps = 300});
    CHECK(distance(sim.physics().latest()->rigidBody(body)->poses[0].position, {0, 10_mm, 0}) <
          1e-5); // reached within two steps
    CHECK(sim.haptic(hand).onHand == CouplingForce{});
}

TEST_CASE("a device that is unplugged is an event and one line in the log, and the tool stays where it was")
{
    for (const bool live : {false, true}) {
        LogLines log;
        Simulation sim;
        const BodyId body = sim.add(tool());
        std::atomic<int> reads = 0;
        auto made = std::make_unique<FakeDevice>([&](double) {
            const int read = ++reads;
            DeviceSample s{.hand = {{{1e-5 * std::min(read, 500), 0, 0}, {}}, {read < 500 ? 1e-2 : 0.0, 0, 0}, {}}};
            if (read > 500) s.status = DeviceStatus::Lost;
            return s;
        });
        const HapticId hand = sim.add(HapticInterfaceDef{.body = body}, std::move(made));
        std::vector<DeviceNotice> notices;
        sim.on<DeviceEvent>([&](const DeviceEvent& event) {
            notices.push_back(event.notice);
            if (live && event.notice.kind == DeviceNotice::Kind::Lost) sim.finish("lost");
        });
        const RunReport report = live ? sim.run({.backend = Backend::Null}) : sim.run({.headless = true, .steps = 900});
        CHECK(report.undone == 0);
        const auto slow = [](const std::string& line) { return line.find(" took ") != std::string::npos; };
        std::erase_if(notices, [&](const DeviceNotice& notice) { return slow(notice.problem); }); // a busy machine
        REQUIRE(notices.size() == 2);
        CHECK(notices[0].kind == DeviceNotice::Kind::Connected);
        CHECK(notices[1].kind == DeviceNotice::Kind::Lost);
        CHECK(notices[1].problem == "lost: the cable");
        const std::lock_guard lock(log.mutex);
        std::erase_if(log.lines, slow);
        REQUIRE(log.lines.size() == 1);
        CHECK(log.lines[0] ==
              "haptic interface 'haptic interface': device fake: lost: the cable; it gets no force until "
              "it works again");
        CHECK(sim.haptic(hand).state == ServoState::Lost);
        CHECK(sim.haptic(hand).onHand == CouplingForce{});
        if (live) continue;
        const auto* tool = sim.physics().latest()->rigidBody(body);
        CHECK(tool->poses[0].position.x == Approx(4.99_mm).epsilon(0.01)); // aligned at the first of 500 readings
        CHECK(length(tool->velocities[0]) < 1e-3);
    }
}

TEST_CASE("a device that comes again elsewhere takes the tool where it is, and does not pull it over")
{
    Simulation sim;
    const BodyId body = sim.add(tool());
    int reads = 0;
    sim.add(HapticInterfaceDef{.body = body}, std::make_unique<FakeDevice>([&](double) {
                DeviceSample s;
                if (++reads > 100 && reads < 2000) s.status = DeviceStatus::Lost;
                if (reads >= 2000) s.hand.pose = {{50_mm, 0, 0}, axisAngle({0, 0, 1}, 1.0)};
                return s;
            }));
    sim.run({.headless = true, .steps = 3000});
    const Pose pose = sim.physics().latest()->rigidBody(body)->poses[0];
    CHECK(length(pose.position) < 1e-6);
    CHECK(length(rotationVector(pose.orientation)) < 1e-6);
}

TEST_CASE("while a device blocks, physics and picture go on")
{
    LogLines log;
    Simulation sim;
    const BodyId body = sim.add(tool());
    sim.show(body);
    std::atomic<std::uint64_t> steps = 0, pictures = 0;
    std::atomic<bool> blocked = false, released = false;
    int reads = 0;
    const HapticId hand = sim.add(HapticInterfaceDef{.body = body}, std::make_unique<FakeDevice>([&](double) {
                                      if (++reads == 100) {
                                          const std::uint64_t step = steps, picture = pictures;
                                          blocked = true; // for 100 steps, three pictures and at least 100 ms
                                          std::this_thread::sleep_for(std::chrono::milliseconds(100));
                                          while (steps < step + 100 || pictures < picture + 3)
                                              std::this_thread::yield();
                                          released = true;
                                      }
                                      return DeviceSample{};
                                  }));
    std::vector<DeviceNotice> errors;
    sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent& update) {
        steps = update.step;
        if (released && !errors.empty()) sim.finish("reported");
    });
    sim.on<VisualUpdateEvent>([&](const VisualUpdateEvent&) { ++pictures; });
    sim.on<DeviceEvent>([&](const DeviceEvent& event) {
        if (event.notice.kind == DeviceNotice::Kind::Error) errors.push_back(event.notice);
    });
    sim.run({.backend = Backend::Null});
    CHECK((blocked && released));
    REQUIRE(errors.size() == 1); // once, even if a busy machine made another call slow
    CHECK(errors[0].problem.find(" took ") != std::string::npos);
    CHECK(sim.haptic(hand).servo.longestCall >= 0.1);
    const std::lock_guard lock(log.mutex);
    CHECK(log.lines.size() == 1);
}

TEST_CASE("what a hand does is written to a motion file, and played back")
{
    const Folder folder;
    Vec3 recorded, played;
    {
        Simulation sim;
        const Scene scene(sim);
        sim.run({.headless = true, .steps = 300, .recordMotion = folder / "hand.csv"});
        recorded = sim.physics().latest()->rigidBody(scene.body)->poses[0].position;
        const Motion motion = device::readMotion(folder / "hand.csv");
        CHECK(motion.samples().size() == 300);
        CHECK(motion.samples().back().pose.position == Vec3{0, -20_mm, 0});
        CHECK(motion.samples().back().buttons == 1);
    }
    Simulation sim;
    const Scene scene(sim);
    sim.run({.headless = true, .steps = 300, .motion = folder / "hand.csv"});
    played = sim.physics().latest()->rigidBody(scene.body)->poses[0].position;
    CHECK(distance(played, recorded) < 0.05_mm);
    CHECK(recorded.y < 20_mm);
}

TEST_CASE("a list of motion files moves the hands in the order in which they were added, and the others keep their own")
{
    const Folder folder;
    for (const auto& [file, x] : {std::pair{"right.csv", "0.03"}, {"left.csv", "-0.02"}})
        std::ofstream(folder / file) << "time,x,y,z,qw,qx,qy,qz,buttons\n0,0,0,0,1,0,0,0,0\n0.2," << x
                                     << ",0,0,1,0,0,0,0\n";
    Simulation sim;
    std::vector<BodyId> bodies;
    for (const double z : {0.0, 0.1, 0.2}) {
        bodies.push_back(sim.add(tool({0, 0, z})));
        sim.add(HapticInterfaceDef{.device = device::ScriptedDevice{.motion = dip()}, .body = bodies.back()});
    }
    sim.run({.headless = true, .steps = 400, .motion = text(folder / "right.csv", ",", folder / "left.csv")});
    const auto frame = sim.physics().latest();
    const auto moved = [&](std::size_t i) { return frame->rigidBody(bodies[i])->poses[0].position; };
    CHECK(moved(0).x == Approx(0.03).margin(1e-3));
    CHECK(moved(1).x == Approx(-0.02).margin(1e-3));
    CHECK(moved(2).y == Approx(-0.02).margin(1e-3));
}

TEST_CASE("after a reset hands take their bodies where these start, and do not draw them to where they were")
{
    const Folder folder;
    std::ofstream(folder / "hand.csv") << "time,x,y,z,qw,qx,qy,qz,buttons\n0,0,0,0,1,0,0,0,0\n0.2,0.05,0,0,1,0,0,0,0\n"
                                          "0.5,0.05,0,0,1,0,0,0,0\n0.7,0.05,0.02,0,1,0,0,0,0\n";
    Simulation sim;
    const BodyId body = sim.add(tool()),
                 kinematic = sim.add(RigidBodyDef{.name = "told", .elements = {{{0, 0, 0.1}, {}}}});
    for (const BodyId each : {body, kinematic}) sim.add(HapticInterfaceDef{.body = each});
    double farthest = 0.0;
    sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent& update) {
        if (update.step == 400) sim.reset();
        if (update.step < 402 || update.step > 500) return;
        for (const BodyId each : {body, kinematic})
            farthest = std::max(farthest, std::abs(sim.physics().latest()->rigidBody(each)->poses[0].position.x));
    });
    sim.run({.headless = true, .steps = 900, .motion = text(folder / "hand.csv", ",", folder / "hand.csv")});
    CHECK(farthest < 1e-4);
    for (const BodyId each : {body, kinematic}) { // and follow them from there
        const Vec3 place = sim.physics().latest()->rigidBody(each)->poses[0].position;
        CHECK(place.x == Approx(0.0).margin(1e-3));
        CHECK(place.y == Approx(0.02).margin(1e-3));
    }
}

TEST_CASE("while a run is paused the hand feels nothing, and a removed body takes nothing with it")
{
    Simulation sim;
    const BodyId body = sim.add(tool());
    std::vector<double> felt;
    const HapticId hand =
        sim.add(HapticInterfaceDef{.body = body, .rampIn = 0.0}, std::make_unique<FakeDevice>([](double t) {
                    return DeviceSample{.hand = {{{t > 0.05 ? 1_mm : 0.0, 0, 0}, {}}}};
                }));
    sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent& update) {
        felt.push_back(length(sim.haptic(hand).onHand.force));
        if (update.step == 100) sim.physics().remove(body);
    });
    const RunReport report = sim.run({.headless = true, .steps = 300});
    CHECK(report.undone == 0);
    CHECK(*std::max_element(felt.begin(), felt.end()) > 0.1);
    CHECK(felt.back() == 0.0); // the watchdog: no state of the body arrives
}

TEST_CASE("haptic interfaces that cannot be are refused, and so are runs that ask for what is not there")
{
    Simulation sim;
    const BodyId body = sim.add(tool());
    const BodyId soft = sim.add(SoftBodyDef{.name = "block", .mesh = shapes::block({0.1, 0.1, 0.1}, {1, 1, 1})});
    CHECK_THROWS_WITH(sim.run({.headless = true, .steps = 1, .device = "mouse"}),
                      "run: device needs a haptic interface, but there is none");
    HapticInterfaceDef def{.name = "left", .body = body};
    sim.add(def);
    def.name = "right";
    CHECK_THROWS_WITH(sim.add(def), "haptic interface 'right': body 'tool' is already controlled by 'left'");
    def.element = 1;
    CHECK_THROWS_WITH(sim.add(def), "haptic interface 'right': element must be in [0, 1), got 1");
    def.body = soft;
    CHECK_THROWS_WITH(sim.add(def), "haptic interface 'right': body must be a rigid one, got 'block'");
    def.body = BodyId{9};
    CHECK_THROWS_WITH(sim.add(def), Catch::Contains("body 9: no such body"));
    def = {.body = body, .forceLimit = 0.0};
    CHECK_THROWS_WITH(sim.add(def), "haptic interface 'haptic interface': forceLimit must be > 0 N, got 0");
    CHECK_THROWS_WITH(sim.haptic(HapticId{2}), "haptic interface 2: it does not exist");

    const auto run = [&](const RunDef& wanted) { sim.run(wanted); };
    CHECK_THROWS_WITH(run({.headless = true, .steps = 1, .device = "omega"}),
                      Catch::Contains("device: must be one of mouse, gamepad") && Catch::Contains("got 'omega'"));
    CHECK_THROWS_WITH(run({.headless = true, .steps = 1, .device = "openhaptics:/nowhere.so"}),
                      Catch::Contains("library '/nowhere.so' cannot be opened"));
    CHECK_THROWS_WITH(run({.headless = true, .steps = 1, .device = "mouse", .motion = "a.csv"}),
                      "run: device and motion: only one of the two can be given");
    CHECK_THROWS_WITH(run({.headless = true, .steps = 1, .device = "mouse,mouse"}),
                      "run: device: there is 1 haptic interface, but there are 2 names");
    CHECK_THROWS_WITH(run({.headless = true, .steps = 1, .device = "mouse,"}),
                      Catch::Contains("device: must be one of mouse, gamepad") && Catch::Contains("got ''"));
    CHECK_THROWS_WITH(run({.headless = true, .steps = 1, .motion = "/nowhere.csv"}),
                      "motion file '/nowhere.csv': no such file");
    CHECK_THROWS_WITH(run({.headless = true, .steps = 1, .recordMotion = "a.txt"}),
                      "run: recordMotion must end in .csv, got 'a.txt'");
    CHECK(sim.run({.headless = true, .steps = 1}).steps == 1); // nothing is left of the failed runs
    CHECK_THROWS_WITH(sim.placeHaptic(HapticId{1}, 0.0, {}), Catch::Contains("scale must be in [0.001, 1000]"));
}

} // namespace haptics_test
