#include "filasofia/device/devices.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace filasofia::device {
namespace {

constexpr double kTimeConstant = 0.02;     ///< [s] time constant with which the position follows the target
constexpr double kMaxInterval = 0.1;       ///< [s] longest time between two readings; a longer one was a pause
constexpr double kMaxTargetDistance = 0.5; ///< [m] largest distance of the target from the origin, per axis

} // namespace

PersonDevice::PersonDevice(std::string name, double reach, double speed, double turnSpeed)
    : name_(std::move(name)), reach_(reach), speed_(speed), turnSpeed_(turnSpeed)
{
}

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
    if (input.push) input_.push = input.push;
    if (input.twist) input_.twist = input.twist;
    if (input.buttons) input_.buttons = input.buttons;
}

// The position follows the target like a critically damped spring, integrated exactly for any dt. The user's input
// comes in jerks, once per picture or mouse report, but a coupling needs a velocity.
DeviceSample PersonDevice::read(double time) noexcept
{
    PersonInput input;
    {
        const std::lock_guard lock(mutex_);
        input = input_;
        input_.moved = {};
    }
    const double dt = last_ ? std::clamp(time - *last_, 0.0, kMaxInterval) : 0.0;
    last_ = time;
    wanted_ += reach_ * input.moved + dt * speed_ * input.push.value_or(Vec3{});
    for (int k = 0; k < 3; ++k) wanted_[k] = std::clamp(wanted_[k], -kMaxTargetDistance, kMaxTargetDistance);

    const double rate = 1.0 / kTimeConstant, fade = std::exp(-rate * dt);
    const Vec3 off = hand_.pose.position - wanted_, c = hand_.velocity + rate * off;
    hand_.pose.position = wanted_ + fade * (off + dt * c);
    hand_.velocity = fade * (hand_.velocity - rate * dt * c);
    hand_.angularVelocity += (1.0 - fade) * (turnSpeed_ * input.twist.value_or(Vec3{}) - hand_.angularVelocity);
    const double angle = dt * length(hand_.angularVelocity);
    hand_.pose.orientation = normalized(axisAngle(hand_.angularVelocity, angle) * hand_.pose.orientation);
    return {hand_, input.buttons.value_or(0)};
}

} // namespace filasofia::device
