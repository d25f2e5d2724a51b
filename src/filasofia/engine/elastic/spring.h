#pragma once

#include "filasofia/math/mat3.h"

#include <array>
#include <vector>

namespace filasofia::engine {

/// A spring with a dashpot between two nodes.
struct Spring {
    std::array<int, 2> nodes{};
    double restLength = 0.0; ///< [m]
    double stiffness = 0.0;  ///< [N/m]
    double damping = 0.0;    ///< [N s/m], along the spring
};

/// [N] on the first end; the second end gets the opposite. Velocities matter only where there is damping.
Vec3 springForce(const Spring& spring, Vec3 a, Vec3 b);
Vec3 dashpotForce(const Spring& spring, Vec3 a, Vec3 b, Vec3 velocityA, Vec3 velocityB);

/// [N/m] -d(force on a)/da. In compression the part across the spring is left out, so that the block is positive
/// semi-definite; in extension it is exact.
Mat3 springStiffness(const Spring& spring, Vec3 a, Vec3 b);

/// [N s/m] -d(force on a)/d(velocity of a).
Mat3 springDamping(const Spring& spring, Vec3 a, Vec3 b);

/// [J]
double springEnergy(const Spring& spring, Vec3 a, Vec3 b);

/// A spring on an edge, at rest, with the stiffness and damping of another.
Spring springOn(const std::array<int, 2>& edge, const Spring& like, const std::vector<Vec3>& rest);

} // namespace filasofia::engine
