#pragma once

#include "filasofia/math/vec3.h"

#include <array>
#include <cstdint>

namespace filasofia::engine {

/// Where two surfaces are near each other.
struct Proximity {
    std::array<int, 2> surfaces{};                  ///< places in the list, first < second; equal: with itself
    std::array<std::array<int, 3>, 2> vertices{};   ///< of each side; -1: unused
    std::array<std::array<double, 3>, 2> weights{}; ///< barycentric, of each side; 0 where unused
    Vec3 normal;                                    ///< unit, from the second to the first: it opens the gap
    double gap = 0.0;                               ///< [m], negative where they are inside each other
    std::uint64_t feature =
        0; ///< the pair of features: the same number in the next step for the same, unique in a list
};

} // namespace filasofia::engine
