#pragma once

#include "filasofia/math/vec3.h"
#include "filasofia/physics/defs.h"

#include <cmath>
#include <span>

namespace filasofia::engine {

/// True if every component is finite and its magnitude is below physics::kFarthest.
inline bool usable(std::span<const Vec3> values)
{
    constexpr double far = physics::kFarthest;
    for (const Vec3& v : values)
        if (!(std::abs(v.x) < far && std::abs(v.y) < far && std::abs(v.z) < far)) return false;
    return true;
}

} // namespace filasofia::engine
