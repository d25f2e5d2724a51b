#include "filasofia/engine/constraint/constraint.h"

#include <cmath>

namespace filasofia::engine {

std::array<Vec3, 3> frameOf(Vec3 normal)
{
    const Vec3 other = std::abs(normal.x) < 0.6 ? Vec3{1.0, 0.0, 0.0} : Vec3{0.0, 1.0, 0.0};
    const Vec3 tangent = normalized(cross(normal, other));
    return {normal, tangent, cross(normal, tangent)};
}

void giveImpulse(const Constraints& constraints, std::size_t c, Vec3 impulse, std::span<Vec3> atGrips)
{
    const Constraint& constraint = constraints.list[c];
    const Vec3 all = inWorld(constraint.frame, impulse);
    for (int g = constraint.first; g < constraint.first + constraint.count; ++g) {
        const WeightedGrip& grip = constraints.grips[static_cast<std::size_t>(g)];
        atGrips[static_cast<std::size_t>(grip.grip)] += grip.weight * all;
    }
}

Projected project(const Constraint& constraint, Vec3 y) { return project(constraint, y, constraint.friction * y.x); }

Projected project(const Constraint& constraint, Vec3 y, double cone)
{
    if (constraint.friction >= 0.0 && !(y.x > 0.0)) return {};
    if (std::abs(y.x) > constraint.most) return {{std::copysign(constraint.most, y.x), 0.0, 0.0}, 0.0, false};
    if (constraint.friction < 0.0) return {y, 1.0, true};
    const double tangential = std::sqrt(y.y * y.y + y.z * y.z);
    const double slip = tangential > cone ? cone / tangential : 1.0;
    return {{y.x, slip * y.y, slip * y.z}, slip, true};
}

} // namespace filasofia::engine
