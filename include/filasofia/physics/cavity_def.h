#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/core/fields.h"
#include "filasofia/math/vec3.h"

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace filasofia::physics {

inline constexpr double kAtmosphere = 101325.0; ///< [Pa] absolute, outside all cavities; pressures are above this one

/// What a cavity holds.
enum class CavityFill {
    Gas,    ///< p V stays the same (Boyle), p being absolute
    Liquid, ///< hardly compressible (CavityDef::bulkModulus), and heavy (CavityDef::density)
    Source, ///< its pressure stays the same, as an insufflator or a raised bag keeps it
};
constexpr std::array<std::string_view, 3> names(const CavityFill*) { return {"gas", "liquid", "source"}; }

/// A cavity of a soft body: a space that its surface encloses, such as a gall bladder, a bowel, an artery's stump. For
/// a body of tetrahedra, it is a closed inner surface of the mesh; for a shell without a rim, it is the space inside.
/// What fills it pushes the wall evenly outwards. If a cut or a tear opens it, the fill flows out through the opening.
struct CavityDef {
    /// [m] a point inside it, at the start, in the world. None: cavities are taken by their volumes, the largest first
    std::optional<Vec3> at = {};
    CavityFill fill = CavityFill::Gas;
    /// [Pa], in (-101325, 1e8), for a Liquid > -bulkModulus: at the start, above that outside. A Liquid loses it as
    /// soon as its wall yields by pressure / bulkModulus of the volume: an inflow tenses a wall, or a Source
    double pressure = 0.0;
    /// [Pa], in [100, 1e10]: by how much the pressure of a Liquid rises per relative loss of volume. Water has 2.2e9;
    /// beyond a thousand times the stiffness of the wall, only the solver's work grows
    double bulkModulus = 1e6;
    /// [kg/m^3], in [1e-3, 1e5]: sets how fast it flows out through an opening, and the weight of a Liquid. None: 1.2
    /// for Gas, 1000 for Liquid and Source
    std::optional<double> density = {};
};

/// Changes what a cavity holds, from the next step on.
struct SetCavity {
    BodyId id = {};
    int cavity = 0; ///< index in SoftBodyDef::cavities
    /// [Pa], in (-101325, 1e8), for a Liquid > -bulkModulus: it is filled or emptied to this pressure at once, which
    /// a Liquid loses as its wall yields; the pressure of a Source
    std::optional<double> pressure = {};
    /// [m^3/s], in [-1e3, 1e3]: what flows in, negative for out, until the next such command: volume at the pressure
    /// outside. Not for a Source. A Reset keeps it
    std::optional<double> inflow = {};
};

/// Throws an Error that begins with `name` if a cavity cannot have this pressure [Pa]: there is no less than nothing of
/// a liquid.
void checkPressure(const CavityDef& cavity, double pressure, const std::string& name);

constexpr auto fields(const CavityDef*)
{
    using T = CavityDef;
    return describe(
        "CavityDef", field("at", &T::at, "m", finite(), "a point inside it; none: the largest come first"),
        field("fill", &T::fill, "what it holds"),
        field("pressure", &T::pressure, "Pa", open(-kAtmosphere, 1e8),
              "at the start, above that outside; a liquid loses it as its wall yields"),
        field("bulkModulus", &T::bulkModulus, "Pa", closed(100, 1e10), "stiffness of a liquid"),
        field("density", &T::density, "kg/m^3", closed(1e-3, 1e5), "of the fill; none: of air or of water"));
}
constexpr auto fields(const SetCavity*)
{
    using T = SetCavity;
    return describe(
        "SetCavity", field("id", &T::id, "the soft body"), field("cavity", &T::cavity, "index of the cavity"),
        field("pressure", &T::pressure, "Pa", open(-kAtmosphere, 1e8), "pressure above that outside"),
        field("inflow", &T::inflow, "m^3/s", closed(-1e3, 1e3), "what flows in until the next such command"));
}

} // namespace filasofia::physics
