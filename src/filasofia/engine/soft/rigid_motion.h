#pragma once

#include "filasofia/math/mat3.h"

#include <cmath>

namespace filasofia::engine {

/// A rigid motion: u(x) = linear + angular x (x - centre).
struct RigidMotion {
    Vec3 centre, linear, angular;
    [[nodiscard]] Vec3 at(Vec3 x) const { return linear + cross(angular, x - centre); }
};

/// The rigid motion of `count` > 0 points with their momentum and their angular momentum; without rotation if the
/// points coincide or lie on a line. The functions massOf(i), positionOf(i) and momentumOf(i) describe point i.
template <class MassOf, class PositionOf, class MomentumOf>
RigidMotion rigidMotionOf(int count, const MassOf& massOf, const PositionOf& positionOf, const MomentumOf& momentumOf)
{
    double mass = 0.0;
    Vec3 centre, momentum, spin;
    for (int i = 0; i < count; ++i) {
        mass += massOf(i);
        centre += massOf(i) * positionOf(i);
        momentum += momentumOf(i);
    }
    centre = 1.0 / mass * centre;
    Mat3 inertia;
    for (int i = 0; i < count; ++i) {
        const Vec3 d = positionOf(i) - centre;
        spin += cross(d, momentumOf(i));
        inertia += massOf(i) * (lengthSquared(d) * Mat3::identity() - outer(d, d));
    }
    const bool solid = determinant(inertia) > 1e-9 * std::pow(trace(inertia) / 3.0, 3.0);
    return {centre, 1.0 / mass * momentum, solid ? inverse(inertia) * spin : Vec3{}};
}

} // namespace filasofia::engine
