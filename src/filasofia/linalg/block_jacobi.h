#pragma once

#include "filasofia/linalg/rotation_kernels.h"
#include "filasofia/math/mat3.h"

namespace filasofia {
class WorkerPool;
}

namespace filasofia::linalg {

/// The smoother of a TwoLevelPreconditioner: block Jacobi (Saad) in the frame in which each node was at rest.
///
///     s = R^T r,   w = D^-1 s
///
///     r  residual                         s  residual in the rest frame
///     R  rotation of each node            w  smoothed residual, in the rest frame
///     D  3 x 3 blocks on the diagonal of the matrix at rest
class BlockJacobi {
public:
    [[nodiscard]] int blocks() const { return static_cast<int>(inverse_.size()); }
    /// More blocks of nodes; D^-1 of the new nodes is zero until set() is called.
    void grow(int blocks) { inverse_.resize(static_cast<std::size_t>(blocks)); }
    /// Sets the node's block of D.
    void set(int node, const Mat3& block);
    /// Sets D of all nodes, from blocks in world axes.
    void set(const DiagonalTerms& terms, const std::vector<RotationBlock>& rotations, WorkerPool& pool);
    [[nodiscard]] Mat3 inverse(int node) const; ///< D^-1, in the rest frame

    void apply(const std::vector<RotationBlock>& rotations, const NodeArray& r, NodeArray& s, NodeArray& w,
               WorkerPool& pool) const;

private:
    std::vector<SymmetricBlock> inverse_; ///< D^-1
};

} // namespace filasofia::linalg
