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

/// One pass over blocks [begin, end): updates the rotations to the positions x, and writes
///     corners      force * f(x) - stiffness * K v
///     quaternions  one per element, a group of sixteen per block
///     warped       the input of multiplyElements
void updateElements(std::span<const ElementBlock> elements, const linalg::NodeArray& x, const linalg::NodeArray& v,
                    BlockWeights weights, std::span<ElementRotations> rotations, std::span<WarpedBlock> warped,
                    std::span<float> corners, std::span<float> quaternions, int begin, int end);

/// corners = stiffness * K p, with the stiffness weight that updateElements was given.
void multiplyElements(std::span<const WarpedBlock> warped, const linalg::NodeArray& p, std::span<float> corners,
                      int begin, int end);

/// The same for springs; updateSprings subtracts D v as well.
void updateSprings(std::span<const SpringBlock> springs, const linalg::NodeArray& x, const linalg::NodeArray& v,
                   BlockWeights weights, std::span<SpringMatrixBlock> matrices, std::span<float> corners, int begin,
                   int end);
void multiplySprings(std::span<const SpringMatrixBlock> matrices, const linalg::NodeArray& p, std::span<float> corners,
                     int begin, int end);

} // namespace filasofia::engine
