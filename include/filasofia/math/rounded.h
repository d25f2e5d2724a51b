#pragma once

#include "filasofia/math/pose.h"

#include <cmath>

/// Numbers with fewer decimal digits, for what moves at every step: a recording writes digits, and those of a pose are
/// a third then. Nobody's hand feels 0.1 um.
namespace filasofia {

/// To a whole number of 1 / perUnit.
inline double rounded(double value, double perUnit) { return std::round(value * perUnit) / perUnit; }
inline Vec3 rounded(Vec3 v, double perUnit)
{
    return {rounded(v.x, perUnit), rounded(v.y, perUnit), rounded(v.z, perUnit)};
}
/// The place to 0.1 um, the orientation to 1e-6. That is no longer of unit length but for 1e-6: who takes it must make
/// it so, as setPose() does.
inline Pose rounded(const Pose& pose)
{
    constexpr double kPlace = 1e7, kTurn = 1e6;
    const Quat& q = pose.orientation;
    return {rounded(pose.position, kPlace),
            {rounded(q.w, kTurn), rounded(q.x, kTurn), rounded(q.y, kTurn), rounded(q.z, kTurn)}};
}

} // namespace filasofia
