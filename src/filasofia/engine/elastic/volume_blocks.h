#pragma once

#include "filasofia/engine/elastic/element_blocks.h"

/// The volumes of nodes (body/nodal_volume.h) in blocks of sixteen elements, in floats, as element_blocks.h has the
/// elements. Three loops make a product: each element writes its change of volume, each node takes the mean of those
/// around it, and each element adds the forces of the means of its nodes to its corners.
namespace filasofia::engine {

/// How the volumes of sixteen elements depend on their nodes: k_e d(J_e)/dx of nodes 1, 2, 3; node 0 has minus their
/// sum. k_e includes the system's scale.
struct alignas(64) VolumeBlock {
    int nodes[4][kBlock];
    float gradients[9][kBlock];
};

/// What a pass over the elements writes.
struct VolumeOutput {
    std::span<VolumeBlock> volumes;
    std::span<float> changes; ///< per element: k_e (force * (J_e - 1) + stiffness * dJ_e/dt)
};
/// `shares`: k_e of each element.
void updateVolumes(std::span<const ElementBlock> elements, std::span<const float> shares, const BlockInput& input,
                   linalg::Blocks blocks, const VolumeOutput& output);

/// changes = k_e dJ_e for dx = p.
void multiplyVolumes(std::span<const VolumeBlock> volumes, const linalg::NodeArray& p, linalg::Blocks blocks,
                     std::span<float> changes);

/// Adds to each corner the sum of the four nodes' `pressures` times the gradient of its volume.
void addVolumeForces(std::span<const VolumeBlock> volumes, std::span<const float> pressures, linalg::Blocks blocks,
                     std::span<float> corners);

} // namespace filasofia::engine
