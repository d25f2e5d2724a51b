#pragma once

#include "filasofia/engine/elastic/element_blocks.h"

#include <cstdint>

namespace filasofia::engine {

/// What no element's stress is to reach, and the stiffest that there is: all elements are taken to be as stiff.
struct StressLimit {
    float most = 0.0f;   ///< [Pa]
    float mu = 0.0f;     ///< [Pa]
    float lambda = 0.0f; ///< [Pa]
};

/// For blocks [begin, end), which of their sixteen elements may have a principal stress at or above the limit at the
/// positions x: a bit for each, the first the lowest. One without a bit certainly has not, whatever was rounded here;
/// so the bound, with the rotations as they are given and E = F - R,
///     |sigma| <= |P| |F| / det F <= (2 mu |E| + sqrt(3) lambda |tr(R^T F) - 3|) (1 + |E|) / det F
/// in Frobenius norms, which no principal value exceeds, is taken with all of its rounding added.
void findStressed(std::span<const ElementBlock> elements, const linalg::NodeArray& x,
                  std::span<const ElementRotations> rotations, StressLimit limit, std::span<std::uint16_t> stressed,
                  int begin, int end);

} // namespace filasofia::engine
