#include "filasofia/prefab/knot_hands.h"

#include "filasofia/core/published.h"
#include "filasofia/core/text.h"
#include "filasofia/core/validate.h"
#include "filasofia/physics/defs.h"
#include "filasofia/prefab/remember.h"
#include "filasofia/prefab/turns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>

namespace filasofia::prefab {
namespace {

constexpr double kCone = 25.0 * std::numbers::pi / 180.0; ///< [rad] between `up` and strands that are wound
constexpr double kLow = 0.1;    ///< [-] hands that tighten are above the place by this share of their distance
constexpr double kStill = 0.1;  ///< [s] a throw is tight once hands at full force have not moved for so long,
constexpr double kCreep = 2e-3; ///< [m/s] that is, have been slower than this
constexpr double kRamp = 0.2;   ///< [s] in which a force grows to its full value
constexpr double kNear = 1e-3;  ///< [m] least distance of a hand from the place

KnotDef checked(runtime::Simulation& simulation, KnotDef def)
{
    const std::string object = text("knot '", def.name, "'");
    validate(def, object);
    const auto body = simulation.physics().def(def.thread);
    const auto* rod = std::get_if<physics::RodBodyDef>(body.get());
    if (rod == nullptr) fail(object, ": thread must be a rod, got ", physics::describeBody(*body));
    const int count = static_cast<int>(physics::centreLine(*rod).size());
    if (def.nodes.empty()) def.nodes = {0, count - 1};
    if (def.nodes.size() != 2) fail(object, ": nodes must be two or none, got ", def.nodes.size());
    for (const int node : def.nodes)
        if (node >= count) fail(object, ": nodes must be in [0, ", count - 1, "], got ", node);
    if (def.nodes[0] == def.nodes[1]) fail(object, ": nodes must differ, got twice ", def.nodes[0]);
    if (def.turns.empty()) fail(object, ": turns must have at least one entry, got none");
    const Vec3 up = normalized(def.up), across = normalized(def.across);
    if (length(cross(up, across)) < 1e-3)
        fail(object, ": up and across must not be parallel, nor 0, got (", def.up.x, " ", def.up.y, " ", def.up.z,
             ") and (", def.across.x, " ", def.across.y, " ", def.across.z, ")");
    def.up = up;
    def.across = normalized(across - dot(across, up) * up);
    return def;
}

/// A unit vector turned towards another one, by at most an angle [rad].
Vec3 turnedTowards(Vec3 from, Vec3 to, double most)
{
    const Vec3 axis = cross(from, to);
    const double angle = std::atan2(length(axis), dot(from, to));
    return angle <= most ? to : rotate(axisAngle(axis, most), from);
}

enum class Phase {
    Idle,    ///< holds nothing
    Reach,   ///< jumps to the thread
    Take,    ///< holds it from the next step on
    Lift,    ///< brings both strands up, each on its side
    Wind,    ///< goes around the other hand
    Spread,  ///< comes down on the other side
    Tighten, ///< draws
    Done     ///< all throws are tied; draws
};

struct Hand {
    BodyId body = {};
    AttachmentId grip = {};
    Vec3 direction = {}; ///< [-] from the place
    double away = 0.0;   ///< [m] from the place
    double side = 1.0;   ///< 1 or -1, along `across`
};

} // namespace

struct KnotHands::Impl {
    struct Told {
        int tied = 0;
        bool done = false;
        double largest = 0.0;
    };

    Impl(runtime::Simulation& sim, const KnotDef& given) : simulation(sim), def(checked(sim, given))
    {
        for (std::size_t i = 0; i < 2; ++i)
            hands[i].body = sim.add(physics::RigidBodyDef{
                .name = text(def.name, i == 0 ? ": first hand" : ": second hand"), .elements = {Pose{def.place}}});
    }

    // Any thread.
    void begin()
    {
        turns.take(!simulation.physics().stepsHere(), [this] {
            if (phase == Phase::Idle) next(Phase::Reach);
        });
    }
    void release()
    {
        turns.take(!simulation.physics().stepsHere(), [this] {
            for (Hand& hand : hands) {
                if (hand.grip) simulation.physics().release(hand.grip);
                hand.grip = {};
            }
            next(Phase::Idle);
        });
    }

    // Stepping thread, before each step.
    void step(double time)
    {
        const frame::FrameRef frame = simulation.physics().latest();
        if (!frame) return;
        turns.now([&] {
            const frame::SoftBodyFrame* thread = frame->softBody(def.thread);
            if (thread == nullptr) return;
            if (phase == Phase::Reach)
                reach(*thread);
            else if (phase == Phase::Take)
                take();
            else if (phase != Phase::Idle)
                move(*frame, std::max(time - frame->time, 0.0));
            publish();
        });
    }

    void reach(const frame::SoftBodyFrame& thread)
    {
        throws = 0;
        largest = 0.0;
        for (std::size_t i = 0; i < 2; ++i) {
            const Vec3 at = thread.positions[static_cast<std::size_t>(def.nodes[i])];
            simulation.physics().setPose(hands[i].body, Pose{at});
            hands[i].away = std::max(distance(at, def.place), kNear);
            hands[i].direction = normalized(at - def.place, def.up);
        }
        hands[0].side = dot(hands[0].direction - hands[1].direction, def.across) > 0.0 ? 1.0 : -1.0;
        hands[1].side = -hands[0].side;
        next(Phase::Take);
    }
    void take()
    {
        for (std::size_t i = 0; i < 2; ++i)
            hands[i].grip = simulation.physics().attach(
                def.thread, {.nodes = {def.nodes[i]}, .stiffness = def.stiffness, .to = hands[i].body});
        next(Phase::Lift);
    }
    void next(Phase to)
    {
        phase = to;
        since = still = 0.0;
    }

    /// Where a strand goes: `low` down on a hand's side, else up at an angle, `turn` [rad] around `up` from there.
    [[nodiscard]] Vec3 wanted(const Hand& hand, bool low, double turn) const
    {
        if (low) return normalized(hand.side * def.across + kLow * def.up);
        const Vec3 out = rotate(axisAngle(def.up, turn), hand.side * def.across);
        return std::cos(kCone) * def.up + std::sin(kCone) * out;
    }
    /// [rad] A throw of n turns, as seen from above: n whole ones and the half one to the other side.
    [[nodiscard]] double angleOf(int which) const
    {
        const double whole = def.turns[static_cast<std::size_t>(which)] + 0.5;
        return (which % 2 == 0 ? 2.0 : -2.0) * std::numbers::pi * whole;
    }

    void move(const frame::Frame& frame, double dt)
    {
        since += dt;
        const bool low = phase == Phase::Spread || phase == Phase::Tighten || phase == Phase::Done;
        if (phase == Phase::Wind) wind(dt);
        const bool full = phase == Phase::Tighten || phase == Phase::Done;
        const double grown = phase == Phase::Tighten ? std::min(since / kRamp, 1.0) : 1.0;
        const double force = full ? def.holding + grown * (def.force - def.holding) : def.holding;
        bool there = true, moving = false;
        for (Hand& hand : hands) {
            const Vec3 to = wanted(hand, low, angle);
            hand.direction = turnedTowards(hand.direction, to, def.speed * dt / hand.away);
            there = there && distance(hand.direction, to) < 1e-6;
            moving = draw(hand, frame, force, dt) > kCreep * dt || moving;
        }
        still = moving ? 0.0 : still + dt;
        if (there || full) advance();
    }
    void wind(double dt)
    {
        const double reach = std::sin(kCone) * std::max(hands[0].away, hands[1].away);
        const double most = 0.9 * def.speed * dt / reach, left = angleOf(throws) - angle;
        angle += std::clamp(left, -most, most);
    }
    /// Moves a hand along its strand so that it draws with this force; returns by how much [m].
    double draw(Hand& hand, const frame::Frame& frame, double force, double dt)
    {
        const auto grip = std::ranges::find(frame.attachments, hand.grip, &frame::Attachment::id);
        const double tension = grip != frame.attachments.end() ? dot(grip->force, hand.direction) : 0.0;
        largest = std::max(largest, tension);
        const double most = def.speed * dt, by = std::clamp((force - tension) / def.stiffness, -most, most);
        hand.away = std::max(hand.away + by, kNear);
        simulation.physics().setPose(hand.body, Pose{def.place + hand.away * hand.direction});
        return std::abs(by);
    }
    /// To the next phase, if this one has come to its end.
    void advance()
    {
        if (phase == Phase::Lift) {
            angle = 0.0;
            next(Phase::Wind);
        } else if (phase == Phase::Wind && angle == angleOf(throws)) {
            for (Hand& hand : hands) hand.side = -hand.side;
            next(Phase::Spread);
        } else if (phase == Phase::Spread) {
            next(Phase::Tighten);
        } else if (phase == Phase::Tighten && since > kRamp && (still > kStill || since > def.patience)) {
            angle = 0.0;
            next(++throws < std::ssize(def.turns) ? Phase::Lift : Phase::Done);
        }
    }

    void publish() { told.write({.tied = throws, .done = phase == Phase::Done, .largest = largest}); }
    using Kept = std::tuple<std::array<Hand, 2>, Phase, int, double, double, double, double>;
    auto kept() { return std::tie(hands, phase, throws, angle, since, still, largest); }

    runtime::Simulation& simulation;
    const KnotDef def;
    Turns turns; // guards the members below
    std::array<Hand, 2> hands = {};
    Phase phase = Phase::Idle;
    int throws = 0;       ///< tied
    double angle = 0.0;   ///< [rad] by which hands have gone around each other
    double since = 0.0;   ///< [s] in this phase
    double still = 0.0;   ///< [s] since a hand has moved
    double largest = 0.0; ///< [N]
    Published<Told> told;
};

KnotHands::KnotHands(runtime::Simulation& simulation, const KnotDef& def)
    : impl_(std::make_shared<Impl>(simulation, def))
{
    simulation.everyStep([impl = impl_](double time) { impl->step(time); });
    remember(simulation, text("knot '", def.name, "'"), impl_);
}
KnotHands::~KnotHands() = default;

void KnotHands::begin() { impl_->begin(); }
void KnotHands::release() { impl_->release(); }
int KnotHands::tied() const { return impl_->told.read().tied; }
bool KnotHands::done() const { return impl_->told.read().done; }
double KnotHands::largestForce() const { return impl_->told.read().largest; }
BodyId KnotHands::hand(int which) const { return impl_->hands[which == 0 ? 0 : 1].body; }

} // namespace filasofia::prefab
