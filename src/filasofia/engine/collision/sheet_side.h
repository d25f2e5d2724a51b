#pragma once

#include "filasofia/core/body_id.h"

#include <array>
#include <compare>

namespace filasofia::engine {

/// Identifies a surface from step to step, whatever other bodies are added or removed.
struct SurfaceName {
    BodyId body;
    int model = 0; ///< index among the body's collision models
    friend constexpr auto operator<=>(const SurfaceName&, const SurfaceName&) = default;
};

/// The side of a sheet that a point was on. For a point's own surface: whether it was outside, or behind another wall.
struct SheetSide {
    SurfaceName source;           ///< the surface that the point belongs to
    SurfaceName target;           ///< the sheet
    int point = 0;                ///< vertex of the source
    std::array<int, 3> feature{}; ///< vertices of the nearest feature; -1: unused
    int side = 1;                 ///< 1 or -1
    friend constexpr auto operator<=>(const SheetSide&, const SheetSide&) = default;
};

} // namespace filasofia::engine
