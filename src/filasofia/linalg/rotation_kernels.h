#pragma once

#include "filasofia/linalg/node_kernels.h"
#include "filasofia/math/mat3.h"

/// The inner loops over nodes that rotate vectors, find the rotations of nodes or interpolate from coarse nodes. What
/// node_kernels.h says about bits and sums holds here too.
namespace filasofia::linalg {

struct alignas(64) RotationBlock {
    float m[9][kBlock]; ///< row by row
};
/// The rotation of one node.
inline Mat3 rotationAt(const std::vector<RotationBlock>& rotations, int node)
{
    const auto& m = rotations[static_cast<std::size_t>(node / kBlock)].m;
    const auto at = [&](int k) { return static_cast<double>(m[k][node % kBlock]); };
    return {{{at(0), at(1), at(2)}, {at(3), at(4), at(5)}, {at(6), at(7), at(8)}}};
}

inline void storeRotation(std::vector<RotationBlock>& rotations, int node, const Mat3& rotation)
{
    auto& m = rotations[static_cast<std::size_t>(node / kBlock)].m;
    for (int k = 0; k < 9; ++k) m[k][node % kBlock] = static_cast<float>(rotation[k / 3][k % 3]);
}

struct alignas(64) SymmetricBlock {
    float m[6][kBlock]; ///< xx xy xz yy yz zz
};

/// s = R^T r, w = D^-1 s: a residual in the rest frame, and smoothed there.
void warpAndSmooth(const std::vector<RotationBlock>& rotations, const std::vector<SymmetricBlock>& inverseDiagonal,
                   const NodeArray& r, NodeArray& s, NodeArray& w, Blocks blocks);

/// The 3x3 blocks on the diagonal of a matrix in world axes: the corners hold xx yy zz, `mixed` yz zx xy, laid out
/// alike.
struct DiagonalTerms {
    NodeTerms nodes;
    std::span<const float> mixed;
};
/// The inverses of these blocks, turned into the frame in which each node was at rest.
void invertDiagonal(const DiagonalTerms& terms, const std::vector<RotationBlock>& rotations,
                    std::vector<SymmetricBlock>& inverse, Blocks blocks);

/// s = T s, w = T w
void turnBoth(const std::vector<RotationBlock>& turns, NodeArray& s, NodeArray& w, Blocks blocks);

/// An interpolation from coarse nodes, four entries per node.
struct alignas(64) InterpolationBlock {
    int at[kBlock][4]; ///< 3 * coarse node
    float weights[kBlock][4];
};

/// A vector on coarse nodes, and how nodes follow it. Both are empty without coarse nodes.
struct CoarseCorrection {
    std::span<const InterpolationBlock> interpolation; ///< P
    std::span<const float> values;                     ///< x_c, packed x y z
};

/// z = R (w + P x_c); returns r . z
double prolongAndUnwarp(const std::vector<RotationBlock>& rotations, const CoarseCorrection& coarse, const NodeArray& w,
                        const NodeArray& r, NodeArray& z, Blocks blocks);

/// y = M P x_c with the masses M of the nodes. There must be coarse nodes.
void prolongByMass(const CoarseCorrection& coarse, std::span<const float> masses, NodeArray& y, Blocks blocks);

/// Sets each node's rotation to the mean of the quaternions (x y z w) of the elements around it, or to the identity if
/// there are none. `quaternions` holds a group of sixteen for every four groups of corners.
void averageRotations(const Gather& gather, std::span<const float> quaternions, std::vector<RotationBlock>& rotations,
                      Blocks blocks);

} // namespace filasofia::linalg
