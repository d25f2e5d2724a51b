#pragma once

#include "filasofia/math/mat3.h"

#include <array>

/// A triangle of a sheet that resists stretching: a neo-Hookean sheet in plane stress.
///
///     W = mu/2 (phi(t) - 2 + (1 + q) (1 - a) / (q + a)),   t = tr C,  a = det C,  C = F^T F,  q = 1 - 2 nu
///
///     W   energy per volume at rest      F   3 x 2, from the triangle at rest to the present one
///
/// This is mu/2 (|F|^2 - 3) + (lambda + mu)/2 (J - 1)^2 - mu (J - 1), the law of Smith, de Goes and Kim (2018), which
/// is that of neo_hookean.h up to the second order in J - 1, with the stretch s of the thickness that makes it least: s
/// = A (1 + q) / (q + A^2) with the stretch A = sqrt(a) of the area, as stress across the sheet is zero. So energy,
/// force and tangent are finite in every state and need neither axes nor a root of C. For nu = 0.5 it is the
/// incompressible membrane, mu/2 (t + 1/a - 3). phi(t) is t, but below kLeastTrace a parabola, without which a sheet
/// that is crushed to a third would go on to a point.
namespace filasofia::engine {

/// [-] Bound of tr C, which is 2 at rest. For every nu >= 0 a smaller sheet then has more energy.
inline constexpr double kLeastTrace = 2.0 / 3.0;
/// [-] The least q: nu = 0.4995. Without a bound, a sheet that is crushed to a line would have an infinite force.
inline constexpr double kLeastQ = 1e-3;

using TriangleCorners = std::array<Vec3, 3>; ///< one vector per node of a triangle

/// The constants of a triangle. Those of the material are the same in the whole sheet.
struct MembraneElement {
    int triangle = 0; ///< in the Def's mesh
    std::array<int, 3> nodes{};
    /// [1/m^2] 11 12 22: G, the inverse of the products of the edges 01 and 02 at rest. With the present products E,
    /// tr C = G : E and det C = det G det E.
    std::array<double, 3> metric{};
    double area = 0.0;         ///< [m^2] at rest
    double shear = 0.0;        ///< [N/m] mu times the thickness
    double poissonRatio = 0.0; ///< [-]
};

/// A triangle with these corners at rest, without a material.
MembraneElement membraneOn(const std::array<int, 3>& nodes, const TriangleCorners& rest);

/// [J]
double membraneEnergy(const MembraneElement& element, const TriangleCorners& x);

/// [N] forces on the nodes: minus the gradient of the energy.
TriangleCorners membraneForces(const MembraneElement& element, const TriangleCorners& x);

/// [N/m] A tangent as a matrix of the edges 01 and 02: K = sum of B_a^T edges[a][b] B_b, with the edge B_a x.
struct MembraneTangent {
    Mat3 aa, ab, bb;
};

/// The second derivative of the energy without its negative parts: positive semi-definite, and never below the exact
/// one. It is exact where the sheet is in tension in all directions. `turning` [-] weights the geometric stiffness, by
/// which stress resists rotation.
MembraneTangent membraneTangent(const MembraneElement& element, const TriangleCorners& x, double turning = 1.0);

/// [N/m] The block of nodes i and j.
Mat3 stiffnessBlock(const MembraneTangent& tangent, int i, int j);

/// [N] K p
TriangleCorners stiffnessTimes(const MembraneTangent& tangent, const TriangleCorners& p);

/// [Pa] The largest principal Cauchy stress in the sheet, of this thickness [m] at rest; zero if it is crushed to a
/// line.
double membranePrincipalStress(const MembraneElement& element, const TriangleCorners& x, double thickness);
/// [Pa] The Cauchy stress in the sheet.
Mat3 membraneStress(const MembraneElement& element, const TriangleCorners& x, double thickness);

/// [-] The principal stretches in the sheet, the larger one first.
std::array<double, 2> membraneStretches(const MembraneElement& element, const TriangleCorners& x);

/// The stiffness of a sheet [N/m] from the constants of its tissue: mu times the thickness.
constexpr double membraneShear(double youngModulus, double poissonRatio, double thickness)
{
    return youngModulus * thickness / (2.0 * (1.0 + poissonRatio));
}

} // namespace filasofia::engine
