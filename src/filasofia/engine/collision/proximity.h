#pragma once

#include "filasofia/math/vec3.h"

#include <array>
#include <cstdint>

namespace filasofia::engine {

/// A pair of features by their numbers (CollisionShape::edgeFeature), with the indices of their models in the two
/// bodies' lists of collision models.
struct FeaturePair {
    std::array<int, 2> models{};
    std::array<int, 2> features{};
};

/// The pair as one number: 11 bits for each model, 21 for each feature (kMaxModels, kMaxFeatures).
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

/// A place where two surfaces are near each other.
struct Proximity {
    std::array<int, 2> surfaces{};                  ///< indices in the list, first < second; equal for self-collision
    std::array<std::array<int, 3>, 2> vertices{};   ///< vertices of each side; -1: unused
    std::array<std::array<double, 3>, 2> weights{}; ///< barycentric weights of each side; 0 if unused
    Vec3 normal;                                    ///< unit vector from the second to the first; opens the gap
    double gap = 0.0;                               ///< [m] negative if the surfaces overlap
    /// The pair of features: the same number from step to step, unique among the pairs of two bodies.
    std::uint64_t feature = 0;
    bool parting = false; ///< not a distance: a way out for surfaces that pass through each other
};

} // namespace filasofia::engine
