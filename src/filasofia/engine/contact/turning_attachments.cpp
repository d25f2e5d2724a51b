#include "filasofia/engine/contact/turning_attachments.h"

#include "filasofia/math/quat.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

constexpr double kLargestHeldTurn = 1.5; ///< [rad] in a step; beyond it, where a point comes is foreseen less far
constexpr double kForeseen = 2e-5;       ///< [m] how far a point may come to be from where it was foreseen
constexpr double kTold = 1e-4;           ///< [m] beyond which that is told

/// [m] The arm at which a body that turns by `turn` [rad] has the mean velocity of a point: turn x arm leads along the
/// chord of the arc on which the point goes, and not along the tangent at its start.
Vec3 armOfChord(Vec3 turn, Vec3 arm)
{
    const double angle = std::min(length(turn), kLargestHeldTurn), half = 0.5 * angle;
    if (half < 1e-6) return arm;
    const Vec3 axis = normalized(turn), along = dot(arm, axis) * axis;
    return along + std::sin(half) / half * rotate(axisAngle(axis, half), arm - along);
}

/// [rad] by which an element turns in a step, as planned
Vec3 turnOf(double dt, const RigidPlanElement& planned)
{
    return dt * (planned.angularVelocity + planned.change.angular);
}

/// [kg m^2] A force turns a body back as it turns: the derivative of the torque arm x force is a stiffness, here less
/// what turns the body on (Tournier, Nesme, Gilles and Faure 2015, geometric stiffness). In a step it acts as inertia;
/// returned is what exceeds `own`, since below that a step is stable without.
Mat3 turningInertia(double dt, Vec3 arm, Vec3 impulse, double own)
{
    const double size = length(arm) * length(impulse), pull = dot(arm, impulse);
    if (!(dt * size > own)) return {};
    const auto beyond = [&](double stiffness) { return std::max(0.0, dt * stiffness - own); };
    const Vec3 first = normalized(arm), second = normalized(impulse), normal = cross(first, second);
    if (length(normal) < 1e-9) return beyond(pull) * (Mat3::identity() - outer(first, first));
    const Vec3 across = normalized(normal), along = cross(across, normalized(first + second));
    return beyond(0.5 * (pull + size)) * outer(along, along) + beyond(pull) * outer(across, across);
}

bool isFree(const Coupling& coupling, const BodyPoint& side)
{
    return side.of == BodyPoint::Of::Rigid && coupling.rigid[side.body].dynamic &&
           coupling.rigid[side.body].articulation < 0;
}

/// [m] How far a free body now carries the point from where its constraint foresees it.
double strays(double dt, const Coupling& coupling, const BodyPoint& point)
{
    if (!isFree(coupling, point)) return 0.0;
    const RigidPlanElement& planned = coupling.rigid[point.body];
    const Vec3 turn = turnOf(dt, planned), arm = point.position - planned.centre;
    return length(cross(turn, armOfChord(turn, arm) - arm - point.shift));
}

bool straysBeyond(double dt, const Coupling& coupling, const Constraint& weld, double most)
{
    return std::ranges::any_of(weld.sides, [&](const BodyPoint& side) { return strays(dt, coupling, side) > most; });
}

} // namespace

void foreseeArc(double dt, const RigidPlanElement& planned, BodyPoint& point, double share)
{
    const Vec3 arm = point.position - planned.centre, whole = armOfChord(turnOf(dt, planned), arm);
    const Vec3 foreseen = share < 1.0 ? arm + point.shift + share * (whole - arm - point.shift) : whole;
    point.shift = foreseen - arm;
    point.velocity = planned.velocity + planned.beyond + cross(planned.angularVelocity, foreseen);
}

bool foreseeTurns(double dt, double share, Coupling& coupling)
{
    if (std::ranges::none_of(coupling.welds(),
                             [&](const Constraint& weld) { return straysBeyond(dt, coupling, weld, kForeseen); }))
        return false;
    for (Constraint& weld : std::span(coupling.constraints).subspan(coupling.contactCount, coupling.weldCount))
        for (BodyPoint& side : weld.sides)
            if (isFree(coupling, side)) foreseeArc(dt, coupling.rigid[side.body], side, share);
    return true;
}

std::vector<std::size_t> heldElsewhere(double dt, const Coupling& coupling)
{
    std::vector<std::size_t> bodies;
    for (const Constraint& weld : coupling.welds()) {
        if (!straysBeyond(dt, coupling, weld, kTold)) continue;
        for (const BodyPoint& side : weld.sides)
            if (side.of == BodyPoint::Of::Soft) bodies.push_back(side.body);
    }
    return bodies;
}

void addHeldInertia(double dt, const Constraint& weld, RigidPlan& plan)
{
    const BodyPoint& point = weld.sides[1];
    if (weld.sides[0].of != BodyPoint::Of::Soft || point.of != BodyPoint::Of::Rigid) return;
    RigidPlanElement& element = plan[point.body];
    if (!element.dynamic || element.articulation >= 0) return;
    const double sum = trace(element.inertia), least = 4.0 * determinant(element.inertia) / (sum * sum);
    element.heldInertia += turningInertia(dt, point.position - element.centre, -weld.impulse, least);
}

} // namespace filasofia::engine
