#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/geometry/box.h"
#include "filasofia/math/vec3.h"

#include <limits>
#include <optional>

namespace filasofia::surface {

/// A clear fluid that distends a cavity, as in hysteroscopy, cystoscopy and arthroscopy: it flows in from a bag or a
/// pump, out through a tap, and is lost through leaks and into vessels. Blood that wells in the simulation clouds it,
/// and active electrodes make bubbles. It does not act on bodies.
///
/// Defaults: a uterus that takes 5 ml and 10 ml more at 75 mmHg; tubes through which 100 mmHg press 400 ml per minute
/// in, and out half as much. The yield of gas and the extinction of blood are estimates.
struct DistensionDef {
    geometry::Box room = {};        ///< [m], in the world, of more than no volume; what is seen of the fluid fills it
    double volume = 5e-6;           ///< [m^3], in (0, 1], at the pressure outside; full from the start
    double compliance = 1e-9;       ///< [m^3/Pa], in (0, 1], volume that it takes more per pressure
    double pressure = 0.0;          ///< [Pa], in [0, 1e6], of bag or pump, above that outside
    double inflowResistance = 2e9;  ///< [Pa s/m^3], > 0, of its tube, through which nothing flows back
    double outflowResistance = 4e9; ///< [Pa s/m^3], > 0, of the way out, to the pressure outside
    double inflow = 1.0;            ///< [-], in [0, 1], how far the inflow is open; 0 is closed
    double outflow = 0.0;           ///< [-], in [0, 1], how far the outflow is open
    double leakPressure = 9.3e3;    ///< [Pa], in [0, 1e6], above it fluid is lost, as into vessels
    double leakResistance = std::numeric_limits<double>::infinity(); ///< [Pa s/m^3], > 0, to what is lost; may be
                                                                     ///< infinite
    double deficitLimit = 2.5e-3; ///< [m^3], > 0, what may go in and not come out; may be infinite. 2.5 l of saline
    double turbidity = 0.0;       ///< [1/m], in [0, 1e4], extinction of the fluid without blood
    double extinction = 6000.0;   ///< [1/m], in [0, 1e6], of undiluted blood: a share of blood clouds so much of this
    double gas = 2e-10;           ///< [m^3/J], in [0, 1e-3], bubbles of what active electrodes give
    double bubble = 0.0005;       ///< [m], in (0, 0.1], mean radius of a bubble when it forms
    double bubbleLife = 30.0;     ///< [s], > 0, in which a bubble dissolves to 1/e; may be infinite
    std::optional<Vec3> up = {};  ///< [-], any length > 0, where bubbles rise; not given: against gravity
    double rate = 60.0;           ///< [1/s], in [1, 1000], steps of the fluid per simulated second
};
constexpr auto fields(const DistensionDef*)
{
    using T = DistensionDef;
    return describe(
        "DistensionDef", field("room", &T::room, "what is seen of it, in the world"),
        field("volume", &T::volume, "m^3", openClosed(0, 1), "at the pressure outside"),
        field("compliance", &T::compliance, "m^3/Pa", openClosed(0, 1), "volume that it takes more per pressure"),
        field("pressure", &T::pressure, "Pa", closed(0, 1e6), "of bag or pump, above that outside"),
        field("inflowResistance", &T::inflowResistance, "Pa s/m^3", positive(), "of the tube that leads in"),
        field("outflowResistance", &T::outflowResistance, "Pa s/m^3", positive(), "of the way out"),
        field("inflow", &T::inflow, "-", closed(0, 1), "how far the inflow is open"),
        field("outflow", &T::outflow, "-", closed(0, 1), "how far the outflow is open"),
        field("leakPressure", &T::leakPressure, "Pa", closed(0, 1e6), "above it fluid is lost"),
        field("leakResistance", &T::leakResistance, "Pa s/m^3", positiveOrInfinite(), "to what is lost"),
        field("deficitLimit", &T::deficitLimit, "m^3", positiveOrInfinite(), "what may go in and not come out"),
        field("turbidity", &T::turbidity, "1/m", closed(0, 1e4), "extinction without blood"),
        field("extinction", &T::extinction, "1/m", closed(0, 1e6), "of undiluted blood"),
        field("gas", &T::gas, "m^3/J", closed(0, 1e-3), "bubbles of what active electrodes give"),
        field("bubble", &T::bubble, "m", openClosed(0, 0.1), "mean radius of a new bubble"),
        field("bubbleLife", &T::bubbleLife, "s", positiveOrInfinite(), "bubbles dissolve to 1/e"),
        field("up", &T::up, "-", finite(), "where bubbles rise; not given: against gravity"),
        field("rate", &T::rate, "1/s", closed(1, 1000), "steps of the fluid per simulated second"));
}

/// Turns pump and taps of the distension, from its next step on; what is not given stays.
struct Distend {
    std::optional<double> pressure = {}; ///< [Pa], in [0, 1e6], of bag or pump
    std::optional<double> inflow = {};   ///< [-], in [0, 1], how far it is open
    std::optional<double> outflow = {};  ///< [-], in [0, 1]
};
constexpr auto fields(const Distend*)
{
    using T = Distend;
    return describe("Distend", field("pressure", &T::pressure, "Pa", closed(0, 1e6), "of bag or pump"),
                    field("inflow", &T::inflow, "-", closed(0, 1), "how far the inflow is open"),
                    field("outflow", &T::outflow, "-", closed(0, 1), "how far the outflow is open"));
}

/// What became of the fluid since it was added or reset. atStart + in + bled = out + lost + volume, up to rounding.
struct DistensionBalance {
    double atStart = 0.0;     ///< [m^3]
    double in = 0.0;          ///< [m^3], from bag or pump
    double bled = 0.0;        ///< [m^3], blood that welled into it
    double out = 0.0;         ///< [m^3], through the outflow, blood among it
    double lost = 0.0;        ///< [m^3], through leaks and into vessels
    double volume = 0.0;      ///< [m^3], now
    double blood = 0.0;       ///< [m^3], in it now
    double pressure = 0.0;    ///< [Pa], now, above that outside
    double inflow = 0.0;      ///< [m^3/s], now
    double outflow = 0.0;     ///< [m^3/s], now
    double gasFormed = 0.0;   ///< [m^3], all bubbles
    double gas = 0.0;         ///< [m^3], bubbles now
    bool beyondLimit = false; ///< the deficit is, or was, above the limit
    friend bool operator==(const DistensionBalance&, const DistensionBalance&) = default;
};
/// [m^3], what went in and did not come out, as the scales of a pump tell it.
constexpr double deficit(const DistensionBalance& balance) { return balance.in - balance.out; }
/// [-], share of blood in the fluid.
constexpr double bloodShare(const DistensionBalance& balance)
{
    return balance.volume > 0.0 ? balance.blood / balance.volume : 0.0;
}

} // namespace filasofia::surface
