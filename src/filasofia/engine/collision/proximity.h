#pragma once

#include "filasofia/math/vec3.h"

#include <array>
#include <cstdint>

namespace filasofia::engine {

/// A pair of features by their numbers (CollisionShape::edgeFeature), on places of the two bodies' lists of models.
struct FeaturePair {
    std::array<int, 2> models{};
    std::array<int, 2> features{};
};

/// In one number: 11 bits for each model, 21 for each feature (kMostModels, kMostFeatures).
inline std::uint64_t featureNumber(const FeaturePair& pair)
{
    return std::uint64_t(pair.models[0]) << 53 | std::uint64_t(pair.models[1]) << 42 |
           std::uint64_t(pair.features[0]) << 21 | std::uint64_t(pair.features[1]);
}
inline FeaturePair featurePair(std::uint64_t number)
{
    const auto bits = [&](int from, int count) {
        return static_cast<int>(number >> from & ((std::uint64_t{1} << count) - 1));
    };
    return {{bits(53, 11), bits(42, 11)}, {bits(21, 21), bits(0, 21)}};
}

/// Where two surfaces are near each other.
struct Proximity {
    std::array<int, 2> surfaces{};                  ///< places in the list, first < second; equal: with itself
    std::array<std::array<int, 3>, 2> vertices{};   ///< of each side; -1: unused
    std::array<std::array<double, 3>, 2> weights{}; ///< barycentric, of each side; 0 where unused
    Vec3 normal;                                    ///< unit, from the second to the first: it opens the gap
    double gap = 0.0;                               ///< [m], negative where they are inside each other
    /// The pair of features: the same number in the next step for the same, unique among those of two bodies.
    std::uint64_t feature = 0;
};

} // namespace filasofia::engine
