#pragma once

#include "filasofia/math/mat3.h"

#include <array>
#include <vector>

namespace filasofia::engine {

/// A spring with a dashpot between two nodes, a and b.
///
///     C = |b - a| - restLength,   J = [-d^T, d^T],   d = (b - a) / |b - a|
///     force on a:  stiffness * C * d + damping * ((v_b - v_a) . d) * d
struct Spring {
    std::array<int, 2> nodes{};
    double restLength = 0.0; ///< [m]
    double stiffness = 0.0;  ///< [N/m]
    double damping = 0.0;    ///< [N s/m], along the spring
};

/// [N] forces on the first end; the second end gets the opposite. Only the dashpot depends on velocities.
Vec3 springForce(const Spring& spring, Vec3 a, Vec3 b);
Vec3 dashpotForce(const Spring& spring, Vec3 a, Vec3 b, Vec3 velocityA, Vec3 velocityB);

/// [N/m] -d(force on a)/da. If the spring is compressed, the part across it is left out, so that the block is positive
/// semi-definite; if it is stretched, the block is exact.
Mat3 springStiffness(const Spring& spring, Vec3 a, Vec3 b);

/// [N s/m] -d(force on a)/d(velocity of a).
Mat3 springDamping(const Spring& spring, Vec3 a, Vec3 b);

/// [J]
double springEnergy(const Spring& spring, Vec3 a, Vec3 b);

/// A spring along an edge, with the edge's rest length and the stiffness and damping of `like`.
Spring springOn(const std::array<int, 2>& edge, const Spring& like, const std::vector<Vec3>& rest);

} // namespace filasofia::engine
