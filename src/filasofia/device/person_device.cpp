#include "filasofia/device/devices.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace filasofia::device {
namespace {

constexpr double kTimeConstant = 0.02;     ///< [s] time constant with which the position follows the target
constexpr double kMaxInterval = 0.1;       ///< [s] longest time between two readings; a longer one was a pause
constexpr double kMaxTargetDistance = 0.5; ///< [m] largest distance of the target from the origin, per axis

// The user's input comes in jerks, once per picture or mouse report, but a coupling needs a velocity: so a hand follows
// its target like a critically damped spring, integrated exactly for any dt.
void follow(double dt, Vec3& off, Vec3& velocity)
{
    const double rate = 1.0 / kTimeConstant, fade = std::exp(-rate * dt);
    const Vec3 c = velocity + rate * off;
    off = fade * (off + dt * c);
    velocity = fade * (velocity - rate * dt * c);
}

} // namespace

PersonDevice::PersonDevice(std::string name, const Rates& rates) : name_(std::move(name)), rates_(rates) {}

void PersonDevice::open()
{
    const std::lock_guard lock(mutex_);
    input_ = {};
    last_.reset();
}

void PersonDevice::feed(const PersonInput& input)
{
    const std::lock_guard lock(mutex_);
    input_.moved += input.moved;
    input_.turned += input.turned;
    if (input.push) input_.push = input.push;
    if (input.twist) input_.twist = input.twist;
    if (input.buttons) input_.buttons = input.buttons;
}

DeviceSample PersonDevice::read(double time) noexcept
{
    PersonInput input;
    {
        const std::lock_guard lock(mutex_);
        input = input_;
        input_.moved = {};
        input_.turned = {};
    }
    const double dt = last_ ? std::clamp(time - *last_, 0.0, kMaxInterval) : 0.0;
    last_ = time;
    wanted_ += rates_.reach * input.moved + dt * rates_.speed * input.push.value_or(Vec3{});
    for (int k = 0; k < 3; ++k) wanted_[k] = std::clamp(wanted_[k], -kMaxTargetDistance, kMaxTargetDistance);
    Vec3 off = hand_.pose.position - wanted_;
    follow(dt, off, hand_.velocity);
    hand_.pose.position = wanted_ + off;

    // Rotations to the side and up and down are about the device's axes, that of a wheel about the hand's own.
    turnOff_ -= rates_.turn * input.turned;
    const Vec3 before = turnOff_;
    follow(dt, turnOff_, turning_);
    const Vec3 turned = turnOff_ - before;
    twisting_ += (1.0 - std::exp(-dt / kTimeConstant)) * (rates_.turnSpeed * input.twist.value_or(Vec3{}) - twisting_);
    const auto inDevice = [&](Vec3 of) {
        return Vec3{of.x, of.y, 0.0} + rotate(hand_.pose.orientation, Vec3{0.0, 0.0, of.z});
    };
    const Vec3 way = dt * twisting_ + inDevice(turned);
    hand_.angularVelocity = twisting_ + inDevice(turning_);
    hand_.pose.orientation = normalized(axisAngle(way, length(way)) * hand_.pose.orientation);
    return {hand_, input.buttons.value_or(0)};
}

} // namespace filasofia::device
