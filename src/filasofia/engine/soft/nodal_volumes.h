#pragma once

#include "filasofia/engine/body/soft_model.h"
#include "filasofia/engine/elastic/volume_blocks.h"
#include "filasofia/linalg/lists.h"

namespace filasofia {
class WorkerPool;
}

namespace filasofia::engine {

/// The volumes of nodes (body/nodal_volume.h) as MatrixFreeSystem computes them: in float, in its slots and blocks.
/// Empty, and free of cost, if the body has none.
class NodalVolumes {
public:
    NodalVolumes() = default;
    /// `slotOf` per node of the model, `slots` in all; `scale` as in MatrixFreeSystem.
    NodalVolumes(const SoftModel& model, std::span<const int> slotOf, std::size_t slots, double scale);

    [[nodiscard]] bool empty() const { return blocks_.empty(); }

    /// Adds force * f - stiffness * K v to the elements' corners.
    void assemble(std::span<const ElementBlock> elements, const BlockInput& input, WorkerPool& pool,
                  std::span<float> corners);
    /// Adds stiffness * K p, with the weight and at the positions of the last assemble().
    void multiply(const linalg::NodeArray& p, WorkerPool& pool, std::span<float> corners);

    /// The part of K at rest that belongs to one node.
    [[nodiscard]] Mat3 diagonalAtRest(const SoftModel& model, int node, std::span<const int> slotOf) const;

    // After an edit of the mesh, nothing of which may do anything to an empty one: first the size, then the corners and
    // shares of its elements, then the nodes that it reached.
    void resize(std::size_t blocks);
    void moveCorner(int element, int before, int after); ///< slots; `before` is -1 for a new element
    void setShare(const FemElement& source, int element);
    void refresh(int slot);

private:
    /// Sums the changes of the elements around each slot, and adds the forces of that, `weight` times.
    void spread(float weight, WorkerPool& pool, std::span<float> corners);

    double scale_ = 1.0;
    float stiffness_ = 0.0f;    ///< weight of K in the step's matrix
    std::vector<float> shares_; ///< k_e per element; zero in the unused lanes of the last block
    std::vector<VolumeBlock> blocks_;
    std::vector<float> changes_;   ///< per element
    linalg::Lists<int> around_;    ///< per slot: its elements
    std::vector<float> inverse_;   ///< per slot: 1 / k_n; zero if that is zero
    std::vector<float> pressures_; ///< per slot: weighted sum over its elements / k_n
};

} // namespace filasofia::engine
