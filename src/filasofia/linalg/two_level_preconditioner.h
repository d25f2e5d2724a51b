#pragma once

#include "filasofia/linalg/block_sparse_matrix.h"
#include "filasofia/linalg/rotation_kernels.h"

#include <array>

namespace filasofia {
class WorkerPool;
}

namespace filasofia::linalg {

/// Small pieces, which hang together with nothing else, have a coarse node per node: kPieceNodes each, after all other
/// coarse nodes, whether they need them or not. The coarse level is exact there until followPieces().
constexpr int kPieceNodes = 16;
constexpr int kPieceUnknowns = 3 * kPieceNodes, kPiecePanels = kPieceUnknowns / kBlock;
constexpr std::size_t kPieceRows = static_cast<std::size_t>(kPieceUnknowns) * kPiecePanels; ///< of its inverse
constexpr int firstPieceNode(int coarseNodes) { return (coarseNodes + kPieceNodes - 1) / kPieceNodes * kPieceNodes; }

/// What a preconditioner is made from, once: a matrix, which of its rows are unknowns and in which order, and how they
/// are interpolated from coarse unknowns.
struct PreconditionerInput {
    const BlockSparseMatrix& matrix;               ///< at rest; rows that are not unknowns are left out
    std::span<const int> rows;                     ///< per unknown node: its row in the matrix
    double scale = 1.0;                            ///< the matrix is used times this
    int coarseNodes = 0;                           ///< besides those of small pieces
    std::span<const char> freePieces = {};         ///< per small piece, 1: nothing holds it
    std::span<const std::array<int, 4>> corners;   ///< per matrix row: its coarse nodes
    std::span<const std::array<float, 4>> weights; ///< per matrix row
    int blocks = 0;                                ///< of nodes, where more are wanted than the rows need
};

/// The coarse level of one alone, where the coarse matrix is known.
struct CoarseInput {
    std::span<const double> matrix;   ///< A_c, dense, of three rows per coarse node; its lower half is read
    std::span<const double> pieces;   ///< the same of small pieces, of 3 kPieceNodes rows each, one after another
    std::span<const char> freePieces; ///< as in PreconditionerInput
    int coarseNodes = 0;              ///< of `matrix`
    std::span<const int> rows;        ///< as in PreconditionerInput
    std::span<const std::array<int, 4>> corners;   ///< as in PreconditionerInput
    std::span<const std::array<float, 4>> weights; ///< as in PreconditionerInput
};

/// How a node follows the coarse ones: four of them at most, one may stand there twice with weight 0.
struct Interpolation {
    std::array<int, 4> corners = {};
    std::array<float, 4> weights = {};
};

/// Something that pulls at a node: three numbers of the residual's kind.
struct NodePull {
    int node = 0;
    Vec3 pull;
};

/// An approximate inverse of a matrix of elasticity that was known at rest and has since been turned, node by node:
///
///     z = R ( D^-1 + P A_c^-1 P^T ) R^T r,    A_c = P^T A_rest P,
///
/// D the 3 x 3 blocks on the diagonal (block Jacobi), P the interpolation from a coarse mesh, R the node rotations. The
/// sum of both is symmetric and positive definite whatever P is. A_c is small: its inverse is kept whole, so that
/// applying it is one product of a dense matrix that threads share without waiting for each other, and a small one per
/// small piece.
class TwoLevelPreconditioner {
public:
    TwoLevelPreconditioner() = default;
    explicit TwoLevelPreconditioner(const PreconditionerInput& in);
    /// Without a smoother: for another one to take over.
    explicit TwoLevelPreconditioner(const CoarseInput& in);

    /// The rotation of each node, in blocks; who owns the elements writes them. The identity at first.
    [[nodiscard]] std::vector<RotationBlock>& rotations() { return rotations_; }
    [[nodiscard]] int coarseNodes() const { return coarseNodes_; }

    /// z = M^-1 r; returns r . z
    double apply(const NodeArray& r, NodeArray& z, WorkerPool& pool);

    /// After an edit of the mesh: more blocks of nodes, none of which interpolates anything yet; another block on a
    /// node's diagonal [as the matrix, scaled]; how a node follows the coarse ones from then on. A_c stays what it was:
    /// M^-1 is symmetric and positive definite all the same, and as good as the new body is like the old.
    void grow(int blocks);
    void setDiagonal(int node, const Mat3& block);
    [[nodiscard]] Interpolation interpolation(int node) const;
    void interpolate(int node, const Interpolation& how);
    /// Takes over how another one, with fewer blocks or as many, follows the coarse nodes and what these answer; where
    /// it has none, nothing changes, and the answer is false. Nodes that the other has not interpolate nothing from
    /// then on.
    bool takeCoarseLevel(TwoLevelPreconditioner&& from);

    /// Small pieces that nothing holds: from now on the coarse level has their rigid motions at positions x, and
    /// nothing else of them. What they were at rest says little of a crumb that is crushed, and takes its turns for
    /// stiff. `masses` per node, as they stand in the matrix.
    void followPieces(const NodeArray& x, std::span<const float> masses, double massWeight);

    // The same in two halves, for who changes something between them: R D^-1 R^T r, and z from that and the coarse
    // level's answer to r.
    void smooth(const NodeArray& r, WorkerPool& pool);
    /// The coarse level does not answer to `shares` of the pulls, if any.
    double spread(const NodeArray& r, NodeArray& z, WorkerPool& pool, std::span<const double> shares = {});
    void addToSpread(int node, Vec3 change);            ///< to the r that the coarse level answers to
    [[nodiscard]] Mat3 inverseDiagonal(int node) const; ///< R D^-1 R^T

    // Pulls at the nodes, f, for who knows of more that holds the body there than the matrix does, and corrects the
    // coarse level by it: with Y = A_c^-1 P^T R^T f.
    void clearPulls();
    void addPull(std::span<const NodePull> pull);
    void answerPulls();                                   ///< once all are there
    void answers(int pull, std::span<double> out) const;  ///< per pull: f . R P Y of that pull
    void weigh(std::span<double> sums, WorkerPool& pool); ///< per pull: Y . P^T R^T (r + what was added)

private:
    void restrictResidual(WorkerPool& pool);
    [[nodiscard]] Mat3 rotation(int node) const;
    struct CoarseInverse;
    void makeCoarseLevel(const CoarseInverse& inverse, const CoarseInput& in);
    [[nodiscard]] int latticeRows() const;                             ///< of A_c without small pieces, rounded up
    [[nodiscard]] int nodeOfPiece(std::size_t piece, int place) const; ///< -1: none
    void answerPieces(std::span<const float> felt, std::span<float> answered) const;

    std::vector<RotationBlock> rotations_;
    std::vector<SymmetricBlock> inverseDiagonal_;
    int coarseNodes_ = 0;                           ///< with those of small pieces
    int latticeNodes_ = 0;                          ///< without
    std::vector<InterpolationBlock> interpolation_; ///< P
    Restriction restriction_;                       ///< P^T
    std::vector<PanelRow> coarseInverse_;           ///< A_c^-1, without small pieces
    std::vector<PanelRow> pieceInverses_;           ///< of these, one after another
    std::vector<char> freePieces_;
    NodeArray rest_, smoothed_;
    std::vector<float> coarseResidual_, coarse_;
    int pulls_ = 0;
    std::vector<float> felt_, answered_; ///< P^T R^T f and Y, pull after pull
    std::vector<PanelRow> answeredRows_; ///< Y, sixteen pulls side by side
    std::vector<float> weighed_;
    std::vector<double> sums_;
};

} // namespace filasofia::linalg
