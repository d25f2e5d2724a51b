#pragma once

#include "filasofia/engine/elastic/element.h"
#include "filasofia/physics/elastic_law.h"

/// Isotropic laws by their energy as a function of the principal stretches (elastic/laws), in double. They share one
/// tangent: the exact one in the axes of the stretches, with the magnitudes of its eigenvalues. The corotational and
/// the neo-Hookean law have such a response too, but the step uses their own faster forms.
namespace filasofia::engine {

/// [J/m^3]
double stretchEnergy(const physics::ElasticLaw& law, Lame material, const Deformation& at);

/// [Pa] first Piola-Kirchhoff stress
Mat3 stretchStress(const physics::ElasticLaw& law, Lame material, const Deformation& at);

/// [-] The cube of i1, the first invariant at constant volume, as the laws see it: with J bounded below. No root is
/// taken, because steps ask this of every element of tissue whose law has a limit (physics::rangeOf).
double cubedInvariant(const Mat3& f);

/// In the axes u and v of the stretches, F = u diag(s) v^T: with dF = u h v^T and dP = u p v^T,
///     p_ii = sum_j a_ij h_jj,   p_ij = ahead_k h_ij + across_k h_ji   for i, j and k different.
struct StretchTangent {
    Mat3 u, v;
    Mat3 a;             ///< [Pa]
    Vec3 ahead, across; ///< [Pa]
};
StretchTangent stretchTangent(const physics::ElasticLaw& law, Lame material, const Deformation& at, double turning);

/// dP for a change dF [Pa].
Mat3 stressChange(const StretchTangent& tangent, const Mat3& df);
/// dP g_i as a matrix times dx_j, for dF = dx_j g_j^T [Pa/m^2].
Mat3 stiffnessBlock(const StretchTangent& tangent, Vec3 gi, Vec3 gj);

} // namespace filasofia::engine
