#pragma once

#include "filasofia/visual/visual_body.h"

namespace filasofia::runtime {

/// How new paint combines with old paint.
enum class PaintMode {
    Add,     ///< nothing becomes less: the result does not depend on the order or number of marks
    Replace, ///< moves towards the new state, so it can also wash off
};

constexpr std::array<std::string_view, 2> names(const PaintMode*) { return {"add", "replace"}; }

/// A mark on everything that is drawn of a body: full strength up to half of the radius, fading to nothing at the
/// radius. Surfaces store it at the vertices of their mesh before subdivision, so a mark smaller than the distance
/// between vertices may reach none.
struct PaintDef {
    Vec3 place = {};       ///< [m], in the world on the body as it is now, or in the body's coordinates if `atRest`
    bool atRest = false;   ///< the place is in the body's coordinates at rest
    double radius = 0.005; ///< [m], > 0, measured at rest
    visual::SurfaceState state = {}; ///< what is painted
    PaintMode mode = PaintMode::Add;
};
constexpr auto fields(const PaintDef*)
{
    using T = PaintDef;
    return describe("PaintDef", field("place", &T::place, "m", finite(), "where"),
                    field("atRest", &T::atRest, "the place is at rest, in the body's coordinates"),
                    field("radius", &T::radius, "m", positive(), "reach, at rest"),
                    field("state", &T::state, "what is painted"),
                    field("mode", &T::mode, "how it combines with old paint"));
}

} // namespace filasofia::runtime
