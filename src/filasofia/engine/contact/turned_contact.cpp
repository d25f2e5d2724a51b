#include "filasofia/engine/contact/turned_contact.h"

#include "filasofia/math/quat.h"

#include <algorithm>
#include <array>

namespace filasofia::engine {
namespace {

// [-] The part of the way to where points come down that contacts are shifted by; with all of it, one ball of 200 that
// roll and tumble gained a sixth of its energy in two seconds.
constexpr double kForesight = 0.9;
constexpr double kLargestTurn = 0.15; ///< [rad] in a step; beyond it, points are foreseen less far

} // namespace

void turnContact(double dt, const RigidPlan& plan, const std::array<Vec3, 2>& arms, Constraint& contact)
{
    const auto isRigid = [](const BodyPoint& point) { return point.of == BodyPoint::Of::Rigid; };
    std::array<Vec3, 2> angles, cores, moved; // [rad], [m], [m]
    for (std::size_t side = 0; side < 2; ++side) {
        if (!isRigid(contact.sides[side])) continue;
        const RigidPlanElement& element = plan[contact.sides[side].body];
        const double angle = dt * length(element.angularVelocity);
        angles[side] = (angle > kLargestTurn ? kLargestTurn / angle : 1.0) * dt * element.angularVelocity;
        cores[side] = contact.sides[side].position - arms[side] - element.centre;
        moved[side] = rotate(axisAngle(angles[side], length(angles[side])), cores[side]) - cores[side];
    }
    const bool bothRigid = std::ranges::all_of(contact.sides, isRigid);
    const Vec3 more = lengthSquared(moved[0]) >= lengthSquared(moved[1]) ? moved[0] : moved[1];
    const double fall = dot(contact.frame[0], moved[1] - moved[0]), gap = contact.contact.gap;
    const double foreseen = bothRigid && gap > 0.0 && fall > 0.0 ? std::min(1.0, gap / fall) : 0.0;
    const Vec3 shift = foreseen * kForesight * more;
    for (std::size_t side = 0; side < 2; ++side) {
        BodyPoint& point = contact.sides[side];
        if (!isRigid(point)) continue;
        const RigidPlanElement& element = plan[point.body];
        point.shift = shift;
        point.velocity += cross(element.angularVelocity, shift);
        const Vec3 beyond = moved[side] - cross(angles[side], cores[side] + shift);
        const double sign = side == 0 ? 1.0 : -1.0;
        if (bothRigid) contact.contact.turning += sign * dot(contact.frame[0], beyond);
        contact.contact.sliding += sign * (1.0 / dt * beyond + element.beyond);
    }
}

} // namespace filasofia::engine
