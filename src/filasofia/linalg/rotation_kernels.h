#pragma once

#include "filasofia/linalg/node_kernels.h"
#include "filasofia/math/mat3.h"

/// The inner loops over nodes that turn vectors, or find out how nodes are turned; made as those of node_kernels.h are.
namespace filasofia::linalg {

struct alignas(64) RotationBlock {
    float m[9][kBlock]; ///< by rows
};
/// The rotation of one node.
inline Mat3 rotationAt(const std::vector<RotationBlock>& rotations, int node)
{
    const auto& m = rotations[static_cast<std::size_t>(node / kBlock)].m;
    const auto at = [&](int k) { return static_cast<double>(m[k][node % kBlock]); };
    return {{{at(0), at(1), at(2)}, {at(3), at(4), at(5)}, {at(6), at(7), at(8)}}};
}

struct alignas(64) SymmetricBlock {
    float m[6][kBlock]; ///< xx xy xz yy yz zz
};

/// s = R^T r, w = D s: a residual in the rest frame, and smoothed there.
void warpAndSmooth(const std::vector<RotationBlock>& rotations, const std::vector<SymmetricBlock>& inverseDiagonal,
                   const NodeArray& r, NodeArray& s, NodeArray& w, Blocks blocks);

/// Four entries per node of an interpolation from coarse nodes.
struct alignas(64) InterpolationBlock {
    int at[kBlock][4]; ///< 3 * coarse node
    float weights[kBlock][4];
};

/// z = R (w + what the coarse nodes say), x y z of the coarse nodes packed; returns r . z. Without coarse nodes `from`
/// is empty.
double prolongAndUnwarp(const std::vector<RotationBlock>& rotations, const std::vector<InterpolationBlock>& from,
                        std::span<const float> coarse, const NodeArray& w, const NodeArray& r, NodeArray& z,
                        Blocks blocks);

/// Each node's rotation: the mean of the quaternions (x y z w) of the elements around it. `quaternions` holds a group
/// of sixteen for every four groups of corners. The identity where there is none.
void averageRotations(const Gather& gather, std::span<const float> quaternions, std::vector<RotationBlock>& rotations,
                      Blocks blocks);

} // namespace filasofia::linalg
