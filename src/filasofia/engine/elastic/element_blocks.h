#pragma once

#include "filasofia/engine/elastic/element_rotations.h"
#include "filasofia/linalg/node_array.h"

#include <span>
#include <vector>

/// Blocks of sixteen elements side by side, in floats: the data of the engine's inner loops. A node is given by the
/// index in a NodeArray at which its vector begins (4 * node). An element writes the contributions to its nodes to its
/// own place in `corners`, and each node gathers them from there (linalg::Gather). No two elements write to the same
/// place, so any thread may compute any element.
namespace filasofia::engine {

using linalg::kBlock;
static_assert(kBlock == kElementsPerBlock);

/// The constants of sixteen tetrahedra. Only an edit of the mesh or of the material changes them. Unused lanes repeat
/// an element with zero stiffness.
struct alignas(64) ElementBlock {
    int nodes[4][kBlock];       ///< 4 * node
    float gradients[9][kBlock]; ///< [1/m] shape gradients of nodes 1, 2, 3; node 0 has minus their sum
    float mu[kBlock];           ///< Lame's mu, times volume and the system's scale
    float ratio[kBlock];        ///< lambda / mu
};

/// What a step's matrix products need of an element: its shape gradients, rotated by its rotation and scaled by the
/// root of its shear stiffness, so that sixteen elements take fifteen cache lines.
struct alignas(64) WarpedBlock {
    int nodes[4][kBlock];
    float gradients[9][kBlock];
    float ratio[kBlock];   ///< lambda / mu; zero if the element is inverted
    float turning[kBlock]; ///< geometric stiffness / mu, times its weight in the step (BlockWeights::turning)
};

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

constexpr int kElementCorners = 256; ///< floats that a block of elements writes: four groups of sixteen vectors
constexpr int kSpringCorners = 128;

/// The weights of the terms of a step.
struct BlockWeights {
    float force = 0.0f;     ///< weight of f
    float stiffness = 0.0f; ///< weight of K in the matrix, and of K v in the right-hand side
    float damping = 0.0f;   ///< weight of D in the matrix, and of D v in the right-hand side
    float turning = 0.0f;   ///< [-] weight of the geometric stiffness, relative to that of K
};

/// The state at the start of a step.
struct BlockInput {
    const linalg::NodeArray& x; ///< [m]
    const linalg::NodeArray& v; ///< [m/s]
    BlockWeights weights = {};
};

/// What a pass over the elements writes, one entry per block but for the corners and quaternions.
struct ElementOutput {
    std::span<ElementRotations> rotations; ///< updated to the positions
    std::span<WarpedBlock> warped;         ///< the input of multiplyElements
    std::span<float> corners;              ///< force * f(x) - stiffness * K v
    std::span<float> quaternions;          ///< one per element, a group of sixteen per block
};
struct SpringOutput {
    std::span<SpringMatrixBlock> matrices;
    std::span<float> corners; ///< the same, less D v
};

/// One pass over these blocks.
void updateElements(std::span<const ElementBlock> elements, const BlockInput& input, linalg::Blocks blocks,
                    const ElementOutput& output);

/// corners = stiffness * K p, with the stiffness weight that updateElements was given.
void multiplyElements(std::span<const WarpedBlock> warped, const linalg::NodeArray& p, std::span<float> corners,
                      linalg::Blocks blocks);

/// The same for springs.
void updateSprings(std::span<const SpringBlock> springs, const BlockInput& input, linalg::Blocks blocks,
                   const SpringOutput& output);
void multiplySprings(std::span<const SpringMatrixBlock> matrices, const linalg::NodeArray& p, std::span<float> corners,
                     linalg::Blocks blocks);

} // namespace filasofia::engine
