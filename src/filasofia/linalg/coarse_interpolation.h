#pragma once

#include "filasofia/linalg/preconditioner_input.h"
#include "filasofia/linalg/rotation_kernels.h"

namespace filasofia {
class WorkerPool;
}

namespace filasofia::linalg {

/// How one node follows the coarse nodes: at most four of them; one may appear twice, with weight 0.
struct Interpolation {
    std::array<int, 4> corners = {};
    std::array<float, 4> weights = {};
};

/// The interpolation from coarse nodes to nodes.
///
///     P    from coarse values to nodes, stored per node for the prolongation
///     P^T  from nodes to coarse values, stored per coarse node for the restriction
class CoarseInterpolation {
public:
    CoarseInterpolation() = default;
    /// `blocks` of nodes and `coarseNodes` coarse ones, those of small pieces included.
    CoarseInterpolation(const CoarseInput& in, int blocks, int coarseNodes);

    /// More blocks of nodes, which follow no coarse node; or fewer.
    void resize(int blocks) { blocks_.resize(static_cast<std::size_t>(blocks)); }

    [[nodiscard]] Interpolation at(int node) const;
    void set(int node, const Interpolation& interpolation);

    /// coarse = P^T s
    void restrictTo(std::span<float> coarse, const NodeArray& s, WorkerPool& pool) const;
    /// coarse += P^T of a vector that is zero but for `value` at one node.
    void addRestricted(int node, Vec3 value, std::span<float> coarse) const;
    /// P^T m for a number per node.
    [[nodiscard]] std::vector<float> restrictNumbers(std::span<const float> m) const;
    /// The first node that follows a coarse node, or -1.
    [[nodiscard]] int firstNode(std::size_t coarse) const;

    [[nodiscard]] const std::vector<InterpolationBlock>& blocks() const { return blocks_; } ///< P, for kernels

private:
    std::vector<InterpolationBlock> blocks_; ///< P
    Restriction restriction_;                ///< P^T
};

} // namespace filasofia::linalg
