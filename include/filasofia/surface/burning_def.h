#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/math/vec3.h"

#include <optional>

namespace filasofia::surface {

/// What heat does to the mechanics of the layer, where all of its collagen is denatured; in proportion where a part is.
///
/// Defaults: the rate by Maitland and Walsh (1997), rat tail tendon: 63 % within 73 s at 60 degrees Celsius, 10 s at
/// 65, 0.2 s at 75; the shrinkage of liver by Rossmann et al. (2014), 12 % at 60 to 22 % at 95 degrees. Stiffness and
/// strength differ by tissue and are rough: liver stiffens by Kiss et al. (2009), tendon weakens by Wall et al. (1999).
struct HeatedTissueDef {
    double shrinkage = 0.2;           ///< [-], in [0, 0.5], part by which lengths at rest become shorter
    double stiffness = 3.0;           ///< [-], in [0.01, 100], Young's modulus relative to before
    double strength = 0.5;            ///< [-], in [0.01, 100], tearing threshold relative to before
    double frequencyFactor = 2.9e56;  ///< [1/s], >= 0, of the denaturation; 0: none
    double activationEnergy = 3.72e5; ///< [J/mol], > 0, of the denaturation
    double rate = 20.0;               ///< [1/s], in [1, 1000], changes of the tissue per simulated second, at most

    friend bool operator==(const HeatedTissueDef&, const HeatedTissueDef&) = default;
};
constexpr auto fields(const HeatedTissueDef*)
{
    using T = HeatedTissueDef;
    return describe(
        "HeatedTissueDef", field("shrinkage", &T::shrinkage, "-", closed(0, 0.5), "of lengths at rest"),
        field("stiffness", &T::stiffness, "-", closed(0.01, 100), "Young's modulus relative to before"),
        field("strength", &T::strength, "-", closed(0.01, 100), "tearing threshold relative to before"),
        field("frequencyFactor", &T::frequencyFactor, "1/s", nonNegative(), "of the denaturation; 0: none"),
        field("activationEnergy", &T::activationEnergy, "J/mol", positive(), "of the denaturation"),
        field("rate", &T::rate, "1/s", closed(1, 1000), "changes of the tissue per simulated second, at most"));
}

/// How a soft body takes heat at its surface, and burns. The heat is in a thin layer; it acts on the tissue's mechanics
/// only with `tissue`. Temperatures are in kelvin: 310.15 K is 37 degrees Celsius.
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
    /// What heat does to the mechanics of a body with a FemMaterial; none: nothing
    std::optional<HeatedTissueDef> tissue = {};
};
constexpr auto fields(const BurningDef*)
{
    using T = BurningDef;
    return describe(
        "BurningDef", field("depth", &T::depth, "m", positive(), "of the layer that is heated"),
        field("density", &T::density, "kg/m^3", positive(), "of the tissue"),
        field("heatCapacity", &T::heatCapacity, "J/(kg K)", positive(), "of the tissue"),
        field("conductivity", &T::conductivity, "W/(m K)", nonNegative(), "of the tissue"),
        field("perfusion", &T::perfusion, "1/s", within(nonNegative(), 1e9), "blood through tissue, by volume"),
        field("bloodHeatCapacity", &T::bloodHeatCapacity, "J/(m^3 K)", positive(), "of blood"),
        field("loss", &T::loss, "W/(m^2 K)", nonNegative(), "to what is below and to the air"),
        field("temperature", &T::temperature, "K", closed(250, 370), "at rest"),
        field("water", &T::water, "-", closed(0, 1), "share of the mass"),
        field("frequencyFactor", &T::frequencyFactor, "1/s", nonNegative(), "of the damage; 0: none"),
        field("activationEnergy", &T::activationEnergy, "J/mol", positive(), "of the damage"),
        field("target", &T::target, "false: its burn is an injury"),
        field("rate", &T::rate, "1/s", closed(1, 1000), "steps of the heat per simulated second"),
        field("tissue", &T::tissue, "what heat does to its mechanics; none: nothing"));
}
/// The last field is younger than the first recordings of burns.
constexpr std::size_t addedFields(const BurningDef*) { return 1; }

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
