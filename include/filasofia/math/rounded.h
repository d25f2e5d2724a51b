#pragma once

#include "filasofia/math/pose.h"

#include <cmath>

/// Numbers rounded to fewer decimal digits, for values that change at every step: a recording writes digits, and those
/// of a rounded pose are a third as many. Nobody feels 0.1 um.
namespace filasofia {

/// Rounds to a multiple of 1 / perUnit.
inline double rounded(double value, double perUnit) { return std::round(value * perUnit) / perUnit; }
inline Vec3 rounded(Vec3 v, double perUnit)
{
    return {rounded(v.x, perUnit), rounded(v.y, perUnit), rounded(v.z, perUnit)};
}
/// Rounds the largest value that a message allows or advises, > 0, down to four significant digits, for a person to
/// read and type. It may be larger than the value by 1e-9 of that, which is rounding: 999.9999999999922 is 1000.
inline double advised(double most)
{
    const double unit = std::pow(10.0, std::floor(std::log10(most)) - 3.0),
                 digits = std::floor((1.0 + 1e-9) * most / unit);
    return unit < 1.0 ? digits / std::round(1.0 / unit) : digits * unit;
}
/// Rounds the position to 0.1 um and the components of the orientation to 1e-6. The quaternion's length is then 1 only
/// to within 1e-6, so the receiver must normalise it, as setPose() does.
inline Pose rounded(const Pose& pose)
{
    constexpr double kPlace = 1e7, kTurn = 1e6;
    const Quat& q = pose.orientation;
    return {rounded(pose.position, kPlace),
            {rounded(q.w, kTurn), rounded(q.x, kTurn), rounded(q.y, kTurn), rounded(q.z, kTurn)}};
}

} // namespace filasofia
