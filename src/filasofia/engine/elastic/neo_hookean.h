#pragma once

#include "filasofia/engine/elastic/element.h"

/// The neo-Hookean law of textbooks (Bonet and Wood 2008, section 6.4.3, with another term of lambda), made stable for
/// every deformation:
///     W = mu/2 (i(|F|^2) - 3) - mu l(J) + lambda/2 (J - 1)^2, J = det F
///     P = mu i' F + p C, C = cof F = dJ/dF, p = lambda (J - 1) - mu l'
///     dP = mu i' dF + (lambda - mu l'') (C : dF) C + p dC
/// l = ln J down to J = 0.2, below it goes on along its parabola. i(I) = I down to I = 1, which is 3 at rest; below,
/// i = (I^2 + 1) / 2, so that an element that is shrunk in all directions grows again: with i = I a point would be a
/// minimum of the energy. So nothing in the law is singular, also if the element is flat or inside out.
///
/// Smith, de Goes and Kim (2018) have mu (J - 1) - mu/2 (J - 1)^2 for l, which is the same up to the second order. But
/// under pressure tissue of a low Poisson's ratio then loses its strength: with nu = 0 it is flat at half of its
/// height.
namespace filasofia::engine {

/// [J/m^3]
double neoHookeanEnergy(Lame material, const Mat3& f);

/// [Pa] first Piola-Kirchhoff stress
Mat3 neoHookeanStress(Lame material, const Mat3& f);

/// dP = shear dF + bulk (C : dF) C + twist dC.
struct NeoHookeanTangent {
    Mat3 f, cofactor;
    double shear = 0.0; ///< [Pa]
    double bulk = 0.0;  ///< [Pa]
    double twist = 0.0; ///< [Pa]
};

/// [-] By how much shear must outweigh the twist of an element in tension.
constexpr double kTwistCovered = 1.4142136;

/// A positive semi-definite tangent: exact at every rotated rest shape, and in tension (J - 1 > kTense) of tissue with
/// nu >= 0.45 never below the exact one. With the largest stretch s, bounded from R^T F, the twist of pressure is
/// limited to -mu / s or less: without a Poisson's ratio, one mode at a uniaxial stretch of 1.5 is softer by 5 % for
/// that. The twist of tension is covered by more shear. `turning` [-] weighs what exceeds the least twist: the part by
/// which stress resists rotation.
NeoHookeanTangent neoHookeanTangent(Lame material, const Deformation& at, double turning);

/// dP for a change dF [Pa].
Mat3 stressChange(const NeoHookeanTangent& tangent, const Mat3& df);
/// dP g_i as a matrix times dx_j, for dF = dx_j g_j^T [Pa/m^2].
Mat3 stiffnessBlock(const NeoHookeanTangent& tangent, Vec3 gi, Vec3 gj);

} // namespace filasofia::engine
