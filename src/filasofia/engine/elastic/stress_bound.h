#pragma once

#include "filasofia/engine/elastic/element_blocks.h"

#include <cstdint>

namespace filasofia::engine {

/// A bound on the stress, the law, and the stiffest material of a body: the bound treats all elements as equally stiff.
struct StressLimit {
    const physics::ElasticLaw& law;
    float most = 0.0f;   ///< [Pa] the stress that no element may reach
    float mu = 0.0f;     ///< [Pa]
    float lambda = 0.0f; ///< [Pa]
};

/// The elements of a body, and where they are.
struct PlacedElements {
    std::span<const ElementBlock> elements;
    const linalg::NodeArray& x; ///< [m]
    std::span<const ElementRotations> rotations;
};

/// For each of these blocks, marks the elements that may have a principal stress at or above the limit at the
/// positions x: one bit per element, the first element the lowest. If an element's bit is 0, it certainly has no such
/// stress, whatever rounding does. For the corotational law the bound, with the rotations as given and E = F - R,
///     |sigma| <= |P| |F| / det F <= (2 mu |E| + sqrt(3) lambda |tr(R^T F) - 3|) (1 + |E|) / det F
/// in Frobenius norms, which no principal value exceeds, is evaluated with all of its rounding error added. For other
/// laws it is the largest principal stress s_i dW/ds_i / J itself, with what an error of F as large as that of rounding
/// can add to it through the second derivatives of the energy.
void findStressed(const PlacedElements& body, const StressLimit& limit, std::span<std::uint16_t> stressed,
                  linalg::Blocks blocks);

} // namespace filasofia::engine
