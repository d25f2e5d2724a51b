#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/core/fields.h"
#include "filasofia/geometry/box.h"
#include "filasofia/math/vec3.h"

namespace filasofia::surface {

/// The smoke and steam of burning tissue in a closed room, as the abdomen is: emitted by what is heated to 100 degrees
/// Celsius or more, carried up by its warmth, spread, stirred, vented and extracted. It does not act on bodies.
///
/// Defaults: one joule boils 0.6 mg of tissue, a quarter of it solid, of which a tenth leaves as smoke (an estimate:
/// published yields of smouldering matter span 1 to 17 %). Extinction of smoke from pyrolysis: 4.4 m^2/g (Seader and
/// Einhorn 1977); droplets of 2 micrometres have, by Mie's limit of 2, 750 m^2/kg. A tenth of the steam condenses.
struct SmokeDef {
    geometry::Box room = {};        ///< [m], in the world, of more than no volume; nothing leaves it by itself
    double yield = 1.5e-8;          ///< [kg/J], in [0, 1e-3], smoke of what tissue at 100 degrees or more takes
    double steam = 0.1;             ///< [-], in [0, 1], share of the boiled water that becomes droplets
    double extinction = 4400.0;     ///< [m^2/kg], in [0, 1e6], of smoke: how much it dims what is behind it
    double steamExtinction = 750.0; ///< [m^2/kg], in [0, 1e6], of droplets
    double albedo = 0.95;           ///< [-], in [0, 1], share of the light taken that is scattered: 0 is black
    double settling = 600.0;        ///< [s], > 0, in which smoke settles on walls to 1/e; may be infinite
    double drying = 1.0;            ///< [s], > 0, in which droplets dry up to 1/e; may be infinite
    double inflow = 0.0;            ///< [m^3/s], in [0, 1], of fresh gas, which pushes as much of the old one out
    double warmth = 0.03;           ///< [-], in [0, 1], share of that power which warms the gas that rises with it
    double entrainment = 0.25;      ///< [-], in (0, 1], how much wider a puff becomes per way up: 0.25 by Turner (1973)
    double diffusivity = 1e-4;      ///< [m^2/s], in [0, 1], by eddies
    double mixing = 2.5;            ///< [s], > 0, in which a puff loses 1/e of itself to all the room; may be infinite
    double radius = 0.003;          ///< [m], in (0, 1], of a puff when it rises (its standard deviation)
    int seed = 1;                   ///< [-], >= 0, of the ways that puffs drift
    double rate = 60.0;             ///< [1/s], in [1, 1000], steps of the smoke per simulated second
};
constexpr auto fields(const SmokeDef*)
{
    using T = SmokeDef;
    return describe("SmokeDef", field("room", &T::room, "where it stays, in the world"),
                    field("yield", &T::yield, "kg/J", closed(0, 1e-3), "smoke of what hot tissue takes"),
                    field("steam", &T::steam, "-", closed(0, 1), "share of boiled water that becomes droplets"),
                    field("extinction", &T::extinction, "m^2/kg", closed(0, 1e6), "of smoke"),
                    field("steamExtinction", &T::steamExtinction, "m^2/kg", closed(0, 1e6), "of droplets"),
                    field("albedo", &T::albedo, "-", closed(0, 1), "share of light that is scattered; 0: black"),
                    field("settling", &T::settling, "s", positiveOrInfinite(), "smoke settles to 1/e"),
                    field("drying", &T::drying, "s", positiveOrInfinite(), "droplets dry up to 1/e"),
                    field("inflow", &T::inflow, "m^3/s", closed(0, 1), "fresh gas, which pushes old gas out"),
                    field("warmth", &T::warmth, "-", closed(0, 1), "share of the power that warms rising gas"),
                    field("entrainment", &T::entrainment, "-", openClosed(0, 1), "growth of a puff per way up"),
                    field("diffusivity", &T::diffusivity, "m^2/s", closed(0, 1), "by eddies"),
                    field("mixing", &T::mixing, "s", positiveOrInfinite(), "puffs mix with all the room to 1/e"),
                    field("radius", &T::radius, "m", openClosed(0, 1), "of a puff when it rises"),
                    field("seed", &T::seed, "-", nonNegative(), "of the ways that puffs drift"),
                    field("rate", &T::rate, "1/s", closed(1, 1000), "steps of the smoke per simulated second"));
}

/// Sucks gas, and the smoke in it, away at a place until the next Extract of the same number; a flow of 0 ends it. It
/// is replaced by fresh gas.
struct Extract {
    Vec3 place = {};   ///< [m], in the world, or in the coordinates of the body's element
    double flow = 0.0; ///< [m^3/s], in [0, 1]
    BodyId body = {};  ///< a rigid body that carries the opening; none: it stays where it is
    int element = 0;   ///< [-], >= 0, index in that body
    int source = 0;    ///< [-], in [0, 1000], its number: openings of different numbers act together
};
constexpr auto fields(const Extract*)
{
    using T = Extract;
    return describe("Extract", field("place", &T::place, "m", finite(), "in the world, or on the body's element"),
                    field("flow", &T::flow, "m^3/s", closed(0, 1), "0 ends it"),
                    field("body", &T::body, "a rigid body that carries the opening"),
                    field("element", &T::element, "-", nonNegative(), "index in that body"),
                    field("source", &T::source, "-", closed(0, 1000), "openings of different numbers act together"));
}

/// What became of an aerosol, [kg]: emitted = inAir + extracted + vented + settled, up to rounding.
struct AerosolBalance {
    double emitted = 0.0;
    double inAir = 0.0;     ///< now
    double extracted = 0.0; ///< by Extract
    double vented = 0.0;    ///< pushed out by fresh gas
    double settled = 0.0;   ///< on walls; droplets dry up
    friend bool operator==(const AerosolBalance&, const AerosolBalance&) = default;
};
struct SmokeBalance {
    AerosolBalance smoke = {};
    AerosolBalance steam = {}; ///< droplets of condensed steam
    friend bool operator==(const SmokeBalance&, const SmokeBalance&) = default;
};

} // namespace filasofia::surface
