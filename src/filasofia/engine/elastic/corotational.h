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

/// The constants of an element. Only an edit of the mesh or of its material changes them.
struct FemElement {
    std::array<int, 4> nodes{};
    std::array<Vec3, 4> gradients{}; ///< [1/m] gradients of the shape functions at rest; they sum to zero
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

/// Lame's parameters of an element at the deformation gradient f. If the element is inverted (det f < 0), lambda is
/// zero and only shear is left: the volumetric energy does not tell an element from its mirror image, and would hold up
/// knots of inverted elements that shear alone resolves. The energy jumps at det f = 0; on either side the forces are
/// its gradient.
Lame lameAt(const FemElement& element, const Mat3& f);

using Corners = std::array<Vec3, 4>; ///< one vector per node of a tetrahedron

/// The gradients of the four shape functions of a tetrahedron of positive volume.
Corners shapeGradients(const Corners& rest);

/// sum x_i g_i^T: the deformation gradient for positions, the velocity gradient for velocities.
Mat3 gradient(const FemElement& element, const Corners& x);

/// [J]
double corotationalEnergy(const FemElement& element, const Mat3& f, const Mat3& rotation);

/// [N] forces on the four nodes: minus the gradient of the energy.
Corners corotationalForces(const FemElement& element, const Mat3& f, const Mat3& rotation);

/// [-] geometricStiffness() is zero up to this tr(S - I). An element that turns by w in a step grows by w^2. If it is
/// nearly incompressible, that looks like tension, and the stiffness would brake the turn.
constexpr double kTense = 0.1;
/// [-] Minimum of det(tr(S) I - S) / tr(S)^3. It bounds the geometric stiffness of needle-shaped elements.
constexpr double kFlattest = 0.01;

/// The coefficients of an element's linearisation in a step.
struct Tangent {
    Lame material;
    double turning = 0.0; ///< [Pa] geometric stiffness: resists rotation within the step
};

/// The stiffness that tension adds to an element against rotation [Pa]: mu (1 + (q - 2) / h) if q > 2 and tr(S - I) >
/// kTense, otherwise 0, with S = R^T F and q = lambda / mu tr(S - I).
///
/// The warped stiffness leaves out the rotational part of the energy's second derivative, that of the antisymmetric
/// part of R^T dF: 2 mu (1 + (q - 2) / h_k) for the three sums h_k of two stretches. Under pressure this is negative,
/// and up to q = 2 it is at most 2 mu. Beyond q = 2 it has no bound, and a step that neglects it gains energy: pieces
/// torn off a body spun faster and faster until they tore to shreds. One h for all three, det(tr(S) I - S) / tr(S)^2,
/// makes the result an upper bound.
double geometricStiffness(Lame material, const Mat3& f, const Mat3& rotation);

/// The warped stiffness R K R^T times four vectors [m] -> [N]. It is positive semi-definite, and without `turning` it
/// is exact at every rotated rest shape.
Corners warpedStiffnessTimes(const FemElement& element, const Tangent& tangent, const Mat3& rotation, const Corners& x);

/// Block (i, j) of the warped stiffness [N/m]; `rotated` are the gradients rotated by R.
Mat3 warpedStiffnessBlock(const Corners& rotated, const Tangent& tangent, double volume, int i, int j);

/// The exact change of the forces for a change dx of the positions, with the derivative of R. For tests and analysis.
Corners exactForceChange(const FemElement& element, const Mat3& f, const Mat3& rotation, const Corners& dx);

} // namespace filasofia::engine
