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

double coneOf(const ConstraintLaw& law, Vec3 impulse)
{
    if (law.kind == ConstraintKind::Shaft) return law.maxImpulse;
    return law.bilateral() ? 0.0 : std::max(0.0, law.friction * impulse.x);
}

Vec3 sharesOf(const ConstraintLaw& law, const Projected& state)
{
    if (!state.active) return {};
    if (law.kind == ConstraintKind::ClipLeg) return {1.0, law.across, law.across};
    return law.kind == ConstraintKind::Shaft ? Vec3{state.slip, 1.0, 1.0} : Vec3{1.0, state.slip, state.slip};
}

Vec3 linearised(const ConstraintLaw& law, const Projected& state, Vec3 y)
{
    if (!state.active) return state.impulse;
    const Vec3 scaled = times(sharesOf(law, state), y);
    const bool slides = law.kind == ConstraintKind::Shaft && state.slip == 0.0;
    return slides ? Vec3{state.impulse.x, scaled.y, scaled.z} : scaled;
}

Projected project(const ConstraintLaw& law, Vec3 y) { return project(law, y, coneOf(law, y)); }

Projected project(const ConstraintLaw& law, Vec3 y, double cone)
{
    if (law.kind == ConstraintKind::Shaft) {
        const bool slides = std::abs(y.x) > cone;
        return {{slides ? std::copysign(cone, y.x) : y.x, y.y, y.z}, slides ? 0.0 : 1.0, true};
    }
    if (law.kind == ConstraintKind::ClipLeg) return {{y.x, law.across * y.y, law.across * y.z}, 1.0, true};
    if (!law.bilateral() && !(y.x > 0.0)) return {};
    if (std::abs(y.x) > law.maxImpulse) return {{std::copysign(law.maxImpulse, y.x), 0.0, 0.0}, 0.0, false};
    if (law.bilateral()) return {y, 1.0, true};
    const double tangential = std::sqrt(y.y * y.y + y.z * y.z);
    const double slip = tangential > cone ? cone / tangential : 1.0;
    return {{y.x, slip * y.y, slip * y.z}, slip, true};
}

} // namespace filasofia::engine
