#pragma once

#include "filasofia/math/quat.h"

#include <array>

/// One linear tetrahedron of corotational elasticity (Mueller and Gross 2004, with the polar rotation).
///
/// With the deformation gradient F = sum x_i g_i^T and its nearest rotation R, the energy is
///     W = V ( mu |F - R|^2 + lambda/2 tr(R^T F - I)^2 )
/// and, because R maximises tr(R^T F), its gradient needs no derivative of R:
///     dW/dF = V ( 2 mu (F - R) + lambda tr(R^T F - I) R ).
namespace filasofia::engine {

/// What never changes of an element but by an edit of the mesh or of its material.
struct FemElement {
    std::array<int, 4> nodes{};
    std::array<Vec3, 4> gradients{}; ///< [1/m] of the shape functions at rest; they sum to zero
    double volume = 0.0;             ///< [m^3] at rest
    double youngModulus = 0.0;       ///< [Pa]
    double poissonRatio = 0.0;       ///< [-]
};

/// Lame's parameters.
struct Lame {
    double mu = 0.0;     ///< [Pa]
    double lambda = 0.0; ///< [Pa]
};

constexpr Lame lame(double youngModulus, double poissonRatio)
{
    return {youngModulus / (2.0 * (1.0 + poissonRatio)),
            youngModulus * poissonRatio / ((1.0 + poissonRatio) * (1.0 - 2.0 * poissonRatio))};
}

/// Lame's parameters of an element at the deformation gradient f. Inside out (det f < 0) it has no lambda, only shear:
/// the volumetric energy tells nothing from its mirror image there, and would hold up knots of inverted elements that
/// shear alone resolves. The energy jumps at det f = 0; on either side the forces are its gradient.
Lame lameAt(const FemElement& element, const Mat3& f);

using Corners = std::array<Vec3, 4>; ///< one vector per node of a tetrahedron

/// Gradients of the four shape functions of a tetrahedron of positive volume.
Corners shapeGradients(const Corners& rest);

/// sum x_i g_i^T: the deformation gradient for positions, the velocity gradient for velocities.
Mat3 gradient(const FemElement& element, const Corners& x);

/// [J]
double corotationalEnergy(const FemElement& element, const Mat3& f, const Mat3& rotation);

/// [N] on the four nodes: minus the gradient of the energy.
Corners corotationalForces(const FemElement& element, const Mat3& f, const Mat3& rotation);

/// The warped stiffness R K R^T times four vectors [m] -> [N]: positive semi-definite, and exact at every rotated rest
/// shape. This is what a step linearises with.
Corners warpedStiffnessTimes(const FemElement& element, Lame material, const Mat3& rotation, const Corners& x);

/// Block (i, j) of the warped stiffness [N/m]; `rotated` are the gradients turned by R.
Mat3 warpedStiffnessBlock(const Corners& rotated, Lame material, double volume, int i, int j);

/// The exact change of the forces for a change dx of the positions, with the derivative of R: for tests and analysis.
Corners exactForceChange(const FemElement& element, const Mat3& f, const Mat3& rotation, const Corners& dx);

} // namespace filasofia::engine
