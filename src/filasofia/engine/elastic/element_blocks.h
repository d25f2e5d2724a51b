#pragma once

#include "filasofia/engine/elastic/relaxation.h"
#include "filasofia/linalg/node_array.h"
#include "filasofia/physics/elastic_law.h"

#include <cstdint>
#include <limits>
#include <span>
#include <variant>
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

/// The tangents of sixteen elements, as a step's matrix products need them, times volume, scale and the weight of the
/// stiffness. Only updateElements() writes them.
///
/// Corotational (corotational.h): the shape gradients, rotated by the element's rotation and scaled by the root of its
/// shear stiffness, so that sixteen elements take fifteen cache lines.
struct alignas(64) WarpedBlock {
    int nodes[4][kBlock];
    float gradients[9][kBlock];
    float ratio[kBlock];   ///< lambda / mu; zero if the element is inverted
    float turning[kBlock]; ///< geometric stiffness / mu, times its weight in the step (BlockWeights::turning)
};
/// Neo-Hookean (neo_hookean.h).
struct alignas(64) NeoHookeanBlock {
    int nodes[4][kBlock];
    float edges[9][kBlock]; ///< [-] from node 0 to nodes 1, 2, 3, times the steepness of the shape gradients
    float gram[6][kBlock];  ///< shear times products of the shape gradients: 11 12 13 22 23 33
    float bulk[kBlock];
    float twist[kBlock];
};
/// Laws of the principal stretches (stretch_law.h).
struct alignas(64) StretchBlock {
    int nodes[4][kBlock];
    float gradients[9][kBlock]; ///< along the axes of the stretches at rest, scaled by the root of the shear stiffness
    float axes[9][kBlock];      ///< of the stretches in the world
    float stretch[6][kBlock];   ///< a / mu: 00 01 02 11 12 22
    float ahead[3][kBlock], across[3][kBlock]; ///< / mu
};
using ElementTangents = std::variant<std::vector<WarpedBlock>, std::vector<NeoHookeanBlock>, std::vector<StretchBlock>>;

/// The constants of one family of fibres in sixteen elements; zero where it has none.
struct alignas(64) FibreBlock {
    float structure[6][kBlock]; ///< [1/m^2] g_i . H g_j: 11 12 13 22 23 33
    float volume[kBlock];       ///< times the system's scale
};
/// Its tangent (fibre.h), times volume, scale and the weight of the stiffness.
struct alignas(64) FibreTangentBlock {
    float turning[6][kBlock]; ///< as FibreBlock::structure
    float along[9][kBlock];   ///< S g_1, S g_2, S g_3, times the root of the stiffness
};

/// The parts of loops over blocks of elements: 256 elements each.
constexpr linalg::Parts elementParts(std::size_t blocks) { return {static_cast<int>(blocks), 16}; }

constexpr int kElementCorners = 256; ///< floats that a block of elements writes: four groups of sixteen vectors

/// The weights of the terms of a step.
struct BlockWeights {
    float force = 0.0f;           ///< weight of f
    float stiffness = 0.0f;       ///< weight of K in the matrix, and of K v in the right-hand side
    float damping = 0.0f;         ///< weight of D in the matrix, and of D v in the right-hand side
    float turning = 0.0f;         ///< [-] weight of the geometric stiffness, which stress adds, relative to that of K
    float fibreStiffness = 0.0f;  ///< as `stiffness`, of fibres
    float fibreTurning = 0.0f;    ///< as `turning`, of fibres
    float volumeStiffness = 0.0f; ///< as `stiffness`, of the volumes of nodes
};

/// The state at the start of a step.
struct BlockInput {
    const linalg::NodeArray& x; ///< [m]
    const linalg::NodeArray& v; ///< [m/s]
    BlockWeights weights = {};
    const RelaxationStep* relaxation = nullptr;                 ///< null: the tissue does not relax
    float validStrain = std::numeric_limits<float>::infinity(); ///< [-] physics::FemMaterial::validStrain
};

/// The families of fibres of a body: one list of blocks per family, one after another.
struct FibreBlocks {
    std::span<const physics::FibreFamily> families;
    std::span<const FibreBlock> blocks;
    std::span<FibreTangentBlock> tangents; ///< written
};

/// What a pass over the elements writes, one entry per block but for the corners and quaternions.
struct ElementOutput {
    std::span<ElementRotations> rotations; ///< updated to the positions
    ElementTangents& tangents;             ///< the input of multiplyElements
    std::span<std::uint16_t> inverted;     ///< one bit per element, the first the lowest: 1 if det F <= 0 or not finite
    /// [-] One per element: by how much a principal stretch differs from 1 at most, or a bound of that which is at most
    /// validStrain. Written only if that is finite.
    std::span<float> strains;
    std::span<float> corners;                     ///< force * f(x) - stiffness * K v
    std::span<float> quaternions;                 ///< one per element, a group of sixteen per block
    std::span<ElementRelaxation> relaxation = {}; ///< updated; only if the tissue relaxes
    FibreBlocks fibres = {};
};

/// The tangents of so many blocks of elements of a law.
ElementTangents makeTangents(const physics::ElasticLaw& law, std::size_t blocks);

/// One pass over these blocks. `tangents` must be of makeTangents() for the law.
void updateElements(const physics::ElasticLaw& law, std::span<const ElementBlock> elements, const BlockInput& input,
                    linalg::Blocks blocks, const ElementOutput& output);

/// corners = stiffness * K p, with the stiffness weight that updateElements was given. `fibres`: one list of blocks per
/// family, one after another.
void multiplyElements(const ElementTangents& tangents, std::span<const FibreTangentBlock> fibres,
                      const linalg::NodeArray& p, std::span<float> corners, linalg::Blocks blocks);

/// The 3x3 blocks on the diagonal of stiffness * K at the corners of elements, in world axes: xx yy zz to `own`, yz zx
/// xy to `mixed`, both laid out as corners. Not for the corotational law, whose blocks are those at rest, rotated.
void diagonalOfElements(const ElementTangents& tangents, std::span<const FibreTangentBlock> fibres,
                        std::span<float> own, std::span<float> mixed, linalg::Blocks blocks);

} // namespace filasofia::engine
