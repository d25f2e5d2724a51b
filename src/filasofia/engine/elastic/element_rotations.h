#pragma once

#include "filasofia/math/quat.h"

namespace filasofia::engine {

constexpr int kElementsPerBlock = 16;

/// The rotations of sixteen elements side by side, in floats, as the engine's inner loops read and write them. Unit
/// quaternions.
struct alignas(64) ElementRotations {
    float x[kElementsPerBlock] = {};
    float y[kElementsPerBlock] = {};
    float z[kElementsPerBlock] = {};
    float w[kElementsPerBlock] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
};

} // namespace filasofia::engine
