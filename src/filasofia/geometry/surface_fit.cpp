#include "filasofia/geometry/surface_fit.h"

#include "filasofia/core/text.h"
#include "filasofia/geometry/box.h"
#include "filasofia/math/rounded.h"

#include <algorithm>

namespace filasofia::geometry {

std::string oddFit(std::span<const Vec3> surface, std::span<const Vec3> mesh)
{
    constexpr double kOutside = 0.1, kSmall = 1.0 / 200.0; // [-] relative to the mesh's diagonal
    const Box drawn = boxAround(surface), around = boxAround(mesh);
    const double size = length(drawn.high - drawn.low), whole = length(around.high - around.low);
    const Vec3 below = around.low - drawn.low, above = drawn.high - around.high;
    const double out = std::max({0.0, below.x, below.y, below.z, above.x, above.y, above.z});
    if (out <= kOutside * whole && size >= kSmall * whole) return {};
    const auto shown = [](double metres) { return metres > 0.0 ? advised(metres) : 0.0; };
    const double ratio = size / whole;
    const bool units = (ratio > 500.0 && ratio < 2000.0) || (ratio > 0.5e-3 && ratio < 2e-3);
    return text("is ", shown(size), " m large, ",
                out > 0.0 ? text("and reaches ", shown(out), " m out of") : std::string("inside"),
                " the body's tetrahedra, which are ", shown(whole), " m large",
                units ? "; if one of them is in millimetres, give it a scale of 0.001" : "");
}

} // namespace filasofia::geometry
