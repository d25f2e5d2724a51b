#include "filasofia/prefab/knot_hands.h"

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/core/published.h"
#include "filasofia/core/text.h"
#include "filasofia/core/validate.h"
#include "filasofia/geometry/knot_determinant.h"
#include "filasofia/physics/defs.h"
#include "filasofia/prefab/knot_plan.h"
#include "filasofia/prefab/remember.h"
#include "filasofia/prefab/strand_hand.h"
#include "filasofia/prefab/turns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <tuple>

namespace filasofia::prefab {
namespace {

constexpr double kSkin = 1.5e-3; ///< [m] over the place: what is lower is no free strand
constexpr double kLow = 0.1;     ///< [-] hands that tighten are above the place by this share of their distance
constexpr double kLead = 1.2;    ///< [-] length of strand up to the loops over its distance

KnotDef checked(runtime::Simulation& simulation, KnotDef def)
{
    const std::string object = text("knot '", def.name, "'");
    validate(def, object);
    def.nodes = heldNodes(simulation, def.thread, def.nodes, object);
    if (def.turns.empty()) fail(object, ": turns must have at least one entry, got none");
    makeAxes(def.up, def.across, object);
    const auto body = simulation.physics().def(def.thread);
    const double thick = 2.0 * std::get<physics::RodBodyDef>(*body).radius;
    if (!(def.loop >= thick)) fail(object, ": loop must be >= the thread's thickness = ", thick, " m, got ", def.loop);
    if (!(def.height > def.loop)) fail(object, ": height must be > loop = ", def.loop, " m, got ", def.height);
    return def;
}

double inMillimetres(double length) { return std::round(1e4 * length) / 10.0; }

enum class Phase {
    Idle,    ///< holds nothing
    Reach,   ///< jumps to the thread
    Take,    ///< holds it from the next step on
    Lift,    ///< brings both strands up, each on its side
    Lay,     ///< brings the first strand across, behind the second one
    Seize,   ///< fingers jump to the first strand
    Loop,    ///< fingers form loops
    Thread,  ///< the second hand goes through them
    Spread,  ///< both come down, each on the other side
    Tighten, ///< draws
    Done     ///< all throws are made; holds both strands up
};

struct Finger {
    int node = 0;
    Vec3 from = {}; ///< [m] where it took the thread
    AttachmentId grip = {};
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
        const auto most = static_cast<std::size_t>(kFingersPerTurn * std::ranges::max(def.turns) + 1);
        // Two more pinch the strands where they leave the last throw, or it would slip while the second one is slack.
        fingersBody = sim.add(physics::RigidBodyDef{.name = def.name + ": fingers",
                                                    .elements = std::vector<Pose>(most + 2, Pose{def.place})});
        const auto body = sim.physics().def(def.thread);
        const auto& rod = std::get<physics::RodBodyDef>(*body);
        frame = {def.place, def.across, def.up, cross(def.across, def.up)};
        frame.loop = def.loop;
        frame.height = def.height;
        frame.pitch = std::max(6.0 * rod.radius, 2.0 / 3.0 * def.loop);
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
            for (StrandHand& hand : hands) {
                if (hand.grip) simulation.physics().release(hand.grip);
                hand.grip = {};
            }
            open(fingers);
            open(pinching);
            next(Phase::Idle);
        });
    }

    // Stepping thread, before each step.
    void step(double time)
    {
        const frame::FrameRef now = simulation.physics().latest();
        if (!now) return;
        turns.now([&] {
            const frame::SoftBodyFrame* thread = now->softBody(def.thread);
            if (thread == nullptr || phase == Phase::Idle) return;
            if (phase == Phase::Reach)
                reach(*thread);
            else if (phase == Phase::Take)
                take();
            else
                work(*now, *thread, std::max(time - now->time, 0.0));
            publish();
        });
    }

    void reach(const frame::SoftBodyFrame& thread)
    {
        throws = tied = 0;
        largest = 0.0;
        for (std::size_t i = 0; i < 2; ++i) {
            const Vec3 at = thread.positions[static_cast<std::size_t>(def.nodes[i])];
            simulation.physics().setPose(hands[i].body, Pose{at});
            place(hands[i], at);
        }
        hands[0].side = apart(thread) > 0.0 ? 1.0 : -1.0;
        hands[1].side = -hands[0].side;
        next(Phase::Take);
    }
    /// From the second strand to the first, along `across`, where they leave the tissue: their ends may have crossed.
    /// If they leave it together, as out of a knot, or are nowhere near it, their ends count.
    [[nodiscard]] double apart(const frame::SoftBodyFrame& thread) const
    {
        const std::array<int, 2> bases = {baseOf(thread, 0), baseOf(thread, 1)};
        const auto at = [&](int i) {
            return dot(thread.positions[static_cast<std::size_t>(bases[static_cast<std::size_t>(i)])], def.across);
        };
        if (bases[0] != def.nodes[1] && std::abs(at(0) - at(1)) > 2.0 * def.loop) return at(0) - at(1);
        return dot(hands[0].direction - hands[1].direction, def.across);
    }
    void place(StrandHand& hand, Vec3 at) const { hand.place(at, def.place, def.up); }
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

    /// Where a strand goes in this phase.
    [[nodiscard]] Vec3 wanted(std::size_t which) const
    {
        const double side = hands[which].side;
        const auto along = [&](double x, double y, double z) {
            return normalized(x * def.across + y * def.up + z * frame.front);
        };
        if (phase == Phase::Spread || phase == Phase::Tighten) return along(side, kLow, 0.0);
        if (phase == Phase::Done) return along(0.5 * side, 1.0, 0.0);
        if (which == 1) return along(0.5 * side, 1.0, 0.7);
        if (phase == Phase::Lift) return along(0.5 * side, 1.0, -0.4);
        return along(-0.8 * side, 0.7, -0.7); // behind the second strand, to the other side
    }
    void work(const frame::Frame& now, const frame::SoftBodyFrame& thread, double dt)
    {
        since += dt;
        const bool full = phase == Phase::Tighten;
        const double force = def.holding + (full ? std::min(since / kRamp, 1.0) * (def.force - def.holding) : 0.0);
        bool there = true, moving = false;
        for (std::size_t i = 0; i < 2; ++i) {
            if (i == 1 && phase == Phase::Thread) continue;
            const Vec3 to = wanted(i);
            hands[i].direction = turnedTowards(hands[i].direction, to, def.speed * dt / hands[i].away);
            there = there && distance(hands[i].direction, to) < 1e-6;
            moving = draw(hands[i], now, force, dt) > kCreep * dt || moving;
        }
        still = moving ? 0.0 : still + dt;
        advance(thread, there, dt);
    }
    /// Moves a hand along its strand so that it draws with this force; returns by how much [m].
    double draw(StrandHand& hand, const frame::Frame& now, double force, double dt)
    {
        const double tension = hand.tension(now);
        largest = std::max(largest, tension);
        const double by = drawnBy(force - tension, def.stiffness, def.speed * dt);
        hand.moveBy(by);
        simulation.physics().setPose(hand.body, Pose{hand.at(def.place)});
        return std::abs(by);
    }
    /// What belongs to a phase beside the hands' strands; then the next phase, if this one has come to its end.
    void advance(const frame::SoftBodyFrame& thread, bool there, double dt)
    {
        switch (phase) {
        case Phase::Lift:
            if (!there || !rests()) break;
            if (throws == 0) determinant = determinantOf(thread);
            next(Phase::Lay);
            break;
        case Phase::Lay:
            if (there && rests()) seize(thread);
            break;
        case Phase::Seize:
            grasp();
            break;
        case Phase::Loop:
            form(dt);
            break;
        case Phase::Thread:
            pass(dt);
            break;
        case Phase::Spread:
            if (!there || !rests()) break;
            open(pinching);
            next(Phase::Tighten);
            break;
        case Phase::Tighten:
            if (since <= kRamp || !rests()) break;
            if (still <= kStill)
                logWarning("knot '", def.name, "': throw ", throws + 1, " still moved after ", def.patience,
                           " s: it may not be tight");
            judge(thread);
            next(++throws < std::ssize(def.turns) ? Phase::Lift : Phase::Done);
            break;
        default:
            break;
        }
    }

    [[nodiscard]] int determinantOf(const frame::SoftBodyFrame& thread) const
    {
        const auto [low, high] = std::minmax(def.nodes[0], def.nodes[1]);
        const auto first = static_cast<std::size_t>(low), count = static_cast<std::size_t>(high - low) + 1;
        return geometry::knotDeterminantOpen(std::span(thread.positions).subspan(first, count), def.across, def.up);
    }
    /// Whether the throw that was made is one: the determinant of a square knot is the product of its throws', which is
    /// 2 t + 1 for t turns. Two throws that wind one way and the other look like none if only turns are counted.
    void judge(const frame::SoftBodyFrame& thread)
    {
        const int now = determinantOf(thread);
        const int asked = determinant * (2 * def.turns[static_cast<std::size_t>(throws)] + 1);
        if (now == asked)
            ++tied;
        else
            logWarning("knot '", def.name, "': throw ", throws + 1, " is not tied: with it the thread forms ",
                       now == 1 ? "no knot" : "another knot", " (determinant ", now, " in place of ", asked, ")");
        if (now == 1) tied = 0;
        determinant = now;
    }
    [[nodiscard]] bool rests() const { return still > kStill || since > def.patience; }
    [[nodiscard]] Throw made() const
    {
        return {.turns = def.turns[static_cast<std::size_t>(throws)], .side = hands[0].side};
    }
    /// Chooses the nodes for the fingers, and brings those there.
    void seize(const frame::SoftBodyFrame& thread)
    {
        const auto at = [&](int node) { return thread.positions[static_cast<std::size_t>(node)]; };
        const int inwards = inwardsOf(0);
        int node = baseOf(thread, 0);
        const std::vector<Vec3> loops = loopsOf(frame, made(), 0.0);
        double left = kLead * distance(at(node), loops.front());
        const double needed = left + static_cast<double>(loops.size() - 1) * fingerStep(frame);
        fingers.clear();
        for (std::size_t i = 0; i < loops.size(); ++i) {
            for (; left > 0.0 && node != def.nodes[0]; node -= inwards) left -= distance(at(node), at(node - inwards));
            if (node == def.nodes[0]) break; // too short: as many loops as there is thread for
            left += fingerStep(frame);
            fingers.push_back({.node = node, .from = at(node)});
            simulation.physics().setPose(fingersBody, Pose{at(node)}, static_cast<int>(i));
        }
        if (fingers.size() < loops.size()) {
            double strand = 0.0;
            for (int i = baseOf(thread, 0); i != def.nodes[0]; i -= inwards) strand += distance(at(i), at(i - inwards));
            logWarning("knot '", def.name, "': the first strand is too short for throw ", throws + 1, ": ",
                       inMillimetres(strand), " mm of it are more than ", inMillimetres(kSkin),
                       " mm above the place, and ", inMillimetres(needed), " mm are needed; ", fingers.size(), " of ",
                       loops.size(), " fingers find a node of it");
        }
        pinching.clear();
        for (int i = 0; throws > 0 && i < 2; ++i) {
            const int base = baseOf(thread, i);
            pinching.push_back({.node = base, .from = at(base)});
            simulation.physics().setPose(fingersBody, Pose{at(base)}, static_cast<int>(loops.size()) + i);
        }
        next(Phase::Seize);
    }
    /// [-], 1 or -1: from a hand's node towards the other one.
    [[nodiscard]] int inwardsOf(int hand) const { return (def.nodes[1] > def.nodes[0]) == (hand == 0) ? 1 : -1; }
    /// The first node of a strand, from its hand on, that is near the tissue.
    [[nodiscard]] int baseOf(const frame::SoftBodyFrame& thread, int hand) const
    {
        const int inwards = inwardsOf(hand);
        const int other = def.nodes[static_cast<std::size_t>(1 - hand)];
        int node = def.nodes[static_cast<std::size_t>(hand)];
        const auto height = [&] { return dot(thread.positions[static_cast<std::size_t>(node)] - def.place, def.up); };
        while (node != other && height() > kSkin) node += inwards;
        return node;
    }
    void grasp()
    {
        const auto close = [&](Finger& finger, std::size_t element) {
            finger.grip = simulation.physics().attach(def.thread, {.nodes = {finger.node},
                                                                   .stiffness = def.stiffness,
                                                                   .to = fingersBody,
                                                                   .element = static_cast<int>(element)});
        };
        const std::size_t loops = loopsOf(frame, made(), 0.0).size();
        for (std::size_t i = 0; i < fingers.size(); ++i) close(fingers[i], i);
        for (std::size_t i = 0; i < pinching.size(); ++i) close(pinching[i], loops + i);
        next(Phase::Loop);
    }
    void open(std::vector<Finger>& those)
    {
        for (const Finger& finger : those)
            if (finger.grip) simulation.physics().release(finger.grip);
        those.clear();
    }
    /// First the fingers go to a straight line, then the line winds up.
    void form(double dt)
    {
        const double straight = 1.5 * def.height / def.speed, wound = 8.0 * def.loop / def.speed;
        const std::vector<Vec3> loops = loopsOf(frame, made(), std::clamp((since - straight) / wound, 0.0, 1.0));
        const double part = std::min(since / straight, 1.0);
        for (std::size_t i = 0; i < fingers.size(); ++i)
            simulation.physics().setPose(fingersBody, Pose{fingers[i].from + part * (loops[i] - fingers[i].from)},
                                         static_cast<int>(i));
        if (since < straight + wound + dt) return;
        way = 0;
        next(Phase::Thread);
    }
    void pass(double dt)
    {
        const std::vector<Vec3> points = wayThrough(frame, made());
        StrandHand& hand = hands[1];
        Vec3 at = def.place + hand.away * hand.direction;
        const Vec3 to = points[static_cast<std::size_t>(way)];
        const double left = distance(at, to), most = def.speed * dt;
        at = left > most ? at + most / left * (to - at) : to;
        place(hand, at);
        simulation.physics().setPose(hand.body, Pose{at});
        if (left > most || ++way < std::ssize(points)) return;
        open(fingers);
        for (StrandHand& each : hands) each.side = -each.side;
        next(Phase::Spread);
    }

    void publish() { told.write({.tied = tied, .done = phase == Phase::Done, .largest = largest}); }
    using Kept = std::tuple<std::array<StrandHand, 2>, std::vector<Finger>, std::vector<Finger>, Phase, int, int, int,
                            int, double, double, double>;
    auto kept()
    {
        return std::tie(hands, fingers, pinching, phase, throws, tied, way, determinant, since, still, largest);
    }

    runtime::Simulation& simulation;
    const KnotDef def;
    KnotFrame frame;
    BodyId fingersBody = {};
    Turns turns; // guards the members below
    std::array<StrandHand, 2> hands = {};
    std::vector<Finger> fingers, pinching;
    Phase phase = Phase::Idle;
    int throws = 0;       ///< made
    int tied = 0;         ///< that hold
    int determinant = 1;  ///< [-] that of the knot after the last throw
    int way = 0;          ///< the point of its way to which the second hand goes
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
