#include "filasofia/core/log.h"
#include "filasofia/core/text.h"
#include "filasofia/prefab/instrument_tie_impl.h"
#include "filasofia/prefab/standing_strand.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace filasofia::prefab {
namespace {

constexpr double kFlat = 0.15;     ///< [-] height of what tightens over the place, of its distance
constexpr double kClear = 8e-3;    ///< [m] least height of the hand over the long strand's base, below the shaft
constexpr double kPitch = 1e-3;    ///< [m] from loop to loop
constexpr double kFinger = 1.6e-3; ///< [m] along the strand, from finger to finger
constexpr double kSwing = 20e-3;   ///< [m] radius at which the assistant's turning counts as a way
constexpr double kLaid = 3e-3;     ///< [m] by which the driver slackens the tail before it lets go
constexpr double kApart = 15e-3;   ///< [m] that it draws back from the tail
/// [-] share of the speed with which the driver draws the tail through the loops: one that stopped dead 5 mm from the
/// jaws was drawn with 2.4 N at full speed, and is with 1.01 N.
constexpr double kThrough = 0.4;
constexpr double kForgets = 0.8; ///< [-] what is left of a tail's stiffness, from step to step

} // namespace

void InstrumentTie::Impl::work(const frame::Frame& now, const frame::SoftBodyFrame& thread, double dt)
{
    since += dt;
    largest = std::max({largest, hand.tension(now), tail.pull(now)});
    switch (phase) {
    case TiePhase::Take:
        hold(hand, 0);
        takeTail();
        return next(TiePhase::Show);
    case TiePhase::Show:
        return show(now, thread, dt);
    case TiePhase::Come:
        return come(now, dt);
    case TiePhase::Wind:
        return wind(now, dt);
    case TiePhase::Reach:
        return reach(now, dt);
    case TiePhase::Feed:
        return feed(now, dt);
    case TiePhase::Close:
        return close(now, dt);
    case TiePhase::Pinch:
        return pinch(thread);
    case TiePhase::Draw:
        return drawThrough(now, dt);
    case TiePhase::Spread:
        return spread(now, dt);
    case TiePhase::Tighten:
        return tighten(now, dt);
    case TiePhase::Lay:
        return lay(now, thread, dt);
    case TiePhase::Leave:
        return leave(now, dt);
    case TiePhase::Go:
        if (driver.goAlong(std::array{plan.above(def.place), def.driver.pose}, way, def.speed * dt))
            next(TiePhase::Done);
        return;
    default:
        return;
    }
}

/// The hand holds its strand up, towards its side and the front.
bool InstrumentTie::Impl::lift(const frame::Frame& now, double aside, double dt)
{
    return handStep(now, dt).turn(hand, plan.direction(aside, 1.0, 0.9), def.holding);
}

/// The assistant brings the tail there and turns it; returns whether it is there.
bool InstrumentTie::Impl::bring(const frame::Frame& now, Vec3 to, Vec3 inwards, double dt)
{
    const bool there = handStep(now, dt).goTo(assistant, to);
    const Vec3 turned = length(beside) * inwards;
    beside = turnedTowards(beside, turned, def.speed * dt / kSwing);
    simulation.physics().setPose(assistant.body, Pose{assistant.at(def.place) + beside}, 1);
    return there && beside == turned;
}

bool InstrumentTie::Impl::rests() const { return still > kStill || since > def.patience; }

void InstrumentTie::Impl::show(const frame::Frame& now, const frame::SoftBodyFrame& thread, double dt)
{
    if (way == 0) {
        measure(thread);
        way = 1;
    }
    const bool there = bring(now, plan.aside(), plan.tailwards(), dt);
    const bool rest = lift(now, 0.3, dt);
    still = there && rest ? still + dt : 0.0;
    if (way == 1 && there && rests()) {
        measure(thread);
        if (plan.tail < plan.leastTail())
            return giveUp(
                text("of the tail ", plan.tail, " m stand over the tissue, and ", plan.leastTail(), " m must"));
        // While the tail is slack, the last throw would slip: fingers pinch the strands where they leave it.
        if (throws > 0) pinching.reach(simulation, fingersBody, mostFingers(), thread, bases);
        way = 2;
    } else if (way == 2) {
        pinching.close(simulation, fingersBody, mostFingers(), def.thread, def.stiffness);
        next(TiePhase::Come);
    }
}

void InstrumentTie::Impl::come(const frame::Frame& now, double dt)
{
    lift(now, 0.3, dt);
    bring(now, plan.aside(), plan.tailwards(), dt);
    const std::array ways{plan.above(def.place), plan.coming(), plan.winding()};
    if (!driver.goAlong(ways, way, def.speed * dt)) return;
    angle = 0.0;
    hand.place(hand.at(def.place), leavesAt(), def.up);
    next(TiePhase::Wind);
}

double InstrumentTie::Impl::turnsNow() const { return def.turns[static_cast<std::size_t>(throws)]; }

/// Where the hand's strand leaves the jaws: a little nearer to the tip with each turn.
Vec3 InstrumentTie::Impl::leavesAt() const
{
    return plan.loops(driver.pose) + kPitch * angle / (2.0 * std::numbers::pi) * plan.along();
}

void InstrumentTie::Impl::wind(const frame::Frame& now, double dt)
{
    const double all = 2.0 * std::numbers::pi * turnsNow();
    hand.direction = turnedTowards(hand.direction, plan.around(angle), def.speed * dt / hand.away);
    const bool there = distance(hand.direction, plan.around(angle)) < 0.05;
    if (there) angle = std::min(angle + def.speed * dt / hand.away, all);
    handStep(now, dt).draw(hand, leavesAt(), def.holding);
    keepClear();
    if (angle < all || !there) return;
    driver.instrument.open(kOpen);
    next(TiePhase::Reach);
}

/// Below the shaft the hand does not come near the tail, even if its strand is slack for a while.
void InstrumentTie::Impl::keepClear()
{
    const double down = -dot(hand.direction, plan.over());
    const double room = dot(leavesAt() - plan.strandBase, plan.over()) - kClear;
    if (hand.away * down <= room) return;
    hand.away = room / down;
    simulation.physics().setPose(hand.body, Pose{hand.at(leavesAt())});
}

void InstrumentTie::Impl::reach(const frame::Frame& now, double dt)
{
    const bool there = driver.go(plan.taking(), def.speed * dt);
    handStep(now, dt).draw(hand, leavesAt(), def.holding);
    if (there && since > 0.3) next(TiePhase::Feed);
}

void InstrumentTie::Impl::feed(const frame::Frame& now, double dt)
{
    handStep(now, dt).draw(hand, leavesAt(), def.holding);
    if (!bring(now, plan.shown(), plan.inwards(), dt)) return;
    driver.instrument.close();
    next(TiePhase::Close);
}

void InstrumentTie::Impl::close(const frame::Frame& now, double dt)
{
    handStep(now, dt).draw(hand, leavesAt(), def.holding);
    if (driver.instrument.holding() == def.thread) {
        tail.grip = driver.gripOn(def.thread, now);
        leaveTail();
        hand.place(hand.at(leavesAt()), def.place, def.up);
        next(TiePhase::Pinch);
    } else if (since > def.patience) {
        giveUp("the tail is not between the driver's jaws");
    }
}

void InstrumentTie::Impl::giveUp(std::string_view why)
{
    logWarning("instrument tie '", def.name, "', throw ", throws + 1, ": ", why, ": given up");
    next(TiePhase::Failed);
}

/// Loops that only their strands hold back grip the jaws, and cross each other: they do not come off.
void InstrumentTie::Impl::pinch(const frame::SoftBodyFrame& thread)
{
    if (way == 0) {
        fingers.reach(simulation, fingersBody, 0, thread, loopNodes(thread));
        way = 1;
        return;
    }
    fingers.close(simulation, fingersBody, 0, def.thread, def.stiffness);
    next(TiePhase::Draw);
}

std::vector<int> InstrumentTie::Impl::loopNodes(const frame::SoftBodyFrame& thread) const
{
    const StandingStrand strand = standingStrand(thread, def.nodes[0], def.nodes[1], def.place, def.up);
    return fingerNodes(
        thread, def.nodes[0], strand,
        {.apart = kFinger, .most = mostFingers(), .wanted = [this](Vec3 at) { return driver.isWound(at); }});
}

/// By how much the driver moves in a step in which it wants this force at the tail. Thread between jaws is held so
/// stiffly that steps of a fixed gain made the force swing about what is wanted; so they shrink while it does. A tail
/// that was stuck 5 mm from the jaws gained 3.8 N per mm, damping included, while each step was a quarter longer than
/// the last one: from 0.97 N it went to 1.23 N. So steps are no longer than what is missing, by what the last ones
/// gained.
double InstrumentTie::Impl::driverStep(const frame::Frame& now, double force, double speed, double dt)
{
    const double pull = tail.pull(now), missing = force - pull, last = std::abs(drawn);
    const double gained = drawn > kCreep * dt ? (pull - pulled) / drawn : 0.0;
    stiff = std::max({gained, kForgets * stiff, def.stiffness});
    const double most = missing * drawn < 0.0 ? 0.5 * last : 1.25 * last + 0.1 * kCreep * dt;
    drawn = drawnBy(missing, missing > 0.0 ? stiff : def.stiffness, std::min(most, speed * dt));
    pulled = pull;
    return drawn;
}

/// No harder than a throw is tightened: a tail that is too short for the way would only be stretched.
void InstrumentTie::Impl::drawThrough(const frame::Frame& now, double dt)
{
    const double by = driverStep(now, def.force, kThrough * def.speed, dt);
    still = by > kCreep * dt ? 0.0 : still + dt;
    if (still > def.patience) return giveUp("the tail cannot be drawn through the loops with the force given");
    if (by <= 0.0 || !driver.go(plan.drawn(), by)) return;
    fingers.open(simulation);
    tail.place(driver.holdsAt(), def.place, def.up);
    next(TiePhase::Spread);
}

/// Moves the driver so that it draws at the tail with this force; returns whether it is there and rests.
bool InstrumentTie::Impl::drawTail(const frame::Frame& now, double force, double dt)
{
    const Vec3 to = plan.direction(1.0, kFlat, 0.0);
    const double by = driverStep(now, force, def.speed, dt);
    tail.direction = turnedTowards(tail.direction, to, def.speed * dt / tail.away);
    tail.moveBy(by);
    driver.move(plan.holding(tail.at(def.place)));
    return distance(tail.direction, to) < 1e-6 && std::abs(by) <= kCreep * dt;
}

bool InstrumentTie::Impl::part(const frame::Frame& now, double force, double dt)
{
    const bool rest = handStep(now, dt).turn(hand, plan.direction(-1.0, kFlat, 0.0), force);
    const bool there = drawTail(now, force, dt) && rest;
    still = there ? still + dt : 0.0;
    return rests();
}

void InstrumentTie::Impl::spread(const frame::Frame& now, double dt)
{
    if (!part(now, def.holding, dt)) return;
    pinching.open(simulation);
    next(TiePhase::Tighten);
}

void InstrumentTie::Impl::tighten(const frame::Frame& now, double dt)
{
    const double force = def.holding + std::min(since / kRamp, 1.0) * (def.force - def.holding);
    if (!part(now, force, dt) || since <= kRamp) return;
    if (still <= kStill)
        logWarning("instrument tie '", def.name, "': throw ", throws + 1, " still moved after ", def.patience,
                   " s: it may not be tight");
    plan.side = -plan.side;
    next(TiePhase::Lay);
}

/// A little slack, the tail stays as the driver has laid it, and an assistant takes it. From here on, the sides are
/// those of the next throw.
void InstrumentTie::Impl::lay(const frame::Frame& now, const frame::SoftBodyFrame& thread, double dt)
{
    settle(now, dt);
    if (since * def.speed < kLaid) {
        tail.moveBy(-def.speed * dt);
        driver.move({driver.pose.position + tail.at(def.place) - driver.holdsAt(), driver.pose.orientation});
        return;
    }
    if (way == 0) {
        reachTail(now, thread);
        way = 1;
        return;
    }
    takeTail();
    tail.grip = {};
    driver.instrument.open(kOpen);
    // Not along the plan's axis: its side is that of the next throw.
    parting = driver.back(kApart);
    next(TiePhase::Leave);
}

/// The hand holds its strand up for the next throw. After the last one it gives slack: a square knot at one of
/// whose ends somebody draws turns over, and slides off the other.
void InstrumentTie::Impl::settle(const frame::Frame& now, double dt)
{
    if (throws + 1 < std::ssize(def.turns)) {
        lift(now, 0.3, dt);
    } else if (phase == TiePhase::Lay && since * def.speed < kLaid) {
        hand.moveBy(-def.speed * dt);
        simulation.physics().setPose(hand.body, Pose{hand.at(def.place)});
    }
}

void InstrumentTie::Impl::leave(const frame::Frame& now, double dt)
{
    settle(now, dt);
    if (since < 0.3 || !driver.go(parting, def.speed * dt)) return;
    ++throws;
    next(throws < std::ssize(def.turns) ? TiePhase::Show : TiePhase::Go);
}

} // namespace filasofia::prefab
