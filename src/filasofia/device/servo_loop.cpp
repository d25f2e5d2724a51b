#include "filasofia/device/servo_loop.h"

#include "filasofia/core/validate.h"
#include "filasofia/device/hand_limits.h"

#include <algorithm>
#include <cmath>

namespace filasofia::device {
namespace {

constexpr double kMaxHandSpeed = 50.0;      ///< [m/s]: no hand is that fast
constexpr double kMaxAngularSpeed = 500.0;  ///< [rad/s]
constexpr double kSettle = 0.1;             ///< [s] for which a device must work after a fault before it gets a force
constexpr double kMargin = 1.5;             ///< [-] the next force may last for this many ticks
constexpr double kAcceleration = 20.0;      ///< [m/s^2] largest assumed acceleration of a hand within a tick
constexpr double kMaxDamping = 5.0;         ///< [N s/m] damping that takes excess energy back
constexpr double kMaxAngularDamping = 5e-3; ///< [N m s/rad] the same for rotation

bool isFinite(const CouplingForce& f) { return filasofia::isFinite(f.force) && filasofia::isFinite(f.torque); }
bool isFinite(const MotionState& m)
{
    return filasofia::isFinite(m.pose) && filasofia::isFinite(m.velocity) && filasofia::isFinite(m.angularVelocity);
}

Vec3 turnBetween(const MotionState& from, const MotionState& to)
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

/// The motion of the body extrapolated by `time` [s].
MotionState later(const MotionState& body, double time)
{
    MotionState out = body;
    out.pose.position += time * body.velocity;
    out.pose.orientation =
        normalized(axisAngle(body.angularVelocity, time * length(body.angularVelocity)) * body.pose.orientation);
    return out;
}

/// Scales the component of `force` along `way` by `share` if it pushes the hand on its way, and takes back `debt` [J],
/// with at most `brake` [N] for it. Either force and displacement or torque and rotation.
Vec3 limitedPower(Vec3 force, Vec3 way, double share, double debt, double brake)
{
    const double size = length(way);
    if (size < 1e-12) return force; // the hand rests, so no energy flows
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

VirtualCoupling sceneCoupling(const ServoDef& def)
{
    VirtualCoupling coupling = def.coupling;
    const double share = def.forceScale > 0.0 ? def.forceScale : 1.0; // if the hand gets no force, the body still does
    coupling.forceLimit = std::min(coupling.forceLimit, def.forceLimit / share);
    coupling.torqueLimit = std::min(coupling.torqueLimit, def.torqueLimit * def.scale / share);
    return coupling;
}

MotionState inScene(const ServoDef& def, const MotionState& hand)
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
    const MotionState& hand = device.hand;
    const Quat q = hand.pose.orientation;
    if (!isFinite(hand) || !(std::abs(dot(q, q) - 1.0) < 1e-2) || !(length(hand.pose.position) < kMaxHandDistance) ||
        !(length(hand.velocity) < kMaxHandSpeed) || !(length(hand.angularVelocity) < kMaxAngularSpeed))
        return ServoState::Implausible;
    if (lastHand_ && last_) { // a jump; if no time has passed, it is compared with one tick
        const double dt = std::max(seconds(now - *last_), 1.0 / def_.rate);
        if (!(distance(hand.pose.position, lastHand_->pose.position) < kMaxHandSpeed * dt))
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

// Between two ticks the device holds the force, so the work is exactly force times displacement (the passivity observer
// of Hannaford and Ryu 2002). The energy that the hand has put in is stored for it, up to a limit: energy that was
// dissipated in tissue long ago is no reason to push a hand now.
void ServoLoop::countEnergy(const MotionState& hand)
{
    if (!lastHand_) return;
    const double work = dot(given_.force, hand.pose.position - lastHand_->pose.position) +
                        dot(given_.torque, turnBetween(*lastHand_, hand));
    energy_ += work;
    stored_ = std::min(def_.energyLimit, stored_ - work);
}

CouplingForce ServoLoop::coupled(Nanoseconds now, const MotionState& inScene, const BodySample& body) const
{
    // A state is at most one period old when the next one arrives, and may be used for another while that is
    // computed.
    const double age = std::clamp(seconds(now - body.time), 0.0, 2.0 * def_.stepPeriod);
    const MotionState hand = atPoint(inScene, body.centre);
    const CouplingForce onBody = couplingForce(sceneCoupling(def_), hand, later(atPoint(body.body, body.centre), age));
    const Vec3 arm = hand.pose.position - inScene.pose.position;
    const Quat toDevice = conjugate(def_.origin.orientation);
    // The hand moves 1 / scale times as far. To conserve energy, its torque is scaled from the scene's as its work is.
    return {-def_.forceScale * rotate(toDevice, onBody.force),
            -def_.forceScale / def_.scale * rotate(toDevice, onBody.torque + cross(arm, onBody.force))};
}

CouplingForce ServoLoop::limited(const CouplingForce& force) const
{
    const double maxForce = std::min(def_.forceLimit, capabilities_.forceLimit);
    const double maxTorque = std::min(def_.torqueLimit, capabilities_.torqueLimit);
    return {limitFactor(length(force.force), maxForce) * force.force,
            limitFactor(length(force.torque), maxTorque) * force.torque};
}

// The passivity controller: a force that would push the hand on its way is limited to the energy that the hand has put
// in before, minus what an acceleration within the tick may extract. If the hand has got too much energy all the same,
// it is braked.
CouplingForce ServoLoop::passive(const CouplingForce& force, const MotionState& hand) const
{
    const double tick = 1.0 / def_.rate;
    const Vec3 way = tick * hand.velocity, turn = tick * hand.angularVelocity;
    const double output = kMargin * (std::max(0.0, dot(force.force, way)) + std::max(0.0, dot(force.torque, turn)));
    const double reserve = length(force.force) * kAcceleration * tick * tick;
    const double room = std::max(0.0, stored_ - reserve), debt = std::max(0.0, -stored_);
    const double share = output > room ? room / output : 1.0;
    if (share == 1.0 && debt == 0.0) return force;
    return {limitedPower(force.force, way, share, debt, kMaxDamping * length(hand.velocity)),
            limitedPower(force.torque, turn, share, debt, kMaxAngularDamping * length(hand.angularVelocity))};
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

    // If a tick is so late, or nothing is heard of the body, the hand is released before it is pulled again.
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
    if (!isFinite(force)) { // two finite numbers may overflow together
        interrupt();
        return {.hand = lastInScene_, .state = ServoState::Waiting, .energy = energy_};
    }
    given_ = force;
    return {.onHand = force, .hand = lastInScene_, .state = ServoState::Running, .energy = energy_};
}

} // namespace filasofia::device
