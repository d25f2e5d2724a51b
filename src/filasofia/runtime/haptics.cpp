#include "filasofia/runtime/haptics.h"

#include "filasofia/core/listed.h"
#include "filasofia/core/log.h"
#include "filasofia/core/validate.h"
#include "filasofia/core/word.h"
#include "filasofia/math/rounded.h"
#include "filasofia/physics/physics_server.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace filasofia::runtime {
namespace {

using device::DeviceNotice;
using device::HapticServo;
using device::Nanoseconds;

constexpr std::size_t kTape = 1 << 16; // a minute at 1 kHz, if the main thread does not drain it

/// "NAME" or "NAME:LIBRARY". `forceDimension` counts the Force Dimension devices so far.
std::unique_ptr<device::HapticDevice> deviceOf(const std::string& word, int& forceDimension)
{
    const auto colon = word.find(':');
    device::DeviceDef def = device::deviceNamed(word.substr(0, colon));
    if (std::holds_alternative<device::ScriptedDevice>(def))
        fail("run: device scripted needs a motion file; set motion instead");
    if (auto* omega = std::get_if<device::ForceDimensionDevice>(&def)) omega->index = forceDimension++;
    return device::makeDevice(def, colon == std::string::npos ? "" : word.substr(colon + 1));
}

/// The devices that a run asks for, in place of those of the first interfaces.
std::vector<std::unique_ptr<device::HapticDevice>> devicesOf(const RunDef& run)
{
    std::vector<std::unique_ptr<device::HapticDevice>> devices;
    int forceDimension = 0;
    for (const std::string& word : listed(run.device)) devices.push_back(deviceOf(word, forceDimension));
    for (const std::string& file : listed(run.motion))
        devices.push_back(device::makeDevice(device::ScriptedDevice{.motion = file}));
    return devices;
}

int ticksIn(double dt, double rate) { return std::max(1, static_cast<int>(std::lround(dt * rate))); }
Nanoseconds nanoseconds(double seconds) { return std::llround(1e9 * seconds); }

/// A product of unit quaternions may be longer than one by rounding, and a step accepts no component beyond 1.
Pose unitPose(Pose pose)
{
    Quat& q = pose.orientation = normalized(pose.orientation);
    for (double* each : {&q.w, &q.x, &q.y, &q.z}) *each = std::clamp(*each, -1.0, 1.0);
    return pose;
}

void logNotice(const std::string& who, const DeviceNotice& notice, bool wasWrong)
{
    if (notice.kind == DeviceNotice::Kind::Lost || notice.kind == DeviceNotice::Kind::Error)
        logWarning(who, ": ", notice.problem, "; it gets no force until it works again");
    else if (notice.kind == DeviceNotice::Kind::Connected && wasWrong)
        logInfo(who, ": it works again");
}

/// The body that the Def names; nullopt if it names none. Throws an Error if no hand can hold it.
std::optional<physics::RigidBodyDef> controlledBody(const HapticInterfaceDef& def,
                                                    const physics::PhysicsServer& physics, const std::string& object)
{
    if (!def.body) {
        if (def.element != 0) fail(object, ": element must be 0 without a body, got ", def.element);
        return {};
    }
    const auto body = physics.def(def.body);
    const auto* rigid = std::get_if<physics::RigidBodyDef>(body.get());
    if (!rigid)
        fail(object, ": body must be a rigid one, got '", std::visit([](const auto& each) { return each.name; }, *body),
             "'");
    const bool jointed = !rigid->articulation.joints.empty(); // joints move all links but the base
    const int elements = jointed ? 1 : static_cast<int>(rigid->elements.size());
    if (def.element >= elements) fail(object, ": element must be in [0, ", elements, "), got ", def.element);
    if (rigid->dynamic && jointed)
        fail(object, ": body must not be a dynamic one with joints, got '", rigid->name,
             "'; let the hand hold another body, and attach the base to that");
    return *rigid;
}

} // namespace

struct Haptics::Interface {
    HapticId id;
    HapticInterfaceDef def;
    bool dynamic = false;
    Vec3 centre;                                  ///< [m], centre of mass in the element's coordinates
    std::unique_ptr<device::HapticDevice> device; ///< the Def's, or the caller's
    std::unique_ptr<device::HapticDevice> other;  ///< the run's, in place of the other
    std::unique_ptr<HapticServo> servo;           ///< kept after a run, so that its statistics can be read

    // Used by the stepping thread in a run.
    bool placed = false;
    bool refused = false;     ///< a sample was refused and a warning logged
    bool holding = false;     ///< the last step had a target from the hand
    std::uint64_t states = 0; ///< number of body states sent to the servo
    Nanoseconds seen = 0;     ///< when the hand was at the last step's target; the body state carries this time
    physics::HapticTarget target = {}; ///< the last step's
    device::Latest<CouplingForce> onBody;
    // Where the device is in the scene; guarded by the mutex.
    double scale = 1.0;
    Pose origin;
    Quat grip;
    // The same for the stepping thread.
    device::Latest<VirtualCoupling> coupling;
    std::atomic<int> waits = 0;             ///< steps until a reset that was asked for is done for sure
    std::atomic<bool> aligns = false;       ///< it has no origin of its own, so it starts at the body
    std::atomic<std::uint64_t> placing = 0; ///< snapshots with an earlier number belong to another place

    void updatePlace() // under the mutex
    {
        coupling.write(device::sceneCoupling(servoDef(def.rate, 1e-3)));
        if (servo) placing.store(servo->place(scale, origin, grip));
    }
    [[nodiscard]] std::string who() const
    {
        return text("haptic interface '", def.name, "': device ", (other ? other : device)->name());
    }
    /// The device, if a person's input moves it; else null.
    [[nodiscard]] device::PersonDevice* person() const
    {
        return dynamic_cast<device::PersonDevice*>((other ? other : device).get());
    }
    [[nodiscard]] device::ServoDef servoDef(double rate, double stepPeriod) const
    {
        return {.rate = rate,
                .scale = scale,
                .origin = origin,
                .grip = grip,
                .coupling = def.coupling,
                .forceScale = dynamic ? def.forceScale : 0.0,
                .forceLimit = def.forceLimit,
                .torqueLimit = def.torqueLimit,
                .rampIn = def.rampIn,
                .energyLimit = def.energyLimit,
                .stepPeriod = stepPeriod};
    }
};

Haptics::Haptics() = default;
Haptics::~Haptics() = default;

HapticId Haptics::add(const HapticInterfaceDef& def, std::unique_ptr<device::HapticDevice> own,
                      const physics::PhysicsServer& physics)
{
    const std::string object = text("haptic interface '", def.name, "'");
    validate(def, object);
    if (def.origin) static_cast<void>(physics::unitPose(*def.origin, object + ": origin"));
    const std::optional<physics::RigidBodyDef> rigid = controlledBody(def, physics, object);

    const std::lock_guard lock(mutex_);
    if (running_) fail(object, ": must be added before a run, but one is going on");
    for (const auto& other : interfaces_)
        if (rigid && other->def.body == def.body)
            fail(object, ": body '", rigid->name, "' is already controlled by '", other->def.name, "'");
    auto made = std::make_unique<Interface>();
    made->device = own ? std::move(own) : device::makeDevice(def.device);
    made->id = {static_cast<std::uint32_t>(interfaces_.size()) + 1};
    made->def = def;
    made->dynamic = rigid && rigid->dynamic;
    if (made->dynamic) made->centre = physics::inertiaOf(*rigid).centre;
    made->scale = def.scale;
    made->origin = def.origin.value_or(Pose{});
    made->origin.orientation = normalized(made->origin.orientation);
    static_cast<void>(device::ServoLoop(made->servoDef(def.rate, 1e-3)));
    interfaces_.push_back(std::move(made));
    return interfaces_.back()->id;
}

Haptics::Interface& Haptics::find(HapticId id) const
{
    if (id.value == 0 || id.value > interfaces_.size()) fail("haptic interface ", id.value, ": it does not exist");
    return *interfaces_[id.value - 1];
}

std::vector<HapticId> Haptics::ids() const
{
    const std::lock_guard lock(mutex_);
    std::vector<HapticId> all;
    for (const auto& each : interfaces_) all.push_back(each->id);
    return all;
}

HapticInterfaceDef Haptics::def(HapticId id) const
{
    const std::lock_guard lock(mutex_);
    const Interface& each = find(id);
    HapticInterfaceDef now = each.def;
    now.scale = each.scale;
    now.origin = each.origin;
    return now;
}

MotionState Haptics::deviceHand(HapticId id) const
{
    const std::lock_guard lock(mutex_);
    device::ServoSnapshot seen;
    const Interface& each = find(id);
    return each.servo && each.servo->latest(seen) ? seen.sample.hand : MotionState{};
}

HapticState Haptics::state(HapticId id) const
{
    const std::lock_guard lock(mutex_);
    const Interface& each = find(id);
    HapticState out;
    static_cast<void>(each.onBody.read(out.onBody));
    if (!each.servo) return out;
    out.servo = each.servo->statistics();
    device::ServoSnapshot seen;
    if (!each.servo->latest(seen)) return out;
    const Quat turn = each.origin.orientation;
    out.state = seen.tick.state;
    out.hand = seen.tick.hand;
    out.buttons = seen.sample.buttons;
    out.onHand = {rotate(turn, seen.tick.onHand.force), rotate(turn, seen.tick.onHand.torque)};
    return out;
}

void Haptics::place(HapticId id, double scale, const Pose& origin)
{
    const std::lock_guard lock(mutex_);
    Interface& each = find(id);
    HapticInterfaceDef def = each.def;
    def.scale = scale;
    def.origin = physics::unitPose(origin, text("haptic interface '", def.name, "': origin"));
    validate(def, text("haptic interface '", def.name, "'"));
    each.scale = scale;
    each.origin = *def.origin;
    each.aligns.store(false); // an explicit origin replaces alignment
    each.updatePlace();
}

void Haptics::begin(const RunDef& run, const PhysicsDef& physics, const Clock& clock, const Post& post)
{
    const std::lock_guard lock(mutex_);
    for (const auto& [field, value] :
         {std::pair{"device", &run.device}, {"motion", &run.motion}, {"recordMotion", &run.recordMotion}})
        if (!value->empty() && interfaces_.empty())
            fail("run: ", field, " needs a haptic interface, but there is none");
    if (!run.device.empty() && !run.motion.empty()) fail("run: device and motion: only one of the two can be given");
    const double stepPeriod = 1.0 / physics.rate;
    live_ = !run.headless;
    clock_ = clock;
    device::ServoClock servoClock{clock.now, clock.sleepUntil};
    if (!live_) {
        simulated_.store(0);
        servoClock.now = [this] { return simulated_.load(std::memory_order_relaxed); };
    }
    std::vector<std::unique_ptr<device::HapticDevice>> asked = devicesOf(run);
    if (asked.size() > interfaces_.size())
        fail("run: ", run.device.empty() ? "motion" : "device", ": there ",
             interfaces_.size() == 1 ? "is 1 haptic interface" : text("are ", interfaces_.size(), " haptic interfaces"),
             ", but there are ", asked.size(), " names");
    if (!run.recordMotion.empty()) {
        motion_.emplace(run.recordMotion);
        tape_ = std::make_unique<SpscRing<device::MotionSample>>(kTape);
    }
    asked.resize(interfaces_.size()); // the others keep their own
    for (std::size_t i = 0; i < interfaces_.size(); ++i) {
        Interface& each = *interfaces_[i];
        each.servo.reset();
        each.other = std::move(asked[i]);
        each.placed = each.def.origin || !each.def.body;
        each.aligns.store(!each.placed);
        each.holding = false;
        // In a headless run each step has a whole number of ticks, so that the last tick is at its end.
        const double rate = live_ ? each.def.rate : std::min(ticksIn(stepPeriod, each.def.rate) / stepPeriod, 10000.0);
        const auto notice = [&each, post, wrong = false](const DeviceNotice& what) mutable {
            logNotice(each.who(), what, wrong);
            if (what.kind != DeviceNotice::Kind::Button) wrong = what.kind != DeviceNotice::Kind::Connected;
            auto event = std::make_unique<DeviceEvent>();
            event->interface = each.id;
            event->notice = what;
            post(std::move(event));
        };
        each.servo = std::make_unique<HapticServo>(each.other ? *each.other : *each.device,
                                                   each.servoDef(rate, stepPeriod), servoClock, notice);
        each.placing.store(0);
        each.coupling.write(device::sceneCoupling(each.servoDef(rate, stepPeriod)));
        if (tape_ && each.id.value == 1) each.servo->record(tape_.get());
    }
    running_ = true;
    for (auto& each : interfaces_)
        if (live_)
            each->servo->start(physics.realTime);
        else
            each->servo->open();
}

void Haptics::tickThrough(Interface& each, double dt, double end)
{
    const int count = ticksIn(dt, each.def.rate);
    for (int k = 1; k <= count; ++k) {
        const double time = k == count ? end : end - dt + k * dt / count;
        simulated_.store(nanoseconds(time), std::memory_order_relaxed);
        each.servo->tick(time);
    }
}

// The body stays where it is and the hand takes it there, whatever the device's first place and orientation.
void Haptics::align(Interface& each, const device::ServoSnapshot& seen, physics::PhysicsServer& physics)
{
    const frame::FrameRef frame = physics.latest();
    if (!frame) return;
    const frame::RigidBodyFrame* body = frame->rigidBody(each.def.body);
    if (!body) return;
    const Pose& pose = body->poses[static_cast<std::size_t>(each.def.element)];
    const Pose& hand = seen.sample.hand.pose;
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) return; // another thread uses the list: the next step aligns it
    each.origin = {pose.position - each.scale * hand.position, {}};
    each.grip = conjugate(hand.orientation) * pose.orientation;
    each.updatePlace();
    each.placed = true;
}

void Haptics::realign(physics::PhysicsServer& physics)
{
    const std::lock_guard lock(mutex_);
    for (auto& each : interfaces_) {
        if (!running_ || !each->aligns.load() || !physics.has(each->def.body)) continue;
        each->waits.store(2); // the present step may be beyond its commands
        const auto body = physics.def(each->def.body);
        if (std::get<physics::RigidBodyDef>(*body).dynamic) // a reset alone leaves it coupled
            physics.setHaptic(each->def.body, {.coupling = VirtualCoupling{0.0, 0.0, 0.0, 0.0}}, each->def.element);
    }
}

void Haptics::beforeStep(double dt, double end, physics::PhysicsServer& physics)
{
    if (interfaces_.empty()) return;
    wake_ = live_ ? clock_.now() : nanoseconds(end);
    for (auto& held : interfaces_) {
        Interface& each = *held;
        if (!live_) tickThrough(each, dt, end);
        if (!physics.has(each.def.body)) continue;
        if (int waits = each.waits.load(); waits > 0) { // the body must not follow the hand from its start to there
            each.waits.compare_exchange_strong(waits, waits - 1);
            each.placed = each.holding = false;
            continue;
        }
        device::ServoSnapshot seen;
        const bool heard = each.servo->latest(seen) && isGood(seen.tick.state) && seen.placing >= each.placing.load() &&
                           wake_ - seen.time <= static_cast<Nanoseconds>(1e9 * device::watchdogOf(1e-3));
        if (heard && !each.placed) {
            align(each, seen, physics);
            continue; // the servo knows it from its next tick on
        }
        // A device that comes back may be elsewhere: the body must not jump there.
        if (seen.tick.state == device::ServoState::Lost && each.aligns.load()) each.placed = false;
        if (!heard && !std::exchange(each.holding, false)) continue;
        each.seen = heard ? seen.time : wake_;
        if (heard) {
            constexpr double kSpeeds = 1e5; // rounds to 1e-5 m/s and 1e-5 rad/s
            each.target = {rounded(unitPose(seen.tick.hand.pose)), rounded(seen.tick.hand.velocity, kSpeeds),
                           rounded(seen.tick.hand.angularVelocity, kSpeeds)};
            each.holding = true;
        } else { // the target stays at the hand's last place
            each.target.velocity = each.target.angularVelocity = {};
        }
        static_cast<void>(each.coupling.read(each.target.coupling));
        try {
            physics.setHaptic(each.def.body, each.target, each.def.element);
        } catch (const Error& problem) { // the body was removed meanwhile, or the hand is outside the legal range
            each.holding = false;
            if (physics.has(each.def.body) && !std::exchange(each.refused, true))
                logWarning(each.who(), ": its pose was refused: ", problem.what());
        }
    }
}

void Haptics::afterStep(const physics::StepReport& report, physics::PhysicsServer& physics)
{
    if (interfaces_.empty() || report.dt == 0.0) return; // paused: the servos get no state and release the force
    const frame::FrameRef frame = physics.latest();
    if (!frame || frame->step != report.step) return;
    for (auto& held : interfaces_) {
        Interface& each = *held;
        if (!each.def.body) { // the servo waits for a body: it gets the hand, from which no force follows
            device::ServoSnapshot seen;
            if (each.servo->latest(seen)) each.servo->setBody({++each.states, wake_, seen.tick.hand, {}});
            continue;
        }
        const frame::RigidBodyFrame* body = frame->rigidBody(each.def.body);
        if (!body || !each.placed) continue;
        const auto e = static_cast<std::size_t>(each.def.element);
        const Vec3 arm = rotate(body->poses[e].orientation, each.centre);
        const Vec3 turning = body->angularVelocities[e];
        const MotionState now{body->poses[e], body->velocities[e] - cross(turning, arm), turning};
        each.servo->setBody({++each.states, each.seen, now, each.centre});
        const physics::HapticTarget& t = each.target;
        if (each.dynamic && each.states > 1)
            each.onBody.write(couplingForce(t.coupling, atPoint({t.pose, t.velocity, t.angularVelocity}, each.centre),
                                            atPoint(now, each.centre)));
    }
}

void Haptics::drain()
{
    if (!motion_) return;
    for (; const device::MotionSample* sample = tape_->beginRead(); tape_->release()) motion_->write(*sample);
}

void Haptics::end()
{
    {
        const std::lock_guard lock(mutex_);
        running_ = false;
        for (auto& each : interfaces_)
            if (each->servo) {
                each->servo->stop();
                each->servo->close();
            }
    }
    drain();
    if (!motion_) return;
    device::MotionWriter writer = std::move(*motion_);
    motion_.reset();
    writer.close();
}

void Haptics::abandon() noexcept
{
    try {
        end();
    } catch (const std::exception&) { // the earlier error is the one to report
        motion_.reset();
    }
}

bool Haptics::handleController(const event::ControllerEvent& event)
{
    const char* kind = event.kind == event::ControllerEvent::Kind::Gamepad ? "gamepad" : "spacemouse";
    const auto vector = [](const std::array<double, 3>& v) { return Vec3{v[0], v[1], v[2]}; };
    bool any = false;
    for (const auto& each : interfaces_) {
        auto* person = each->person();
        if (!person || person->name() != kind) continue;
        person->feed({.push = vector(event.push), .twist = vector(event.twist), .buttons = event.buttons});
        any = true;
    }
    return any;
}

bool Haptics::handle(const event::Event& event)
{
    if (const auto* controller = dynamic_cast<const event::ControllerEvent*>(&event))
        return handleController(*controller);
    const auto isMouse = [](const auto& each) { return each->person() && each->person()->name() == "mouse"; };
    if (std::ranges::none_of(interfaces_, isMouse)) return false;
    const std::optional<device::PersonInput> input = person_.read(event);
    if (!input) return false;
    for (const auto& each : interfaces_)
        if (isMouse(each)) each->person()->feed(*input);
    return dynamic_cast<const event::WindowEvent*>(&event) == nullptr; // a window event is for everybody
}

} // namespace filasofia::runtime
