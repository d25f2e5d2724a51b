#pragma once

#include "filasofia/engine/elastic/corotational.h"
#include "filasofia/engine/elastic/neo_hookean.h"
#include "filasofia/engine/elastic/stretch_law.h"

#include <variant>

/// An elastic law, whichever it is: what the parts of the engine that compute in double ask of it. The solver in float
/// asks element_blocks.h.
namespace filasofia::engine {

/// The energy per volume [J/m^3].
double energyDensity(const physics::ElasticLaw& law, Lame material, const Deformation& at);

/// First Piola-Kirchhoff stress [Pa], the derivative of the energy density by F.
Mat3 stressAt(const physics::ElasticLaw& law, Lame material, const Deformation& at);

/// Cauchy stress [Pa], P F^T / det F. Zero if f is flat or inverted: crushed tissue does not tear.
Mat3 cauchyStress(const Mat3& stress, const Mat3& f);
Mat3 cauchyStress(const physics::ElasticLaw& law, Lame material, const Deformation& at);

/// The derivative of the stress by F as a step uses it: positive semi-definite, and exact at every rotated rest shape.
using ElementTangent = std::variant<WarpedTangent, NeoHookeanTangent, StretchTangent>;

/// `turning` [-] weighs the geometric stiffness, by which stress resists rotation: ImplicitWeights::turning in the
/// matrix, 0 for Rayleigh damping.
ElementTangent tangentAt(const physics::ElasticLaw& law, Lame material, const Deformation& at, double turning);

/// dP for a change dF [Pa].
Mat3 stressChange(const ElementTangent& tangent, const Mat3& df);

/// dP g_i as a matrix times dx_j, for dF = dx_j g_j^T [Pa/m^2]: times the volume, the stiffness between two nodes.
Mat3 stiffnessBlock(const ElementTangent& tangent, Vec3 gi, Vec3 gj);

/// [N] K x for four vectors [m].
Corners stiffnessTimes(const ElementTangent& tangent, const FemElement& element, const Corners& x);

} // namespace filasofia::engine
