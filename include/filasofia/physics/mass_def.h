#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/math/quat.h"

#include <variant>

namespace filasofia::physics {

/// [kg/m^3] A soft body may not be lighter than this, a thousandth of air. With the stiffest tissue a step of 1 ms then
/// loses 0.3 % of a fall to rounding, and the more the lighter a body is: at 1e-30 kg/m^3 none falls.
inline constexpr double kLeastDensity = 1e-3;

struct Density {
    double value = 1000.0; ///< [kg/m^3], > 0; of a soft body >= kLeastDensity
};
struct TotalMass {
    double value = 1.0; ///< [kg], > 0, distributed by volume; a soft body's density is then >= kLeastDensity
};
using Mass = std::variant<Density, TotalMass>;

/// A rigid element's inertia as a datasheet gives it.
struct GivenInertia {
    double mass = 1.0;                 ///< [kg], > 0
    Vec3 centre = {};                  ///< [m], centre of mass in the element's coordinates
    Vec3 moments = {1e-4, 1e-4, 1e-4}; ///< [kg m^2], > 0, principal; none larger than the sum of the other two
    Quat axes = {};                    ///< rotation from the principal axes to the element's
};
using RigidMass = std::variant<Density, TotalMass, GivenInertia>;

constexpr auto fields(const Density*)
{
    return describe("Density", field("value", &Density::value, "kg/m^3", positive(), "mass per volume"));
}
constexpr auto fields(const TotalMass*)
{
    return describe("TotalMass", field("value", &TotalMass::value, "kg", positive(), "mass of the whole body"));
}
constexpr auto fields(const GivenInertia*)
{
    using T = GivenInertia;
    return describe("GivenInertia", field("mass", &T::mass, "kg", positive(), "mass of the element"),
                    field("centre", &T::centre, "m", finite(), "centre of mass in the element's coordinates"),
                    field("moments", &T::moments, "kg m^2", positive(), "principal moments of inertia"),
                    field("axes", &T::axes, "rotation from the principal axes to the element's"));
}

} // namespace filasofia::physics
