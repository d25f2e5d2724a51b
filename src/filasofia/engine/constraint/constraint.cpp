#include "filasofia/engine/constraint/constraint.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {

std::array<Vec3, 3> frameOf(Vec3 normal)
{
    const Vec3 other = std::abs(normal.x) < 0.6 ? Vec3{1.0, 0.0, 0.0} : Vec3{0.0, 1.0, 0.0};
    const Vec3 tangent = normalized(cross(normal, other));
    return {normal, tangent, cross(normal, tangent)};
}

void addImpulse(const ConstraintRows& rows, std::size_t c, Vec3 impulse, std::span<Vec3> atPoints)
{
    const ConstraintRow& row = rows.list[c];
    const Vec3 world = inWorld(row.constraint->frame, impulse);
    for (const WeightedPoint& each : rows.pointsOf(row))
        atPoints[static_cast<std::size_t>(each.point)] += each.weight * world;
}

double coneOf(const Constraint& constraint, Vec3 impulse)
{
    if (constraint.kind == ConstraintKind::Shaft) return constraint.maxImpulse;
    return constraint.bilateral() ? 0.0 : std::max(0.0, constraint.friction * impulse.x);
}

Vec3 sharesOf(const Constraint& constraint, const Projected& state)
{
    if (!state.active) return {};
    return constraint.kind == ConstraintKind::Shaft ? Vec3{state.slip, 1.0, 1.0} : Vec3{1.0, state.slip, state.slip};
}

Vec3 linearised(const Constraint& constraint, const Projected& state, Vec3 y)
{
    if (!state.active) return state.impulse;
    const Vec3 scaled = times(sharesOf(constraint, state), y);
    const bool slides = constraint.kind == ConstraintKind::Shaft && state.slip == 0.0;
    return slides ? Vec3{state.impulse.x, scaled.y, scaled.z} : scaled;
}

Projected project(const Constraint& constraint, Vec3 y) { return project(constraint, y, coneOf(constraint, y)); }

Projected project(const Constraint& constraint, Vec3 y, double cone)
{
    if (constraint.kind == ConstraintKind::Shaft) {
        const bool slides = std::abs(y.x) > cone;
        return {{slides ? std::copysign(cone, y.x) : y.x, y.y, y.z}, slides ? 0.0 : 1.0, true};
    }
    if (!constraint.bilateral() && !(y.x > 0.0)) return {};
    if (std::abs(y.x) > constraint.maxImpulse)
        return {{std::copysign(constraint.maxImpulse, y.x), 0.0, 0.0}, 0.0, false};
    if (constraint.bilateral()) return {y, 1.0, true};
    const double tangential = std::sqrt(y.y * y.y + y.z * y.z);
    const double slip = tangential > cone ? cone / tangential : 1.0;
    return {{y.x, slip * y.y, slip * y.z}, slip, true};
}

} // namespace filasofia::engine
