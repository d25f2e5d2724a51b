#pragma once

#include "filasofia/visual/visual_body.h"

namespace filasofia::runtime {

/// How paint meets what is there already.
enum class PaintMode {
    Add,     ///< nothing becomes less: in whatever order marks are made, and however often, they come out the same
    Replace, ///< towards the new state: washes off too
};

constexpr std::array<std::string_view, 2> names(const PaintMode*) { return {"add", "replace"}; }

/// A mark on whatever is drawn of a body: full up to half of the radius, fading to nothing at it. Surfaces keep it at
/// the vertices of their mesh before subdivision, so a mark smaller than these are apart may reach none.
struct PaintDef {
    Vec3 place = {};                 ///< [m], in the world where the body is now, or `atRest` in its coordinates
    bool atRest = false;             ///< the place is in the body's coordinates at rest
    double radius = 0.005;           ///< [m], > 0, measured at rest
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
                    field("mode", &T::mode, "how it meets what is there"));
}

} // namespace filasofia::runtime
