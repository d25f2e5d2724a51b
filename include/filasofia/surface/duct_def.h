#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/math/vec3.h"

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace filasofia::surface {

/// A tube through a soft body in which something flows: a bile duct, an artery. It is a measure: it feels what clips
/// and blades do to the tissue, and does not act on it.
struct DuctDef {
    std::string name = "duct"; ///< what reports call it
    /// [m], at least two points, in the world, at the start: its centre line from the inlet to the outlet
    std::vector<Vec3> path = {};
    double radius = 1e-3;          ///< [m], in [1e-5, 0.1], of the space inside, at the start
    double viscosity = 1e-3;       ///< [Pa s], in [1e-6, 1e3]: blood has 3.5e-3
    double inletPressure = 0.0;    ///< [Pa], in [-1e5, 1e6], above that outside, in what it comes from
    double outletPressure = 0.0;   ///< [Pa], in [-1e5, 1e6], in what it goes to
    double inletResistance = 0.0;  ///< [Pa s/m^3], in [0, 1e15]: that the vessels before its inlet have
    double outletResistance = 0.0; ///< [Pa s/m^3], in [0, 1e15]: that those behind its outlet have
    /// [-], in (0, 1): a place whose flow per pressure is less than this part of that at the start is shut
    double shutBelow = 0.01;
};
constexpr auto fields(const DuctDef*)
{
    using T = DuctDef;
    return describe(
        "DuctDef", field("name", &T::name, "what reports call it"),
        field("path", &T::path, "m", finite(), "its centre line at the start, from the inlet to the outlet"),
        field("radius", &T::radius, "m", closed(1e-5, 0.1), "of the space inside"),
        field("viscosity", &T::viscosity, "Pa s", closed(1e-6, 1e3), "of what flows"),
        field("inletPressure", &T::inletPressure, "Pa", closed(-1e5, 1e6), "before the inlet"),
        field("outletPressure", &T::outletPressure, "Pa", closed(-1e5, 1e6), "behind the outlet"),
        field("inletResistance", &T::inletResistance, "Pa s/m^3", closed(0, 1e15), "of the vessels before its inlet"),
        field("outletResistance", &T::outletResistance, "Pa s/m^3", closed(0, 1e15), "of those behind its outlet"),
        field("shutBelow", &T::shutBelow, "-", open(0, 1), "part of its flow at which a place counts as shut"));
}

/// What has become of a duct.
enum class DuctState {
    Open,     ///< from end to end
    Squeezed, ///< it is whole, and shut somewhere, but by no clip
    Clipped,  ///< it is whole, and shut where a clip is
    Cut,      ///< it is cut through, and nothing flows out
    Leaking,  ///< it is cut through, and flows out
};
constexpr std::array<std::string_view, 5> names(const DuctState*)
{
    return {"open", "squeezed", "clipped", "cut", "leaking"};
}
/// From its inlet to its outlet it is one.
constexpr bool isWhole(DuctState state)
{
    return state == DuctState::Open || state == DuctState::Squeezed || state == DuctState::Clipped;
}

/// A duct after a step.
struct DuctBalance {
    DuctState state = DuctState::Open;
    double flow = 0.0;      ///< [m^3/s] from the inlet to the outlet
    double leak = 0.0;      ///< [m^3/s] out of its cut ends
    double lost = 0.0;      ///< [m^3] that has flowed out of them
    double narrowest = 1.0; ///< [-] where it is narrowest: flow per pressure over that at the start
    int clipsBefore = 0;    ///< [-] clips between the inlet and the cut, or on all of it while it is whole
    int clipsAfter = 0;     ///< [-] clips between the cut and the outlet
    friend bool operator==(const DuctBalance&, const DuctBalance&) = default;
};

} // namespace filasofia::surface
