#pragma once

#include "filasofia/engine/collision/bounds.h"
#include "filasofia/math/vec3.h"

#include <cmath>

namespace filasofia::engine {

inline constexpr float kFarthestCoordinate =
    1e9f; // [m] no larger coordinate is used, so that fourth powers stay finite

/// A box of this radius around a place.
inline Bounds boxAround(Vec3 x, float r)
{
    const FourFloats at{static_cast<float>(x.x), static_cast<float>(x.y), static_cast<float>(x.z), 0.0f};
    const FourFloats size = at < FourFloats{} ? -at : at;
    // A comparison with a NaN is false, so NaNs are rejected too.
    const auto near =
        reinterpret_cast<TwoWords>((size < kFarthestCoordinate) & (FourFloats{r, r, r, r} < kFarthestCoordinate));
    if ((near[0] & near[1]) != -1) return damagedBounds();
    // A few roundings, each by 2^-24 of the rounded value.
    const FourFloats grown = r * (1.0f + 0x1p-20f) + 1e-30f + size * 0x1p-22f;
    return {at - grown, -at - grown};
}

/// A vertex's box. It reaches as far in every direction as the speed allows, so that anything that approaches along its
/// normal is found even if the vertex moves sideways. A box around the path alone would be smaller, but would miss
/// that.
inline Bounds boundsOf(Vec3 x, Vec3 v, float depth, float reach)
{
    const float vx = static_cast<float>(v.x), vy = static_cast<float>(v.y), vz = static_cast<float>(v.z);
    return boxAround(x, depth + reach * std::sqrt(vx * vx + vy * vy + vz * vz));
}

} // namespace filasofia::engine
