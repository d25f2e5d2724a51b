#pragma once

#include "filasofia/engine/elastic/element.h"
#include "filasofia/physics/tissue_region.h"

/// Families of fibres (physics::FibreFamily) in double. With H the structure tensor, E = H : C - 1 and S = F H:
///     P = 2 W' S,   dP = 2 W' dF H + 4 W'' (S : dF) S
namespace filasofia::engine {

/// H, from a unit direction at rest; zero if that is zero: no fibre.
Mat3 structureTensor(double dispersion, Vec3 direction);

/// [J/m^3]
double fibreEnergy(const physics::FibreFamily& family, Vec3 direction, const Mat3& f);

/// First Piola-Kirchhoff stress [Pa].
Mat3 fibreStress(const physics::FibreFamily& family, Vec3 direction, const Mat3& f);

/// The derivative of the stress. The first term is the geometric stiffness.
struct FibreTangent {
    Mat3 structure;         ///< H
    Mat3 s;                 ///< F H
    double turning = 0.0;   ///< [Pa] 2 W'
    double stiffness = 0.0; ///< [Pa] 4 W''
};
/// `turning` [-] weighs the geometric stiffness.
FibreTangent fibreTangent(const physics::FibreFamily& family, Vec3 direction, const Mat3& f, double turning);
Mat3 stressChange(const FibreTangent& tangent, const Mat3& df);
/// dP g_i as a matrix times dx_j, for dF = dx_j g_j^T [Pa/m^2].
Mat3 stiffnessBlock(const FibreTangent& tangent, Vec3 gi, Vec3 gj);

} // namespace filasofia::engine
