#include "filasofia/prefab/trocar.h"

#include "filasofia/core/error.h"
#include "filasofia/core/text.h"
#include "filasofia/core/validate.h"
#include "filasofia/math/virtual_coupling.h"
#include "filasofia/prefab/hand_script.h"
#include "filasofia/prefab/trocar_shaft.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace filasofia::prefab {
namespace {

constexpr double kSealTravel = 0.2e-3; ///< [m], the seal gives by this much before the shaft slides
constexpr double kSmoothing = 0.02;    ///< [s], time constant of the force that the wall yields to
constexpr double kMostShift = 0.03;    ///< [m], the wall yields no farther

/// The axes of a trocar: it looks along -Z, +Y is up.
Quat baseOf(const TrocarDef& trocar)
{
    const Vec3 z = -normalized(trocar.axis), x = normalized(cross(trocar.up, z)), y = cross(z, x);
    Mat3 turn;
    for (int i = 0; i < 3; ++i) turn[i] = {x[i], y[i], z[i]};
    return toQuat(turn);
}

Quat turnOf(const TrocarDef& trocar, double yaw, double pitch)
{
    return baseOf(trocar) * axisAngle({0.0, 1.0, 0.0}, -yaw) * axisAngle({1.0, 0.0, 0.0}, pitch);
}

/// The smallest turn that takes one unit vector to another; they are far from opposite.
Quat turnBetween(Vec3 from, Vec3 to)
{
    const Vec3 axis = cross(from, to);
    return length(axis) < 1e-12 ? Quat{} : axisAngle(axis, std::atan2(length(axis), dot(from, to)));
}

double tiltOf(const TrocarPose& pose) { return std::acos(std::cos(pose.yaw) * std::cos(pose.pitch)); }

} // namespace

Pose pivotOf(const TrocarDef& trocar, const TrocarPose& pose)
{
    const Quat turn = turnOf(trocar, pose.yaw, pose.pitch);
    return {trocar.fulcrum + pose.insertion * rotate(turn, {0.0, 0.0, -1.0}),
            turn * axisAngle({0.0, 0.0, 1.0}, pose.roll)};
}

TrocarPose poseAt(const TrocarDef& trocar, Vec3 target, double roll, Vec3 point)
{
    TrocarPose pose{.roll = roll};
    Vec3 beside; // from the pivot to the point: it turns with the direction that is sought
    for (int i = 0; i < (point == Vec3{} ? 1 : 12); ++i) {
        const Vec3 way = target - beside - trocar.fulcrum;
        const double far = length(way);
        if (far == 0.0) fail("trocar: the pivot must not be in the fulcrum");
        const Vec3 seen = rotate(conjugate(baseOf(trocar)), (1.0 / far) * way);
        pose.yaw = std::atan2(seen.x, -seen.z);
        pose.pitch = std::asin(std::clamp(seen.y, -1.0, 1.0));
        pose.insertion = far;
        beside = rotate(pivotOf(trocar, pose).orientation, point);
    }
    return pose;
}

double rollAcross(const TrocarDef& trocar, Vec3 pivot, Vec3 across)
{
    const Vec3 seen = rotate(conjugate(pivotOf(trocar, poseAt(trocar, pivot)).orientation), across);
    const double roll = std::atan2(-seen.x, seen.y);
    constexpr double half = std::numbers::pi / 2.0;
    return roll > half ? roll - 2.0 * half : roll < -half ? roll + 2.0 * half : roll;
}

TrocarPose withinLimits(const TrocarDef& trocar, TrocarPose pose)
{
    pose.insertion = std::clamp(pose.insertion, trocar.leastInsertion, trocar.mostInsertion);
    pose.pitch = std::clamp(pose.pitch, -trocar.mostTilt, trocar.mostTilt);
    // cos(tilt) = cos(yaw) cos(pitch); the margin keeps rounding from refusing what was limited here.
    const double most = std::acos(std::min(1.0, std::cos(trocar.mostTilt) / std::cos(pose.pitch)));
    if (std::abs(pose.yaw) > most) pose.yaw = std::copysign((1.0 - 1e-9) * most, pose.yaw);
    return pose;
}

void checkLimits(const TrocarDef& trocar, const TrocarPose& pose, std::string_view object)
{
    validate(pose, object);
    if (pose.insertion < trocar.leastInsertion || pose.insertion > trocar.mostInsertion)
        fail(object, ": insertion must be in [", trocar.leastInsertion, ", ", trocar.mostInsertion, "] m, got ",
             pose.insertion);
    const double tilt = tiltOf(pose);
    if (std::abs(pose.pitch) > trocar.mostTilt || std::abs(pose.yaw) > 1.571 || tilt > trocar.mostTilt + 1e-9)
        fail(object, ": the shaft must be within mostTilt (", trocar.mostTilt, " rad) of the axis, got yaw ", pose.yaw,
             " and pitch ", pose.pitch, " rad");
}

TrocarPose between(const TrocarPose& a, const TrocarPose& b, double part)
{
    const auto mix = [part](double from, double to) { return from + part * (to - from); };
    return {mix(a.yaw, b.yaw), mix(a.pitch, b.pitch), mix(a.insertion, b.insertion), mix(a.roll, b.roll)};
}

void checkTrocar(const TrocarDef& trocar, const TrocarHandleDef& hand, const TrocarPose& start, std::string_view object)
{
    validate(trocar, text(object, ": trocar"));
    validate(hand, text(object, ": hand"));
    for (const auto& [field, v] : {std::pair{"axis", trocar.axis}, {"up", trocar.up}})
        if (!(length(v) > 0.0))
            fail(object, ": trocar.", field, " must have a length > 0, got ", v.x, " ", v.y, " ", v.z);
    if (length(cross(trocar.axis, trocar.up)) <= 1e-6 * length(trocar.axis) * length(trocar.up))
        fail(object, ": trocar.up must not be parallel to its axis");
    if (trocar.mostInsertion < trocar.leastInsertion)
        fail(object, ": trocar.mostInsertion must be >= leastInsertion (", trocar.leastInsertion, " m), got ",
             trocar.mostInsertion, " m");
    if (trocar.mostInsertion >= hand.length)
        fail(object, ": trocar.mostInsertion must be < hand.length (", hand.length, " m), got ", trocar.mostInsertion,
             " m");
    checkLimits(trocar, start, text(object, ": start"));
}

TrocarReport reportOf(const TrocarDef& trocar, double length_, const ShaftState& state, const ShaftLoad& load)
{
    const Pose told = pivotOf(trocar, state.given);
    const Vec3 aim = rotate(told.orientation, {0.0, 0.0, -1.0});
    TrocarReport out{.pose = state.given, .shift = state.shift};
    out.handle = trocar.fulcrum - (length_ - state.given.insertion) * aim;
    const Vec3 outside = trocar.fulcrum + state.shift - out.handle;
    const double lever = length(outside); // > 0: mostInsertion < length, and the shift is across
    const Vec3 now = (1.0 / lever) * outside;
    out.pivot = {out.handle + length_ * now, normalized(turnBetween(aim, now) * told.orientation)};

    // Moments about the handle, where the hand gives none: lever now x wall + moment + back = 0.
    const Vec3 moment = load.moment + cross(load.at - out.handle, load.force);
    const Vec3 axis = normalized(trocar.axis), side = cross(now, axis);
    const double sine = length(side);
    const Vec3 back = sine < 1e-9 ? Vec3{} : trocar.tiltStiffness * std::atan2(sine, dot(now, axis)) / sine * side;
    out.wall = (1.0 / lever) * cross(now, moment + back);
    const double along = dot(load.force, now);
    out.force = load.force - along * now + out.wall + (along - trocar.friction * state.seal) * now;
    out.torque = dot(moment, now);
    return out;
}

void step(const TrocarDef& trocar, const TrocarHandleDef& hand, const TrocarPose& wanted, const ShaftLoad& load,
          double dt, ShaftState& state)
{
    const TrocarReport before = reportOf(trocar, hand.length, state, load);
    const TrocarPose from = state.given;
    state.given = wanted;
    if (std::isfinite(hand.strength)) {
        const TrocarReport there = reportOf(trocar, hand.length, state, load);
        const Vec3 moved = there.handle - before.handle;
        const double way = std::max(length(moved), distance(there.pivot.position, before.pivot.position));
        if (dot(before.force, moved) < 0.0 && length(before.force) > hand.strength)
            state.given = from;
        else if (way > kMaxHandSpeed * dt)
            state.given = between(from, wanted, kMaxHandSpeed * dt / way);
    }
    state.seal = std::clamp(state.seal + (state.given.insertion - from.insertion) / kSealTravel, -1.0, 1.0);
    if (!std::isfinite(trocar.wallStiffness)) return;
    // damping d(shift)/dt = pressed - stiffness shift, exact for a load that does not change within the step.
    state.pressed += (1.0 - std::exp(-dt / kSmoothing)) * (-before.wall - state.pressed);
    const Vec3 rest = (1.0 / trocar.wallStiffness) * state.pressed;
    Vec3 by = (1.0 - std::exp(-dt * trocar.wallStiffness / trocar.wallDamping)) * (rest - state.shift);
    by = limitFactor(length(by), kMaxHandSpeed * dt) * by;
    state.shift += by;
    state.shift = limitFactor(length(state.shift), kMostShift) * state.shift;
}

} // namespace filasofia::prefab
