#pragma once

#include "filasofia/math/quat.h"

namespace filasofia {

/// The position and orientation of a rigid thing: it maps the thing's coordinates to the world by rotating, then
/// translating.
struct Pose {
    Vec3 position = {};    ///< [m]
    Quat orientation = {}; ///< unit quaternion

    friend constexpr bool operator==(const Pose&, const Pose&) = default;
};

constexpr Vec3 transform(const Pose& pose, Vec3 point) { return pose.position + rotate(pose.orientation, point); }
/// Applies b first, then a: transform(a * b, p) = transform(a, transform(b, p)).
constexpr Pose operator*(const Pose& a, const Pose& b)
{
    return {transform(a, b.position), a.orientation * b.orientation};
}
constexpr Pose inverse(const Pose& pose)
{
    const Quat back = conjugate(pose.orientation);
    return {-rotate(back, pose.position), back};
}
/// Straight from `a`, at part 0, to `b`, at 1, turning the shortest way. The orientations may have any length but 0.
inline Pose between(const Pose& a, const Pose& b, double part)
{
    const Quat from = normalized(a.orientation);
    const Vec3 turn = rotationVector(conjugate(from) * normalized(b.orientation));
    return {a.position + part * (b.position - a.position), from * axisAngle(turn, part * length(turn))};
}
inline bool isFinite(const Pose& pose) { return isFinite(pose.position) && isFinite(pose.orientation); }

constexpr auto fields(const Pose*)
{
    return describe("Pose", field("position", &Pose::position, "m", finite(), "position of the origin"),
                    field("orientation", &Pose::orientation, "unit quaternion"));
}

} // namespace filasofia
