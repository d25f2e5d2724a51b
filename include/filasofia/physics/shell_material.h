#pragma once

#include "filasofia/core/fields.h"

#include <limits>

namespace filasofia::physics {

/// A thin sheet of tissue on a triangle mesh: peritoneum, skin, the wall of a vessel. It resists stretching, and
/// bending away from its shape at rest. Its triangles lie in its middle surface.
///
/// Stretching: a neo-Hookean sheet in plane stress, with C the metric of its middle surface and q = 1 - 2 nu,
/// W = mu/2 (tr C - 2 + (1 + q) (1 - det C) / (q + det C)) per volume at rest. Bending: Kirchhoff's plate on the angles
/// between neighbouring triangles.
struct ShellMaterial {
    double youngModulus = 100e3; ///< [Pa], > 0, at small strain
    double poissonRatio = 0.45;  ///< [-], in [0, 0.5), at small strain
    double thickness = 1e-3;     ///< [m], > 0, at rest; its mass is that of area times thickness
    /// [-], >= 0: the bending stiffness relative to that of a plate, E t^3 / (12 (1 - nu^2)). 0: a membrane, which only
    /// stretches
    double bendingScale = 1.0;
    /// [-], > 0 or infinite: as for FemMaterial, of the stretches in the sheet
    double validStrain = std::numeric_limits<double>::infinity();
    /// [Pa], > 0 or infinite (never): the largest principal Cauchy stress in the sheet at which it tears
    double tearingThreshold = std::numeric_limits<double>::infinity();
};

constexpr auto fields(const ShellMaterial*)
{
    using T = ShellMaterial;
    return describe("ShellMaterial",
                    field("youngModulus", &T::youngModulus, "Pa", positive(), "Young's modulus of the sheet"),
                    field("poissonRatio", &T::poissonRatio, "-", closedOpen(0, 0.5), "Poisson's ratio"),
                    field("thickness", &T::thickness, "m", positive(), "thickness at rest"),
                    field("bendingScale", &T::bendingScale, "-", within(nonNegative(), 1e9),
                          "bending stiffness relative to that of a plate"),
                    field("validStrain", &T::validStrain, "-", positiveOrInfinite(),
                          "strain up to which the constants were measured"),
                    field("tearingThreshold", &T::tearingThreshold, "Pa", positiveOrInfinite(),
                          "largest principal stress at which it tears"));
}

} // namespace filasofia::physics
