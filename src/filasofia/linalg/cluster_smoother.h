#pragma once

#include "filasofia/linalg/small_pieces.h"

namespace filasofia {
class WorkerPool;
}

namespace filasofia::linalg {

/// A smoother that knows how near nodes are coupled: block Jacobi (Saad) with blocks of up to kPieceNodes nodes.
///
///     w_k = A_k^-1 s_k    for each cluster k of nodes, A_k the block of A_rest of its nodes
///
///     s  residual in the rest frame        w  smoothed residual, in the rest frame
///
/// Where a mesh is thin, nodes on both sides are coupled far more stiffly than others. Blocks of single nodes take that
/// for stiffness against every motion, and conjugate gradients then need several times as many iterations.
class ClusterSmoother {
public:
    ClusterSmoother() = default; ///< without clusters
    /// `nodes`: kPieceNodes per cluster, -1 where it has fewer; no node twice. `matrices`: A_k, kPieceUnknowns rows and
    /// columns each, one after another; zero for the nodes that it lacks. The lower half is read. A cluster whose
    /// matrix is not positive definite to rounding is left out.
    ClusterSmoother(std::vector<int> nodes, std::span<const double> matrices);

    [[nodiscard]] bool empty() const { return nodes_.empty(); }
    /// Sets w at the nodes of clusters, and leaves the others as they are.
    void apply(const NodeArray& s, NodeArray& w, WorkerPool& pool) const;

private:
    std::vector<int> nodes_;
    std::vector<PanelRow> inverses_; ///< kPieceRows rows per cluster
};

} // namespace filasofia::linalg
