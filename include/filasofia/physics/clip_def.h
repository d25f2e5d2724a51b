#pragma once

#include "filasofia/core/attachment_id.h"
#include "filasofia/core/body_id.h"
#include "filasofia/core/fields.h"

namespace filasofia::physics {

/// How a clip holds tissue shut: two legs of metal that bend, and do not spring back. In the coordinates of its rigid
/// element, the legs lie along z with their middle at the origin, and close along y.
struct ClipDef {
    int element = 0;          ///< [-], >= 0, element of the rigid body that is the clip
    double length = 8e-3;     ///< [m], in (0, 0.1], of the legs
    double width = 1.2e-3;    ///< [m], in (0, 0.1], of the legs along x, which is along the tube
    double opening = 6e-3;    ///< [m], in (0, 0.1], > gap: between the legs at first; tissue beyond is not taken
    double gap = 0.4e-3;      ///< [m], in [0, 0.1]: between the legs when they are closed on nothing
    double closingTime = 0.3; ///< [s], in [1e-3, 100]: how long the applier takes to close it
    /// [N], in (0, 1e4]: what its legs bear. If the tissue presses them apart with more, they bend open
    double closingForce = 5.0;
    double stiffness = 5e3; ///< [N/m], in (0, 1e8]: the legs', as long as they do not bend for good
    /// [-], in [0, 10]: mu between legs and tissue. The clip slips off if it is pulled with more than twice this times
    /// the force with which the legs press
    double friction = 0.3;
};

/// Closes a clip, a dynamic rigid body, where it is now, on a soft body. From then on it is attached there.
struct ApplyClip {
    AttachmentId id = {};
    BodyId rigid = {};
    BodyId target = {};
    ClipDef def = {};
};

constexpr auto fields(const ClipDef*)
{
    using T = ClipDef;
    return describe("ClipDef", field("element", &T::element, "-", nonNegative(), "element that is the clip"),
                    field("length", &T::length, "m", openClosed(0, 0.1), "of the legs, along z"),
                    field("width", &T::width, "m", openClosed(0, 0.1), "of the legs, along x"),
                    field("opening", &T::opening, "m", openClosed(0, 0.1), "between the legs at first"),
                    field("gap", &T::gap, "m", closed(0, 0.1), "between the legs when closed on nothing"),
                    field("closingTime", &T::closingTime, "s", closed(1e-3, 100), "how long it takes to close"),
                    field("closingForce", &T::closingForce, "N", openClosed(0, 1e4), "what the legs bear"),
                    field("stiffness", &T::stiffness, "N/m", openClosed(0, 1e8), "of the legs before they bend"),
                    field("friction", &T::friction, "-", closed(0, 10), "mu of the legs on tissue"));
}
constexpr auto fields(const ApplyClip*)
{
    using T = ApplyClip;
    return describe("ApplyClip", field("id", &T::id, "id of the new attachment"), field("rigid", &T::rigid, "the clip"),
                    field("target", &T::target, "the soft body"), field("def", &T::def, "how it holds"));
}

} // namespace filasofia::physics
