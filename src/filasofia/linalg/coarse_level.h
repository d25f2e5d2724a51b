#pragma once

#include "filasofia/linalg/small_pieces.h"

namespace filasofia::linalg {

struct CoarseInverse;

/// The coarse level of a TwoLevelPreconditioner: the Galerkin correction of additive Schwarz methods (Saad).
///
///     x_c = A_c^-1 r_c,   r_c = P^T s,   A_c = P^T A_rest P
///
///     s    residual in the rest frame        P    interpolation from the coarse nodes
///     r_c  residual on the coarse nodes      A_c  Galerkin matrix of the coarse nodes
///     x_c  correction on the coarse nodes
///
/// A_c is small: its inverse is stored whole, so that applying it is one product of a dense matrix, which threads share
/// without waiting for each other, and a small product per small piece. The coarse nodes of the lattice come first,
/// those of small pieces after them (SmallPieces). Vectors over coarse nodes are packed x y z.
class CoarseLevel {
public:
    CoarseLevel() = default; ///< without coarse nodes: it corrects nothing
    CoarseLevel(const PreconditionerInput& in, int blocks);
    explicit CoarseLevel(const CoarseInput& in);

    [[nodiscard]] int coarseNodes() const { return coarseNodes_; } ///< with those of small pieces
    /// More blocks of nodes, which follow no coarse node.
    void resize(int blocks);
    /// How a node follows the coarse nodes; nothing changes if there are none.
    [[nodiscard]] Interpolation interpolation(int node) const;
    void interpolate(int node, const Interpolation& interpolation);
    void followPieces(const PieceMotion& motion) { pieces_.followRigidMotions(interpolation_, motion); }

    /// While it is set aside, A_c^-1 counts as zero in both solve(): x_c = 0.
    void setAside(bool aside) { aside_ = aside; }
    [[nodiscard]] bool isAside() const { return aside_; }

    /// r_c = P^T s
    void restrictResidual(const NodeArray& s, WorkerPool& pool);
    /// x_c = A_c^-1 r_c
    void solve(WorkerPool& pool);
    /// The same for `count` vectors of residual().size() numbers each; the solutions have correction().size() each.
    void solve(std::span<const float> residuals, std::span<float> corrections, std::size_t count) const;

    [[nodiscard]] std::span<const float> residual() const { return residual_; } ///< r_c
    [[nodiscard]] std::span<float> residual() { return residual_; }
    [[nodiscard]] int latticeNodes() const { return latticeNodes_; } ///< without those of small pieces
    /// An entry of A_c^-1, of the lattice: row and column < 3 latticeNodes().
    [[nodiscard]] double inverseEntry(std::size_t row, std::size_t column) const;
    [[nodiscard]] std::span<float> correction() { return correction_; } ///< x_c
    [[nodiscard]] std::span<const float> correction() const { return correction_; }
    [[nodiscard]] const CoarseInterpolation& interpolation() const { return interpolation_; } ///< P

private:
    void build(CoarseInverse&& inverse, const CoarseInput& in, int blocks);

    int coarseNodes_ = 0;  ///< with those of small pieces
    int latticeNodes_ = 0; ///< without
    bool aside_ = false;
    CoarseInterpolation interpolation_;
    std::vector<PanelRow> inverse_; ///< A_c^-1 of the lattice
    SmallPieces pieces_;
    std::vector<float> residual_, correction_;
};

} // namespace filasofia::linalg
