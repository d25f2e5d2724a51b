#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/math/vec3.h"

namespace filasofia::surface {

/// How a soft body takes heat at its surface, and burns. The heat is in a thin layer; it does not act on the tissue's
/// mechanics. Temperatures are in kelvin: 310.15 K is 37 degrees Celsius.
///
/// Defaults: liver by the IT'IS database (density, heat capacity, conductivity, perfusion of 0.86 l per minute and kg);
/// damage by Henriques and Moritz (1947), whose numbers are of the skin of pigs and within some minutes of heating.
/// Other tissue differs by orders of magnitude of the frequency factor.
struct BurningDef {
    double depth = 0.002;             ///< [m], > 0, of the layer that is as warm as the surface
    double density = 1060.0;          ///< [kg/m^3], > 0
    double heatCapacity = 3540.0;     ///< [J/(kg K)], > 0
    double conductivity = 0.52;       ///< [W/(m K)], >= 0
    double perfusion = 0.0152;        ///< [1/s], >= 0, blood through tissue, by volume; less where it is damaged
    double bloodHeatCapacity = 3.8e6; ///< [J/(m^3 K)], > 0, of blood
    double loss = 200.0;              ///< [W/(m^2 K)], >= 0, to what is below the layer and to the air
    double temperature = 310.15;      ///< [K], in [250, 370], of tissue at rest, and of all to which heat is lost
    double water = 0.75;              ///< [-], in [0, 1], mass of water in the tissue
    double frequencyFactor = 3.1e98;  ///< [1/s], >= 0, of the damage; 0: none
    double activationEnergy = 6.28e5; ///< [J/mol], > 0, of the damage
    bool target = true;               ///< false: its burn is an injury, and told as one
    double rate = 60.0;               ///< [1/s], in [1, 1000], steps of the heat per simulated second
};
constexpr auto fields(const BurningDef*)
{
    using T = BurningDef;
    return describe("BurningDef", field("depth", &T::depth, "m", positive(), "of the layer that is heated"),
                    field("density", &T::density, "kg/m^3", positive(), "of the tissue"),
                    field("heatCapacity", &T::heatCapacity, "J/(kg K)", positive(), "of the tissue"),
                    field("conductivity", &T::conductivity, "W/(m K)", nonNegative(), "of the tissue"),
                    field("perfusion", &T::perfusion, "1/s", nonNegative(), "blood through tissue, by volume"),
                    field("bloodHeatCapacity", &T::bloodHeatCapacity, "J/(m^3 K)", positive(), "of blood"),
                    field("loss", &T::loss, "W/(m^2 K)", nonNegative(), "to what is below and to the air"),
                    field("temperature", &T::temperature, "K", closed(250, 370), "at rest"),
                    field("water", &T::water, "-", closed(0, 1), "share of the mass"),
                    field("frequencyFactor", &T::frequencyFactor, "1/s", nonNegative(), "of the damage; 0: none"),
                    field("activationEnergy", &T::activationEnergy, "J/mol", positive(), "of the damage"),
                    field("target", &T::target, "false: its burn is an injury"),
                    field("rate", &T::rate, "1/s", closed(1, 1000), "steps of the heat per simulated second"));
}

/// A round source heats the surface around a place until the next Heat of the same number; a power of 0 ends it. The
/// power is divided evenly over the surface within the radius. It is lost if no surface is there.
struct Heat {
    Vec3 place = {};        ///< [m], in the world
    double radius = 0.0015; ///< [m], > 0; infinite: everywhere
    double power = 0.0;     ///< [W], in [0, 1e6]
    double limit = 573.15;  ///< [K], in (0, 1e7]; what is as hot takes no more power: dry tissue conducts no current
    int source = 0;         ///< [-], in [0, 1000], its number: sources of different numbers heat together
};
constexpr auto fields(const Heat*)
{
    using T = Heat;
    return describe("Heat", field("place", &T::place, "m", finite(), "where, in the world"),
                    field("radius", &T::radius, "m", positiveOrInfinite(), "reach"),
                    field("power", &T::power, "W", closed(0, 1e6), "0 ends it"),
                    field("limit", &T::limit, "K", openClosed(0, 1e7), "what is as hot takes no more"),
                    field("source", &T::source, "-", closed(0, 1000), "sources of different numbers heat together"));
}

/// What became of the heat, and what it did: delivered = stored + perfused + lost + boiled + carriedOff, up to
/// rounding.
struct HeatBalance {
    double delivered = 0.0;  ///< [J], power taken by the tissue
    double stored = 0.0;     ///< [J], in the layer, beyond rest
    double perfused = 0.0;   ///< [J], carried away by blood
    double lost = 0.0;       ///< [J], to what is below and to the air
    double boiled = 0.0;     ///< [J], left as steam
    double carriedOff = 0.0; ///< [J], left with pieces; negative where cuts bared warm tissue
    double hottest = 0.0;    ///< [K], now
    double fuming = 0.0;     ///< [J], delivered to tissue at 373.15 K or more, which smokes
    double peak = 0.0;       ///< [K], since the body was added or reset
    double burnt = 0.0;      ///< [m^2], area at rest of what is damaged: omega >= 1
    double charred = 0.0;    ///< [m^2], area at rest of what has no water left
    friend bool operator==(const HeatBalance&, const HeatBalance&) = default;
};

/// What hot tissue gave off around a place within one step of its heat.
struct Fume {
    Vec3 place = {};     ///< [m], in the world
    double taken = 0.0;  ///< [J], by tissue that was at 100 degrees Celsius or more
    double boiled = 0.0; ///< [J], left as steam
};

} // namespace filasofia::surface
