#pragma once

#include "filasofia/math/mat3.h"

#include <array>

/// What tears tissue: stress of one element, and its largest principal value. Tension is positive.
namespace filasofia::engine {

/// The largest eigenvalue of a symmetric matrix and its direction.
struct PrincipalStress {
    double value = 0.0; ///< [Pa]
    Vec3 direction;     ///< unit; its component of largest size is positive
};

/// By Jacobi's rotations (Golub and Van Loan, 8.5), in a fixed order.
PrincipalStress principalStress(const Mat3& stress);

/// [Pa] not below the largest principal stress: mean + sqrt(2/3) |deviator|, exact where two others are equal. Costs a
/// twentieth of it.
double principalStressBound(const Mat3& stress);

/// Cauchy's stress [Pa] of linear corotational elasticity: with P = 2 mu (F - R) + lambda tr(R^T F - I) R, the gradient
/// of its energy, sigma = P F^T / det F. `rotation` is the one nearest to f. Zero where f is flat or inside out: what
/// is crushed does not tear.
Mat3 cauchyStress(const Mat3& f, const Mat3& rotation, double mu, double lambda);

/// The virial stress [Pa] of a tetrahedron of springs: sigma = 1/V sum T d d^T / |d| over its six edges (in the order
/// of geometry::kTetrahedronEdges), d the edge and V the volume as they are now, T [N] the element's share of the
/// spring's tension (an equal one of all elements around the edge). Uniform strain of a network of many equal elements
/// gives the stress that a continuum in its place would have. Zero where the element is flat or inside out.
Mat3 virialStress(const std::array<Vec3, 4>& corners, const std::array<double, 6>& tensions);

} // namespace filasofia::engine
