#pragma once

#include "filasofia/engine/elastic/element_blocks.h"

/// Blocks of sixteen springs side by side, in floats, as element_blocks.h has elements.
namespace filasofia::engine {

/// The constants of sixteen springs.
struct alignas(64) SpringBlock {
    int nodes[2][kBlock];
    float restLength[kBlock]; ///< [m]
    float stiffness[kBlock];  ///< [N/m], times the system's scale
    float damping[kBlock];    ///< [N s/m], times the system's scale
};

/// The 3 x 3 block of each spring in a step's matrix.
struct alignas(64) SpringMatrixBlock {
    int nodes[2][kBlock];
    float m[6][kBlock]; ///< xx xy xz yy yz zz
};

constexpr int kSpringCorners = 128; ///< floats that a block of springs writes: two groups of sixteen vectors

/// What a pass over the springs writes.
struct SpringOutput {
    std::span<SpringMatrixBlock> matrices;
    std::span<float> corners; ///< force * f(x) - (stiffness * K + damping * D) v
};

/// As updateElements() and multiplyElements().
void updateSprings(std::span<const SpringBlock> springs, const BlockInput& input, linalg::Blocks blocks,
                   const SpringOutput& output);
void multiplySprings(std::span<const SpringMatrixBlock> matrices, const linalg::NodeArray& p, std::span<float> corners,
                     linalg::Blocks blocks);

} // namespace filasofia::engine
