#pragma once

#include "filasofia/linalg/block_jacobi.h"
#include "filasofia/linalg/cluster_smoother.h"
#include "filasofia/linalg/coarse_deflation.h"

namespace filasofia::linalg {

/// Iterations after which a solve asks for blended rotations: those that end before are spared the cost.
constexpr int kBlendAfter = 8;

/// One entry of a deflation column: three numbers of the residual's kind at a node, world axes.
struct ColumnEntry {
    int node = 0;
    Vec3 value;
};

/// An approximate inverse of an elasticity matrix that was known at rest and has since been rotated, node by node: a
/// smoother and a Galerkin coarse correction, added up (additive Schwarz; Saad).
///
///     z = M^-1 r = R (D^-1 + P A_c^-1 P^T) R^T r,   A_c = P^T A_rest P
///
///     r  residual                   D    3 x 3 blocks on the diagonal of A_rest (BlockJacobi)
///     z  preconditioned residual    P    interpolation from coarse nodes (CoarseInterpolation)
///     R  rotation of each node      A_c  Galerkin matrix of the coarse nodes (CoarseLevel)
///
/// M^-1 is symmetric and positive definite whatever P is. If there are clusters (ClusterSmoother), D consists of their
/// blocks, and of single nodes elsewhere. In two halves, D is that of single nodes.
///
/// Where neighbours have turned against each other, as in a crumpled sheet, A_rest says little about the matrix: M^-1
/// is then made of the present blocks alone (usePresent). Where elements are pressed or stretched far, D may be that of
/// the present matrix (usePresentSmoother).
class TwoLevelPreconditioner {
public:
    TwoLevelPreconditioner() = default;
    explicit TwoLevelPreconditioner(const PreconditionerInput& in);

    /// The rotation of each node, in blocks, which the owner of the elements writes; the identity at first.
    [[nodiscard]] std::vector<RotationBlock>& rotations() { return rotations_; }
    [[nodiscard]] int coarseNodes() const { return coarse_.coarseNodes(); }
    /// Small pieces that nothing holds: the coarse level has their rigid motions at x from now on (SmallPieces).
    /// `masses` per node, as they stand in the matrix.
    void followPieces(const NodeArray& x, std::span<const float> masses, double massWeight);

    /// [-] In [0, 1]: how alike the rotations R_i of the nodes are that follow the same coarse node, where they are
    /// least so: |sum w_i R_i| / (sqrt(3) sum w_i). 1 if there are no coarse nodes.
    [[nodiscard]] double coherence();
    /// Where nodes that follow the same coarse node have turned against each other, as in a tube that is pinched, R P
    /// moves neighbours in different directions, and A_c knows nothing of the strain between them. From now on the
    /// coarse level is B = R' P A_c^-1 P^T R'^T there, with the mean rotations of the coarse nodes, interpolated. To be
    /// called between two solves, or between two iterations if the direction starts anew. Returns whether there is such
    /// a place.
    bool blendRotations();
    void useOwnRotations() { blended_ = false; } ///< R' = R again; to be called once R has changed
    /// From now on M^-1 = D^-1 with these blocks of the present matrix, one per node in world axes, and no coarse level
    /// and no clusters. Empty: M^-1 is that of A_rest again.
    void usePresent(std::span<const Mat3> diagonal);
    /// From now on D are these blocks of the present matrix, without clusters; until usePresent().
    void usePresentSmoother(const DiagonalTerms& diagonal, WorkerPool& pool);

    /// z = M^-1 r; returns r . z
    double apply(const NodeArray& r, NodeArray& z, WorkerPool& pool);

    // The same in two halves, for callers that change something between them: w = R D^-1 R^T r, then z = w + B r with
    // the coarse level B = R P A_c^-1 P^T R^T. D is that of single nodes: what acts on single nodes must be known to
    // it.
    void smooth(const NodeArray& r, WorkerPool& pool);
    /// `coefficients` a of the deflation columns, if any: z = w + B (r - F a). Returns r . z
    double applyCoarse(const NodeArray& r, NodeArray& z, WorkerPool& pool, std::span<const double> coefficients = {});
    void addToCoarseResidual(int node, Vec3 change); ///< to the r that B is applied to
    // For callers that correct r for what the coarse level answers to it, once nothing is added to it any more: the
    // answer A_c^-1 P^T R^T r of each coarse node, packed x y z, and what is subtracted from P^T R^T r.
    std::span<const float> coarseAnswer(WorkerPool& pool);
    void subtractFromCoarse(std::span<const int> coarseNodes, std::span<const float> values, float factor);
    [[nodiscard]] const CoarseLevel& coarseLevel() const { return coarse_; }
    [[nodiscard]] Mat3 inverseDiagonal(int node) const;                                               ///< R D^-1 R^T
    [[nodiscard]] Mat3 rotation(int node) const { return rotationAt(rotations_, node); }              ///< R
    [[nodiscard]] Mat3 coarseRotation(int node) const { return rotationAt(coarseRotations(), node); } ///< R', or R

    /// The part of the impulses r that the coarse nodes can carry: each of them gets its share P^T r and moves the
    /// nodes that follow it by their masses M. The total momentum is that of r, if every node follows a coarse node.
    ///
    ///     carried = M P C^-1 P^T r,   C = diag(P^T M 1), the masses of the coarse nodes
    ///
    /// There must be coarse nodes.
    void carry(std::span<const float> masses, const NodeArray& r, NodeArray& carried, WorkerPool& pool);

    // After an edit of the mesh. A_c stays what it was: M^-1 is symmetric and positive definite all the same, and as
    // good as the new body is similar to the old.
    void grow(int blocks);                         ///< more blocks of nodes, none of which follows coarse nodes yet
    void setDiagonal(int node, const Mat3& block); ///< the node's block of D, scaled as the matrix
    [[nodiscard]] Interpolation interpolation(int node) const { return coarse_.interpolation(node); }
    void interpolate(int node, const Interpolation& how);
    /// Takes over another coarse level, of as many blocks of nodes or fewer; nodes that it does not have follow no
    /// coarse node from then on. Returns false, and changes nothing, if it has no coarse nodes.
    bool takeCoarseLevel(CoarseLevel&& from);
    [[nodiscard]] bool hasClusters() const { return !clusters_.empty(); }
    void setClusters(ClusterSmoother clusters) { clusters_ = std::move(clusters); }

    // Deflation columns F, by which the coarse level B can be corrected (CoarseDeflation).
    void clearColumns() { deflation_.clear(); }
    void addColumn(std::span<const ColumnEntry> column);
    void finishColumns() { deflation_.solve(coarse_); } ///< once all columns are there
    /// B F of a column, per coarse node.
    [[nodiscard]] std::span<const float> columnAnswer(int column) const { return deflation_.solution(column); }
    void products(int column, std::span<double> out) { deflation_.products(column, out); } ///< a row of F^T B F
    /// Per column: F^T B (r + what was added), between smooth() and applyCoarse().
    void project(std::span<double> out, WorkerPool& pool);

private:
    void restrictOnce(WorkerPool& pool);
    void sumRotations();
    [[nodiscard]] double coherenceAt(std::size_t coarseNode) const;
    void turnToBlend(WorkerPool& pool);
    [[nodiscard]] const std::vector<RotationBlock>& coarseRotations() const { return blended_ ? blend_ : rotations_; }
    [[nodiscard]] const BlockJacobi& smoother() const { return presentUsed_ ? present_ : smoother_; }

    std::vector<RotationBlock> rotations_;
    std::vector<RotationBlock> blend_, toBlend_; ///< R', and R'^T R
    bool blended_ = false;
    BlockJacobi smoother_, present_; ///< for A_rest, and the present matrix
    bool presentUsed_ = false;
    ClusterSmoother clusters_;
    CoarseLevel coarse_;
    CoarseDeflation deflation_;
    NodeArray rest_, smoothed_;       ///< R^T r, and D^-1 of it
    bool restricted_ = false;         ///< the coarse level has P^T of it
    std::vector<float> coarseMasses_; ///< C; empty until carry() needs it after an edit
    std::vector<Mat3> turned_;        ///< scratch, per coarse node: the weighted sum of R, and that of the weights
    std::vector<double> weights_;
    std::vector<double> sums_;
};

} // namespace filasofia::linalg
