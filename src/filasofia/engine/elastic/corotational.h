#pragma once

#include "filasofia/engine/elastic/element.h"

/// Corotational elasticity (Mueller and Gross 2004, with the polar rotation).
///
/// With the deformation gradient F = sum x_i g_i^T and its nearest rotation R, the energy per volume is
///     W = mu |F - R|^2 + lambda/2 tr(R^T F - I)^2
/// and, because R maximises tr(R^T F), its gradient needs no derivative of R:
///     P = 2 mu (F - R) + lambda tr(R^T F - I) R.
namespace filasofia::engine {

/// Lame's parameters of an element at the deformation gradient f. If the element is inverted (det f < 0), lambda is
/// zero and only shear is left: the volumetric energy does not tell an element from its mirror image, and would hold up
/// knots of inverted elements that shear alone resolves. The energy jumps at det f = 0; on either side the stress is
/// its gradient.
Lame lameAt(Lame material, const Mat3& f);

/// [J/m^3]
double corotationalEnergy(Lame material, const Deformation& at);

/// [Pa] first Piola-Kirchhoff stress
Mat3 corotationalStress(Lame material, const Deformation& at);

/// [-] Minimum of det(tr(S) I - S) / tr(S)^3. It bounds the geometric stiffness of needle-shaped elements.
constexpr double kFlattest = 0.01;

/// The stiffness that tension adds to an element against rotation [Pa]: mu (1 + (q - 2) / h) if q > 2 and tr(S - I) >
/// kTense, otherwise 0, with S = R^T F and q = lambda / mu tr(S - I).
///
/// The warped stiffness leaves out the rotational part of the energy's second derivative, that of the antisymmetric
/// part of R^T dF: 2 mu (1 + (q - 2) / h_k) for the three sums h_k of two stretches. Under pressure this is negative,
/// and up to q = 2 it is at most 2 mu. Beyond q = 2 it has no bound, and a step that neglects it gains energy: pieces
/// torn off a body spun faster and faster until they tore to shreds. One h for all three, det(tr(S) I - S) / tr(S)^2,
/// makes the result an upper bound.
double geometricStiffness(Lame material, const Deformation& at);

/// The warped stiffness R K R^T: Hooke's law in the frame of R, and `turning` against rotation within the step. It is
/// positive semi-definite, and without `turning` it is exact at every rotated rest shape.
struct WarpedTangent {
    Lame material; ///< of lameAt()
    Mat3 rotation;
    double turning = 0.0; ///< [Pa] geometric stiffness
};
/// `turning` [-] weighs the geometric stiffness.
WarpedTangent corotationalTangent(Lame material, const Deformation& at, double turning);

/// dP for a change dF [Pa].
Mat3 stressChange(const WarpedTangent& tangent, const Mat3& df);
/// dP g_i as a matrix times dx_j, for dF = dx_j g_j^T [Pa/m^2]: times the volume, the stiffness between two nodes.
Mat3 stiffnessBlock(const WarpedTangent& tangent, Vec3 gi, Vec3 gj);

/// dP with the derivative of R, exact. For tests and analysis.
Mat3 exactCorotationalChange(Lame material, const Deformation& at, const Mat3& df);

} // namespace filasofia::engine
