#pragma once

#include "filasofia/core/body_id.h"

#include <array>
#include <compare>

namespace filasofia::engine {

/// Which surface: the same from step to step, whatever other bodies come and go.
struct SurfaceName {
    BodyId body;
    int model = 0; ///< place among the body's collision models
    friend constexpr auto operator<=>(const SurfaceName&, const SurfaceName&) = default;
};

/// On which side of a sheet a point was; of its own surface, whether it was outside.
struct SideKept {
    SurfaceName source;           ///< whose point it is
    SurfaceName target;           ///< the sheet
    int point = 0;                ///< vertex of the source
    std::array<int, 3> feature{}; ///< vertices of what was nearest; -1: unused
    int side = 1;                 ///< 1 or -1
    friend constexpr auto operator<=>(const SideKept&, const SideKept&) = default;
};

} // namespace filasofia::engine
