#pragma once

#include "filasofia/core/body_id.h"

#include <compare>
#include <cstdint>

namespace filasofia::engine {

/// A pair of features at which two bodies pushed each other in the last step.
struct PushedFeatures {
    BodyId first, second;      ///< as the surfaces of Proximity
    std::uint64_t feature = 0; ///< Proximity::feature
    friend constexpr auto operator<=>(const PushedFeatures&, const PushedFeatures&) = default;
};

} // namespace filasofia::engine
