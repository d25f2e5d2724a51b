#pragma once

#include "filasofia/engine/elastic/element_blocks.h"

/// Blocks of sixteen triangles of a shell side by side, in floats, as element_blocks.h has elements.
namespace filasofia::engine {

/// The constants of sixteen triangles that resist stretching (membrane.h). Unused lanes have a weight of zero.
struct alignas(64) MembraneBlock {
    int nodes[3][kBlock];    ///< 4 * node
    float metric[3][kBlock]; ///< [1/m^2] 11 12 22
    float det[kBlock];       ///< [1/m^4] determinant of the metric
    float weight[kBlock];    ///< area times shear and the system's scale
    float q[kBlock];         ///< [-] 1 - 2 nu, at least kLeastQ
    float frame[6][kBlock];  ///< [-] unit vectors at rest: along edge 01, and across it in the triangle
};
/// Their tangents, times the weight of the stiffness: the matrix of the edges 01 and 02.
struct alignas(64) MembraneTangentBlock {
    int nodes[3][kBlock];
    float aa[6][kBlock], bb[6][kBlock]; ///< xx xy xz yy yz zz
    float ab[9][kBlock];                ///< by rows
};

/// The constants of sixteen triangles that resist bending (bending.h).
struct alignas(64) BendingBlock {
    int nodes[6][kBlock];
    float restAngles[3][kBlock]; ///< [rad]
    float stiffness[6][kBlock];  ///< [N m] S, times the system's scale
    float leastArea[kBlock];     ///< [m^4]
};
/// Their tangents. Edge i has the gradient -g at the opposite corner and -h at the corner across; the rest is at its
/// ends, in the shares that `feet` gives to the second one.
struct alignas(64) BendingTangentBlock {
    int nodes[6][kBlock];
    float own[3][3][kBlock];    ///< [1/m] g by edge: x y z
    float across[3][3][kBlock]; ///< [1/m] h
    float feet[3][2][kBlock];   ///< [-] those of g and of h
    float stiffness[6][kBlock]; ///< S times the weight of the stiffness
};

constexpr int kMembraneCorners = 192, kBendingCorners = 384; ///< floats that a block writes: groups of sixteen vectors

/// What a pass over triangles that resist stretching writes.
struct MembraneOutput {
    std::span<MembraneTangentBlock> tangents;
    std::span<float> corners;     ///< force * f(x) - stiffness * K v
    std::span<float> quaternions; ///< rotations of the triangles, a group of sixteen per block
};
/// What a pass over triangles that resist bending writes.
struct BendingOutput {
    std::span<BendingTangentBlock> tangents;
    std::span<float> corners;
};

/// As updateElements() and multiplyElements().
void updateMembranes(std::span<const MembraneBlock> membranes, const BlockInput& input, linalg::Blocks blocks,
                     const MembraneOutput& output);
void multiplyMembranes(std::span<const MembraneTangentBlock> tangents, const linalg::NodeArray& p,
                       std::span<float> corners, linalg::Blocks blocks);
void updateBends(std::span<const BendingBlock> bends, const BlockInput& input, linalg::Blocks blocks,
                 const BendingOutput& output);
void multiplyBends(std::span<const BendingTangentBlock> tangents, const linalg::NodeArray& p, std::span<float> corners,
                   linalg::Blocks blocks);

} // namespace filasofia::engine
