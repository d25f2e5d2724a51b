#include "filasofia/device/servo_loop.h"

#include "filasofia/core/validate.h"

#include <algorithm>
#include <cmath>

namespace filasofia::device {
namespace {

constexpr double kFarthestHand = 10.0; ///< [m] from the device's origin: no arm is so long
constexpr double kFastestHand = 50.0;  ///< [m/s], and none so fast
constexpr double kFastestTurn = 500.0; ///< [rad/s]
constexpr double kSettle = 0.1;        ///< [s] that a device must be right for after it was wrong
constexpr double kMargin = 1.5;        ///< [-] times a tick that the next force may last
constexpr double kAcceleration = 20.0; ///< [m/s^2] of a hand within a tick, beside its velocity
constexpr double kBrake = 5.0;         ///< [N s/m] with which too much energy is taken back
constexpr double kTurnBrake = 5e-3;    ///< [N m s/rad] the same of turning

double seconds(Nanoseconds time) { return 1e-9 * static_cast<double>(time); }

bool isFinite(const CouplingForce& f) { return filasofia::isFinite(f.force) && filasofia::isFinite(f.torque); }
bool isFinite(const Moving& m)
{
    return filasofia::isFinite(m.pose) && filasofia::isFinite(m.velocity) && filasofia::isFinite(m.angularVelocity);
}

Vec3 turnBetween(const Moving& from, const Moving& to)
{
    return rotationVector(to.pose.orientation * conjugate(from.pose.orientation));
}

ServoState stateOf(DeviceStatus status)
{
    switch (status) {
    case DeviceStatus::Ready:
        return ServoState::Running;
    case DeviceStatus::NotCalibrated:
        return ServoState::NotCalibrated;
    case DeviceStatus::Lost:
        return ServoState::Lost;
    case DeviceStatus::Failed:
        break;
    }
    return ServoState::Failed;
}

/// Where the body is `time` [s] after it was seen.
Moving later(const Moving& body, double time)
{
    Moving out = body;
    out.pose.position += time * body.velocity;
    out.pose.orientation =
        normalized(axisAngle(body.angularVelocity, time * length(body.angularVelocity)) * body.pose.orientation);
    return out;
}

/// Takes from `force` what would give more than `room` [J] to what moves by `way`, and pays back `debt` [J] where it
/// can, braking with no more than `brake` [N s/m] beyond that. Force and way, or torque and turn.
Vec3 withoutGift(Vec3 force, Vec3 way, double share, double debt, double brake)
{
    const double size = length(way);
    if (size < 1e-12) return force; // it rests: nothing is given
    const Vec3 direction = way / size;
    const double along = dot(force, direction);
    const double allowed = along > 0.0 ? share * along : along;
    return force + (allowed - along - std::min(debt / size, brake)) * direction;
}

} // namespace

std::string_view describe(DeviceStatus status)
{
    constexpr std::string_view names[] = {"ready", "not calibrated", "lost", "failed"};
    return names[static_cast<std::size_t>(status)];
}

std::string_view describe(ServoState state)
{
    constexpr std::string_view names[kServoStates] = {"waiting", "running", "not calibrated",
                                                      "lost",    "failed",  "implausible"};
    return names[static_cast<std::size_t>(state)];
}

HandCoupling sceneCoupling(const ServoDef& def)
{
    HandCoupling coupling = def.coupling;
    const double share = def.forceScale > 0.0 ? def.forceScale : 1.0; // a hand that is not pushed pushes all the same
    coupling.forceLimit = std::min(coupling.forceLimit, def.forceLimit / share);
    coupling.torqueLimit = std::min(coupling.torqueLimit, def.torqueLimit * def.scale / share);
    return coupling;
}

Moving inScene(const ServoDef& def, const Moving& hand)
{
    const Quat turn = def.origin.orientation;
    return {
        {def.origin.position + def.scale * rotate(turn, hand.pose.position), turn * hand.pose.orientation * def.grip},
        def.scale * rotate(turn, hand.velocity),
        rotate(turn, hand.angularVelocity)};
}

ServoLoop::ServoLoop(const ServoDef& def) { setDef(def); }

void ServoLoop::setDef(const ServoDef& def)
{
    validate(def, "haptic servo");
    def_ = def;
    def_.origin.orientation = normalized(def.origin.orientation);
    def_.grip = normalized(def.grip);
    interrupt();
}

void ServoLoop::interrupt()
{
    ramp_ = 0.0;
    given_ = {};
    lastHand_.reset();
}

ServoState ServoLoop::judge(Nanoseconds now, const DeviceSample& device) const
{
    if (device.status != DeviceStatus::Ready) return stateOf(device.status);
    const Moving& hand = device.hand;
    const Quat q = hand.pose.orientation;
    if (!isFinite(hand) || !(std::abs(dot(q, q) - 1.0) < 1e-2) || !(length(hand.pose.position) < kFarthestHand) ||
        !(length(hand.velocity) < kFastestHand) || !(length(hand.angularVelocity) < kFastestTurn))
        return ServoState::Implausible;
    if (lastHand_ && last_) { // a jump; one in no time at all is measured by a tick
        const double dt = std::max(seconds(now - *last_), 1.0 / def_.rate);
        if (!(distance(hand.pose.position, lastHand_->pose.position) < kFastestHand * dt))
            return ServoState::Implausible;
    }
    return ServoState::Running;
}

bool ServoLoop::fresh(Nanoseconds now, const BodySample* body)
{
    if (!body || !isFinite(body->body) || !filasofia::isFinite(body->centre)) return false;
    if (number_ != body->number) {
        number_ = body->number;
        newest_ = now;
    }
    return seconds(now - newest_) <= watchdogOf(def_.stepPeriod);
}

// Between two ticks the device holds the force, so the work is exactly force times way (the passivity observer of
// Hannaford and Ryu 2002). What the hand gave is kept for it, up to a limit: energy that was lost in tissue long ago is
// no reason to push a hand now.
void ServoLoop::countEnergy(const Moving& hand)
{
    if (!lastHand_) return;
    const double work = dot(given_.force, hand.pose.position - lastHand_->pose.position) +
                        dot(given_.torque, turnBetween(*lastHand_, hand));
    energy_ += work;
    stored_ = std::min(def_.energyLimit, stored_ - work);
}

CouplingForce ServoLoop::coupled(Nanoseconds now, const Moving& inScene, const BodySample& body) const
{
    // A state is at most one period old when the next one comes, and another while that is computed.
    const double age = std::clamp(seconds(now - body.time), 0.0, 2.0 * def_.stepPeriod);
    const Moving hand = atPoint(inScene, body.centre);
    const CouplingForce onBody = couplingForce(sceneCoupling(def_), hand, later(atPoint(body.body, body.centre), age));
    const Vec3 arm = hand.pose.position - inScene.pose.position;
    const Quat toDevice = conjugate(def_.origin.orientation);
    // The hand moves 1 / scale times as far: so that no energy is made, its torque is to the scene's as its work is.
    return {-def_.forceScale * rotate(toDevice, onBody.force),
            -def_.forceScale / def_.scale * rotate(toDevice, onBody.torque + cross(arm, onBody.force))};
}

CouplingForce ServoLoop::limited(const CouplingForce& force) const
{
    const double most = std::min(def_.forceLimit, capabilities_.forceLimit);
    const double mostTorque = std::min(def_.torqueLimit, capabilities_.torqueLimit);
    return {weakened(length(force.force), most) * force.force,
            weakened(length(force.torque), mostTorque) * force.torque};
}

// The passivity controller: of a force that would push the hand on its way only so much is left as the hand has given
// before, less what an acceleration within the tick may take. Where the hand has got too much all the same it is
// braked.
CouplingForce ServoLoop::passive(const CouplingForce& force, const Moving& hand) const
{
    const double tick = 1.0 / def_.rate;
    const Vec3 way = tick * hand.velocity, turn = tick * hand.angularVelocity;
    const double gift = kMargin * (std::max(0.0, dot(force.force, way)) + std::max(0.0, dot(force.torque, turn)));
    const double reserve = length(force.force) * kAcceleration * tick * tick;
    const double room = std::max(0.0, stored_ - reserve), debt = std::max(0.0, -stored_);
    const double share = gift > room ? room / gift : 1.0;
    if (share == 1.0 && debt == 0.0) return force;
    return {withoutGift(force.force, way, share, debt, kBrake * length(hand.velocity)),
            withoutGift(force.torque, turn, share, debt, kTurnBrake * length(hand.angularVelocity))};
}

ServoTick ServoLoop::tick(Nanoseconds now, const DeviceSample& device, const BodySample* body)
{
    const bool stateIsNew = fresh(now, body);
    const ServoState judged = judge(now, device);
    const double dt = last_ ? seconds(now - *last_) : 0.0;
    last_ = now;
    if (judged != ServoState::Running) {
        interrupt();
        bad_ = judged;
        badUntil_ = now + static_cast<Nanoseconds>(kSettle * 1e9);
    } else {
        countEnergy(device.hand);
        lastHand_ = device.hand;
        lastHand_->pose.orientation = normalized(device.hand.pose.orientation);
        lastInScene_ = inScene(def_, *lastHand_);
    }
    given_ = {};
    if (badUntil_ && now >= *badUntil_) badUntil_.reset();
    if (badUntil_) return {.hand = lastInScene_, .state = bad_, .energy = energy_};

    // A tick that comes so late, or a body of which nothing is heard: the hand is let go before it is pulled again.
    const bool late = dt > watchdogOf(def_.stepPeriod);
    if (!stateIsNew) {
        ramp_ = 0.0;
        return {.hand = lastInScene_, .state = ServoState::Waiting, .energy = energy_};
    }
    ramp_ = def_.rampIn > 0.0 ? std::min(1.0, late ? 0.0 : ramp_ + dt / def_.rampIn) : 1.0;
    CouplingForce force = coupled(now, lastInScene_, *body);
    force = limited({ramp_ * force.force, ramp_ * force.torque});
    if (!capabilities_.torque) force.torque = {};
    if (!capabilities_.force) force.force = {};
    force = limited(passive(force, *lastHand_));
    if (!isFinite(force)) { // two numbers of which each was fine
        interrupt();
        return {.hand = lastInScene_, .state = ServoState::Waiting, .energy = energy_};
    }
    given_ = force;
    return {.onHand = force, .hand = lastInScene_, .state = ServoState::Running, .energy = energy_};
}

} // namespace filasofia::device
