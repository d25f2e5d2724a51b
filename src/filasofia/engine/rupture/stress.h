#pragma once

#include "filasofia/math/mat3.h"

#include <array>

/// Criterion for tearing: the stress of one element and its largest principal value. Tension is positive.
namespace filasofia::engine {

/// The largest eigenvalue of a symmetric matrix and its direction.
struct PrincipalStress {
    double value = 0.0; ///< [Pa]
    Vec3 direction;     ///< unit; its component of largest size is positive
};

/// Jacobi rotations (Golub and Van Loan, 8.5) in a fixed order.
PrincipalStress principalStress(const Mat3& stress);

/// [Pa] Upper bound of the largest principal stress: mean + sqrt(2/3) |deviator|, exact if the other two are equal. It
/// costs a twentieth of principalStress().
double principalStressBound(const Mat3& stress);

/// Virial stress [Pa] of a tetrahedron of springs: sigma = 1/V sum T d d^T / |d| over its six edges (in the order of
/// geometry::kTetrahedronEdges). d is the edge, V the current volume, and T [N] the element's part of the spring's
/// tension (divided equally among the elements around the edge). Under uniform strain a network of many equal elements
/// gets the stress of the continuum that it replaces. Zero if the element is flat or inverted.
Mat3 virialStress(const std::array<Vec3, 4>& corners, const std::array<double, 6>& tensions);

} // namespace filasofia::engine
