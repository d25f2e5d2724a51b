#pragma once

#include "filasofia/geometry/box.h"
#include "filasofia/visual/color.h"

#include <vector>

namespace filasofia::visual {

/// A soft cloud: its density falls with the distance from its middle as a Gaussian.
struct SmokePuff {
    Vec3 place = {};      ///< [m], its middle, in the world
    double radius = 0.01; ///< [m], in (0, 1e3], its standard deviation
    double depth =
        0.0; ///< [-], in [0, 1e6], optical depth of a line through its middle: exp(-depth) of the light passes
    double pattern = 0.0; ///< [-], which part of the pattern of its wisps it shows
    friend bool operator==(const SmokePuff&, const SmokePuff&) = default;
};

constexpr auto fields(const SmokePuff*)
{
    using T = SmokePuff;
    return describe("SmokePuff", field("place", &T::place, "m", finite(), "its middle, in the world"),
                    field("radius", &T::radius, "m", openClosed(0, 1e3), "its standard deviation"),
                    field("depth", &T::depth, "-", closed(0, 1e6), "optical depth through its middle"),
                    field("pattern", &T::pattern, "-", finite(), "which part of the pattern it shows"));
}

/// What floats in the air: it dims what is behind it by the law of Beer and Lambert, and scatters the light of the
/// scene's lights. Nothing of it costs anything as long as it is empty.
struct Smoke {
    std::vector<SmokePuff> puffs = {}; ///< at most 256
    double haze = 0.0;                 ///< [1/m], in [0, 1e6], extinction of what is spread evenly over the room
    geometry::Box room = {{}, {}};     ///< [m], in the world; the haze fills it
    Color color = {0.93, 0.95, 0.97};  ///< [-], in [0, 1], share of the light taken that is scattered
    double wisps = 1.0;                ///< [-], in [0, 1], how uneven puffs are; their mean optical depth stays
    friend bool operator==(const Smoke&, const Smoke&) = default;
};
constexpr auto fields(const Smoke*)
{
    using T = Smoke;
    return describe("Smoke", field("puffs", &T::puffs, "soft clouds"),
                    field("haze", &T::haze, "1/m", closed(0, 1e6), "extinction all over the room"),
                    field("room", &T::room, "of the haze"), field("color", &T::color, "share that is scattered"),
                    field("wisps", &T::wisps, "-", closed(0, 1), "how uneven puffs are"));
}

} // namespace filasofia::visual
