#include "filasofia/prefab/scope_hands.h"

#include "filasofia/core/units.h"
#include "filasofia/core/validate.h"
#include "filasofia/prefab/hand_script.h"
#include "filasofia/prefab/scope_handle.h"
#include "filasofia/prefab/scope_tip.h"
#include "filasofia/prefab/turns.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace filasofia::prefab {

/// What the hands move in the scope's channel, and what their fingers do.
struct InChannel {
    BodyId body = {};
    std::function<void(const Pose&)> move;
    std::function<void(bool)> first = [](bool) {};  ///< pressed, or released
    std::function<void(bool)> second = [](bool) {}; ///< the same
};

namespace {

ScopeHandsDef checked(ScopeHandsDef def)
{
    validate(def, "scope hands");
    if (length(def.start.aim) == 0.0) fail("scope hands: start.aim must have a length > 0, got 0 0 0");
    if (def.mostDepth < def.leastDepth)
        fail("scope hands: mostDepth must be >= leastDepth (", def.leastDepth, " m), got ", def.mostDepth, " m");
    if (def.mostReach < def.leastReach)
        fail("scope hands: mostReach must be >= leastReach (", def.leastReach, " m), got ", def.mostReach, " m");
    def.start.aim = normalized(def.start.aim);
    return def;
}

InChannel inChannel(ArticulatedInstrument& jaws)
{
    // The thread that delivers events opens and closes them.
    return {.body = jaws.body(),
            .move = [&jaws](const Pose& pivot) { jaws.move(pivot); },
            .first =
                [&jaws, closed = true](bool pressed) mutable {
                    if (!pressed) return;
                    closed = !closed;
                    if (closed)
                        jaws.close();
                    else
                        jaws.open();
                }};
}
InChannel inChannel(WireLoop& loop)
{
    return {.body = loop.body(),
            .move = [&loop](const Pose& pose) { loop.move(pose); },
            .first = [&loop](bool pressed) { loop.cut(pressed); },
            .second = [&loop](bool pressed) { loop.dry(pressed); }};
}

} // namespace

ScopeHand between(const ScopeHand& a, const ScopeHand& b, double t)
{
    const auto mix = [t](double from, double to) { return from + t * (to - from); };
    const Vec3 from = normalized(a.aim), to = normalized(b.aim);
    return {normalized(from + t * (to - from)), mix(a.depth, b.depth), mix(a.roll, b.roll), mix(a.reach, b.reach)};
}

Pose tipOf(const ScopeHandsDef& def, const ScopeHand& hand)
{
    const Vec3 aim = normalized(hand.aim);
    const Vec3 tip = def.fulcrum + hand.depth * aim;
    return visual::lookAt(tip, tip + aim, def.up) * Pose{{}, axisAngle({0.0, 0.0, 1.0}, hand.roll)};
}

struct ScopeHands::Impl {
    Impl(runtime::Simulation& sim, Endoscope& endoscope, InChannel tool, const ScopeHandsDef& asked)
        : simulation(sim), scope(endoscope), instrument(std::move(tool)), def(checked(asked)), now(def.start),
          wanted(def.start), script(def.start)
    {
        if (def.handle) handle.emplace(simulation, def);
        const Pose unrolled = tipOf(def, {.aim = def.start.aim});
        right = rotate(unrolled.orientation, {1.0, 0.0, 0.0});
        upwards = rotate(unrolled.orientation, {0.0, 1.0, 0.0});
        const Pose tip = scope.tip();
        channel = inverse(tip) * scope.channel();
        apply();
    }

    [[nodiscard]] Pose pivotOf(const ScopeHand& hand) const
    {
        return tipOf(def, hand) * channel * Pose{{0.0, 0.0, -hand.reach}, {}};
    }
    void apply()
    {
        scope.move(tipOf(def, now));
        instrument.move(pivotOf(now));
    }

    /// Moves towards the wanted pose as far as the hands' strength allows: they do not push or pull against a larger
    /// force.
    void go(const ScopeHand& to, double dt)
    {
        if (def.strength == std::numeric_limits<double>::infinity()) {
            now = to;
            return;
        }
        const Vec3 tip = tipOf(def, to).position - tipOf(def, now).position;
        const Vec3 pivot = pivotOf(to).position - pivotOf(now).position;
        if (const frame::FrameRef frame = simulation.physics().latest()) {
            const auto forceOn = [&](BodyId tool) { // forces of contacts and of held tissue
                return frame::forceOn(tool, frame->contacts) + frame::forceOn(tool, frame->attachments);
            };
            const Vec3 onScope = forceOn(scope.body()), onInstrument = forceOn(instrument.body);
            const bool against = dot(onScope, tip) + dot(onInstrument, pivot) < 0.0;
            if (against && length(onScope) + length(onInstrument) > def.strength) return;
        }
        const double way = std::max(length(tip), length(pivot)), maxWay = kMaxHandSpeed * dt;
        now = way > maxWay ? between(now, to, maxWay / way) : to;
    }

    /// Before a step that ends at `time`.
    void step(double time)
    {
        // While another thread changes the hands, they rest; the next step makes up for it.
        turns.now([&] { stepNow(time); });
    }
    void stepNow(double time)
    {
        const double dt = time - std::exchange(last, time);
        if (script.empty() && handle)
            go(poseFromHandle(), dt);
        else if (script.empty())
            go(between(now, wanted, 1.0 - std::exp(-dt / kHandFollow)), dt);
        else
            go(script.follow(time - dt, dt), dt);
        apply();
    }

    /// The pose given by a haptic device at the handle.
    ScopeHand poseFromHandle()
    {
        const frame::FrameRef frame = simulation.physics().latest();
        if (!frame) return now;
        ScopeHand hand = handle->hand(*frame);
        // The reach set by keys is added.
        hand.reach = std::clamp(hand.reach + wanted.reach - def.start.reach, def.leastReach, def.mostReach);
        handle->feel(*frame, scope.body(), instrument.body);
        return hand;
    }

    // A person: events set the wanted pose, and every step moves part of the way.
    void turn(const event::MouseMoveEvent& moved)
    {
        if (!moved.buttons.right || handle) return;
        turns.take(mayWait(), [this, dx = moved.dx, dy = moved.dy] {
            sideways = std::clamp(sideways + 0.002 * dx, -def.mostTurn, def.mostTurn);
            upward = std::clamp(upward - 0.002 * dy, -def.mostTurn, def.mostTurn);
            wanted.aim = normalized(def.start.aim + std::tan(sideways) * right + std::tan(upward) * upwards);
        });
    }
    void shift(double depth, double roll, double reach)
    {
        turns.take(mayWait(), [this, depth, roll, reach] {
            wanted.depth = std::clamp(wanted.depth + depth, def.leastDepth, def.mostDepth);
            wanted.roll += roll;
            wanted.reach = std::clamp(wanted.reach + reach, def.leastReach, def.mostReach);
        });
    }
    void press(const event::KeyEvent& key)
    {
        using event::KeyCode;
        if (key.key == KeyCode::G && !key.repeat) instrument.first(key.pressed);
        if (key.key == KeyCode::B && !key.repeat) instrument.second(key.pressed);
        if (!key.pressed) return;
        if (key.key == KeyCode::Up) shift(1_mm, 0.0, 0.0);
        if (key.key == KeyCode::Down) shift(-1_mm, 0.0, 0.0);
        if (key.key == KeyCode::Left) shift(0.0, 5_deg, 0.0);
        if (key.key == KeyCode::Right) shift(0.0, -5_deg, 0.0);
        if (key.key == KeyCode::W) shift(0.0, 0.0, 0.7_mm);
        if (key.key == KeyCode::S) shift(0.0, 0.0, -0.7_mm);
    }
    void press(const runtime::DeviceEvent& device)
    {
        if (!handle || device.notice.kind != device::DeviceNotice::Kind::Button) return;
        if (device.notice.button == 0) instrument.first(device.notice.pressed);
        if (device.notice.button == 1) handle->clutch(device.notice.pressed);
    }
    /// Acts before every step, and listens to a person and to a device. `self` is this one.
    void follow(const std::shared_ptr<Impl>& self)
    {
        const auto when = [weak = std::weak_ptr(self)](auto act) {
            return [weak, act](const auto& what) {
                if (const auto impl = weak.lock()) act(*impl, what);
            };
        };
        simulation.everyStep(when([](Impl& impl, double time) { impl.step(time); }));
        simulation.remember(
            {.of = "hands",
             .save = [weak = std::weak_ptr(self)] { return weak.expired() ? std::any() : std::any(0); },
             .restore = [](const std::any&) {},
             .check = [](const std::any&) { fail("restore: hands hold the scope, and do not go back"); }});
        simulation.on<event::MouseMoveEvent>(when([](Impl& impl, const event::MouseMoveEvent& e) { impl.turn(e); }));
        simulation.on<event::MouseWheelEvent>(
            when([](Impl& impl, const event::MouseWheelEvent& e) { impl.shift(1.5_mm * e.dy, 0.0, 0.0); }));
        simulation.on<event::KeyEvent>(when([](Impl& impl, const event::KeyEvent& e) { impl.press(e); }));
        simulation.on<runtime::DeviceEvent>(when([](Impl& impl, const runtime::DeviceEvent& e) { impl.press(e); }));
    }
    [[nodiscard]] bool mayWait() const { return !simulation.physics().stepsHere(); }

    runtime::Simulation& simulation;
    Endoscope& scope;
    InChannel instrument;
    const ScopeHandsDef def;
    std::optional<ScopeHandle> handle;
    Pose channel = {}; ///< in the tip's coordinates
    Vec3 right = {};   ///< at the start
    Vec3 upwards = {};
    Turns turns; // guards the members below
    ScopeHand now;
    ScopeHand wanted;
    double sideways = 0.0; ///< [rad]
    double upward = 0.0;   ///< [rad]
    double last = 0.0;     ///< [s], end of the last step
    HandScript<HandMove> script;
};

ScopeHands::ScopeHands(runtime::Simulation& simulation, Endoscope& scope, ArticulatedInstrument& instrument,
                       const ScopeHandsDef& def)
    : impl_(std::make_shared<Impl>(simulation, scope, inChannel(instrument), def))
{
    impl_->follow(impl_);
}
ScopeHands::ScopeHands(runtime::Simulation& simulation, Endoscope& scope, WireLoop& loop, const ScopeHandsDef& def)
    : impl_(std::make_shared<Impl>(simulation, scope, inChannel(loop), def))
{
    impl_->follow(impl_);
}
ScopeHands::~ScopeHands() = default;

BodyId ScopeHands::handle() const { return impl_->handle ? impl_->handle->body() : BodyId{}; }

ScopeHand ScopeHands::at(Vec3 target, double shortOf, double roll, double reach) const
{
    const Vec3 mouth = impl_->channel.position;
    ScopeHand hand{.aim = impl_->def.start.aim, .roll = roll, .reach = reach};
    // The channel lies beside the axis and rotates with the direction that is sought: five iterations are plenty.
    for (int i = 0; i < 5; ++i) {
        const Vec3 beside = rotate(tipOf(impl_->def, hand).orientation, {mouth.x, mouth.y, 0.0});
        const Vec3 way = target - beside - impl_->def.fulcrum;
        hand.aim = normalized(way);
        hand.depth = length(way) - shortOf - reach + mouth.z;
    }
    return hand;
}

double ScopeHands::rollAcross(Vec3 stalk, Vec3 target) const
{
    const Pose unrolled = tip(at(target, 0.0, 0.0, 0.0));
    const Vec3 seen = rotate(conjugate(unrolled.orientation), normalized(stalk));
    if (std::hypot(seen.x, seen.y) < 0.4) return 0.0; // within 24 degrees of the view
    const double roll = std::atan2(seen.y, seen.x);
    return roll > 90_deg ? roll - 180_deg : roll < -90_deg ? roll + 180_deg : roll;
}

Pose ScopeHands::tip(const ScopeHand& hand) const { return tipOf(impl_->def, hand); }

void ScopeHands::play(std::vector<HandMove> moves)
{
    checkMoves(moves, "scope hands");
    impl_->turns.take(impl_->mayWait(),
                      [impl = impl_.get(), moves = std::move(moves)] { impl->script.play(moves, impl->now); });
}

} // namespace filasofia::prefab
