#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/core/fields.h"
#include "filasofia/math/vec3.h"

#include <limits>
#include <variant>

namespace filasofia::surface {

/// How a soft body bleeds where cuts and tears open it, and how its blood flows. The blood is a film that is seen and
/// counted; it does not act back on the tissue.
struct BleedingDef {
    double flux = 5e-5; ///< [m/s], >= 0, m^3 per second and m^2 of opened surface when it opens
    /// [1/m^2], > 0, open vessels per opened area; few of them make the flux uneven. Infinite: the same everywhere
    double vesselDensity = 2e5;
    double clottingTime = 180.0;   ///< [s], > 0, in which the flux falls to 1/e and the blood's viscosity rises by e
    double viscosity = 4e-3;       ///< [Pa s], in [1e-4, 1e3], of fresh blood
    double density = 1060.0;       ///< [kg/m^3], > 0
    double surfaceTension = 0.056; ///< [N/m], > 0; the larger, the longer blood hangs from an overhang
    double clinging = 3e-5;        ///< [m], >= 0, thickness of the film that stays where it is
    double rate = 60.0;            ///< [1/s], in [1, 1000], steps of the film per simulated second
};
constexpr auto fields(const BleedingDef*)
{
    using T = BleedingDef;
    return describe(
        "BleedingDef", field("flux", &T::flux, "m/s", nonNegative(), "m^3 per second and m^2 of opened surface"),
        field("vesselDensity", &T::vesselDensity, "1/m^2", positiveOrInfinite(), "few vessels make the flux uneven"),
        field("clottingTime", &T::clottingTime, "s", positive(), "flux falls to 1/e, viscosity rises by e"),
        field("viscosity", &T::viscosity, "Pa s", closed(1e-4, 1e3), "of fresh blood"),
        field("density", &T::density, "kg/m^3", positive(), "of blood"),
        field("surfaceTension", &T::surfaceTension, "N/m", positive(), "holds blood on overhangs"),
        field("clinging", &T::clinging, "m", nonNegative(), "thickness of the film that does not flow"),
        field("rate", &T::rate, "1/s", closed(1, 1000), "steps of the film per simulated second"));
}

/// From now on wounds bleed with this fraction of their flux: 0 pauses them, as pressing on the artery does.
struct Perfuse {
    double share = 1.0; ///< [-], in [0, 100]
};
/// Makes the surface around a place bleed as if it were opened now: a scratch, a puncture, an ulcer.
struct Injure {
    Vec3 place = {};       ///< [m], in the world
    double radius = 0.003; ///< [m], > 0
};
/// Closes the vessels around a place for good: burnt, clipped or sutured. New cuts there bleed again.
struct Seal {
    Vec3 place = {};       ///< [m], in the world
    double radius = 0.003; ///< [m], > 0
};
/// Sucks blood up from around a place until the next Suck; a rate of 0 ends it.
struct Suck {
    Vec3 place = {};       ///< [m], in the world, or in the coordinates of the body's element
    double radius = 0.005; ///< [m], > 0
    double rate = 0.0;     ///< [m^3/s], >= 0
    BodyId body = {};      ///< a rigid body that carries the opening; none: it stays where it is
    int element = 0;       ///< [-], >= 0, index in that body
};
/// Washes the blood away around a place; clots too. Wounds go on bleeding. With an infinite rate it does so at once.
/// Otherwise liquid flows until the next such Rinse, and takes along as much blood as its own volume; a rate of 0 ends
/// it.
struct Rinse {
    Vec3 place = {}; ///< [m], in the world, or in the coordinates of the body's element
    double radius = std::numeric_limits<double>::infinity(); ///< [m], > 0; infinite: everywhere
    double rate = std::numeric_limits<double>::infinity();   ///< [m^3/s], >= 0, of liquid
    BodyId body = {}; ///< a rigid body that carries the nozzle; none: it stays where it is
    int element = 0;  ///< [-], >= 0, index in that body
};
/// Blood that a vessel pours onto the surface around a place, or, if nothing of it is so near, onto its nearest point.
struct Pour {
    Vec3 place = {};       ///< [m], in the world
    double radius = 0.003; ///< [m], > 0
    double volume = 0.0;   ///< [m^3], in [0, 1]
};
using BloodCommand = std::variant<Perfuse, Injure, Seal, Suck, Rinse, Pour>;

constexpr auto fields(const Perfuse*)
{
    return describe("Perfuse", field("share", &Perfuse::share, "-", closed(0, 100), "fraction of the flux"));
}
constexpr auto fields(const Injure*)
{
    return describe("Injure", field("place", &Injure::place, "m", finite(), "where, in the world"),
                    field("radius", &Injure::radius, "m", positive(), "reach"));
}
constexpr auto fields(const Seal*)
{
    return describe("Seal", field("place", &Seal::place, "m", finite(), "where, in the world"),
                    field("radius", &Seal::radius, "m", positive(), "reach"));
}
constexpr auto fields(const Suck*)
{
    return describe("Suck", field("place", &Suck::place, "m", finite(), "in the world, or on the body's element"),
                    field("radius", &Suck::radius, "m", positive(), "reach"),
                    field("rate", &Suck::rate, "m^3/s", nonNegative(), "0 ends it"),
                    field("body", &Suck::body, "a rigid body that carries the opening"),
                    field("element", &Suck::element, "-", nonNegative(), "index in that body"));
}
constexpr auto fields(const Rinse*)
{
    return describe("Rinse", field("place", &Rinse::place, "m", finite(), "in the world, or on the body's element"),
                    field("radius", &Rinse::radius, "m", positiveOrInfinite(), "reach"),
                    field("rate", &Rinse::rate, "m^3/s", nonNegativeOrInfinite(), "of liquid; infinite: at once"),
                    field("body", &Rinse::body, "a rigid body that carries the nozzle"),
                    field("element", &Rinse::element, "-", nonNegative(), "index in that body"));
}
constexpr auto fields(const Pour*)
{
    return describe("Pour", field("place", &Pour::place, "m", finite(), "where, in the world"),
                    field("radius", &Pour::radius, "m", positive(), "reach"),
                    field("volume", &Pour::volume, "m^3", closed(0, 1), "of blood"));
}

/// What became of the blood, [m^3]: welled = onTissue + sucked + rinsed + dripped + carriedOff, up to rounding.
struct BloodBalance {
    double welled = 0.0;     ///< blood lost by the vessels
    double onTissue = 0.0;   ///< what lies on the body now
    double sucked = 0.0;     ///< taken by Suck
    double rinsed = 0.0;     ///< taken by Rinse
    double dripped = 0.0;    ///< fell from overhangs, or left at the rim of a sheet
    double carriedOff = 0.0; ///< left with pieces that were removed
    double rate = 0.0;       ///< [m^3/s], what wells now
    friend bool operator==(const BloodBalance&, const BloodBalance&) = default;
};

} // namespace filasofia::surface
