#pragma once

#include "filasofia/engine/elastic/element_rotations.h"
#include "filasofia/linalg/node_array.h"

#include <span>
#include <vector>

/// Sixteen elements side by side, in floats: what the inner loops of the engine work on. Nodes are named by where their
/// vector begins in a NodeArray (4 * node). What an element says to its nodes goes to its own place in `corners`, and
/// each node gathers from there (linalg::Gather): no two elements write the same place, whoever computes them.
namespace filasofia::engine {

using linalg::kBlock;
static_assert(kBlock == kElementsPerBlock);

/// What never changes of sixteen tetrahedra but by an edit of the mesh or of the material. Lanes that no element needs
/// repeat one without its stiffness.
struct alignas(64) ElementBlock {
    int nodes[4][kBlock];       ///< 4 * node
    float gradients[9][kBlock]; ///< [1/m] of the shape functions of nodes 1, 2, 3; node 0 has minus their sum
    float mu[kBlock];           ///< Lame's, times volume and the system's scale
    float ratio[kBlock];        ///< lambda / mu
};

/// What of an element a step's products need: its shape gradients turned by its rotation and scaled by the root of its
/// shear stiffness, so that sixteen elements take fifteen cache lines.
struct alignas(64) WarpedBlock {
    int nodes[4][kBlock];
    float gradients[9][kBlock];
    float ratio[kBlock];   ///< lambda / mu; zero inside out
    float turning[kBlock]; ///< geometric stiffness / mu, as the step weighs it
};

/// What a spring knows of its rest, sixteen side by side.
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

/// How a step weighs what elements and springs say.
struct BlockWeights {
    float force = 0.0f;     ///< of f
    float stiffness = 0.0f; ///< of K in the matrix, and of K v beside the force
    float damping = 0.0f;   ///< of D in the matrix, and of D v
    float turning = 0.0f;   ///< [-] of the geometric stiffness, by that of K
};

/// One pass over blocks [begin, end): brings the rotations up to date with the positions x, and writes
///     corners      force * f(x) - stiffness * K v
///     quaternions  of each element, a group of sixteen per block
///     warped       what multiplyElements needs
void updateElements(std::span<const ElementBlock> elements, const linalg::NodeArray& x, const linalg::NodeArray& v,
                    BlockWeights weights, std::span<ElementRotations> rotations, std::span<WarpedBlock> warped,
                    std::span<float> corners, std::span<float> quaternions, int begin, int end);

/// corners = stiffness * K p, with the stiffness that updateElements was told.
void multiplyElements(std::span<const WarpedBlock> warped, const linalg::NodeArray& p, std::span<float> corners,
                      int begin, int end);

/// The same two for springs; D v is taken off as well.
void updateSprings(std::span<const SpringBlock> springs, const linalg::NodeArray& x, const linalg::NodeArray& v,
                   BlockWeights weights, std::span<SpringMatrixBlock> matrices, std::span<float> corners, int begin,
                   int end);
void multiplySprings(std::span<const SpringMatrixBlock> matrices, const linalg::NodeArray& p, std::span<float> corners,
                     int begin, int end);

} // namespace filasofia::engine
