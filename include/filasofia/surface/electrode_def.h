#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/core/fields.h"
#include "filasofia/math/vec3.h"

#include <array>
#include <optional>
#include <string_view>
#include <vector>

namespace filasofia::surface {

/// What an electrode does while it is active.
enum class EnergyMode {
    Cut,       ///< heats, and lets the blades of its body cut, which they otherwise do not
    Coagulate, ///< heats
    Bipolar,   ///< heats what lies between its tip and the other one, only while both touch tissue
};
/// The values' names in files, in order.
constexpr std::array<std::string_view, 3> names(const EnergyMode*) { return {"cut", "coagulate", "bipolar"}; }

/// The bare metal: a line on an element of a rigid body, in the element's coordinates.
struct ElectrodeTip {
    int element = 0;  ///< [-], >= 0, index in the body
    Vec3 from = {};   ///< [m], one end
    Vec3 to = {};     ///< [m], the other end; equal to `from` and nothing between them: a point
    BodyId body = {}; ///< whose element it is; none: the electrode's. Only the other tip may be another body's
    std::vector<Vec3> through = {}; ///< [m], at most 64: where a bent wire goes on its way; none: it is straight
};
constexpr auto fields(const ElectrodeTip*)
{
    using T = ElectrodeTip;
    return describe("ElectrodeTip", field("element", &T::element, "-", nonNegative(), "index in the body"),
                    field("from", &T::from, "m", finite(), "one end, in the element's coordinates"),
                    field("to", &T::to, "m", finite(), "the other end; the same: a point"),
                    field("body", &T::body, "the other tip's body; none: the electrode's"),
                    field("through", &T::through, "m", finite(), "where a bent wire goes on its way"));
}

/// Makes a rigid body, or a part of one, heat what its tip touches while its pedal is pressed. A body may have several:
/// a hook that cuts and coagulates has two at the same tip.
struct ElectrodeDef {
    EnergyMode mode = EnergyMode::Cut;
    double power = 30.0;    ///< [W], in (0, 1e6], that tissue takes while it is touched
    double radius = 0.0015; ///< [m], in (0, 1], how far from the tip's line tissue is touched, and heated
    double limit = 573.15;  ///< [K], in (0, 1e7]; what is as hot takes no more power: dry tissue conducts no current
    ElectrodeTip tip = {};
    std::optional<ElectrodeTip> other = {}; ///< the second tip of a bipolar one, and of no other
};
constexpr auto fields(const ElectrodeDef*)
{
    using T = ElectrodeDef;
    return describe("ElectrodeDef", field("mode", &T::mode, "what it does while it is active"),
                    field("power", &T::power, "W", openClosed(0, 1e6), "that tissue takes while it is touched"),
                    field("radius", &T::radius, "m", openClosed(0, 1), "reach around the tip's line"),
                    field("limit", &T::limit, "K", openClosed(0, 1e7), "what is as hot takes no more"),
                    field("tip", &T::tip, "the bare metal"),
                    field("other", &T::other, "the second tip of a bipolar one"));
}

/// What an electrode has done since it was added or reset. Tissue takes no more than power * (active - inAir).
struct EnergyBalance {
    double active = 0.0;    ///< [s], with its pedal pressed
    double inAir = 0.0;     ///< [s], the part in which it gave nothing: it touched no tissue that burns
    double delivered = 0.0; ///< [J], taken by tissue
    friend bool operator==(const EnergyBalance&, const EnergyBalance&) = default;
};

} // namespace filasofia::surface
