#pragma once

#include "filasofia/linalg/coarse_interpolation.h"

namespace filasofia::linalg {

/// A small piece is a part of a body, of at most kPieceNodes nodes, that is coupled with nothing else. It has one
/// coarse node per node: kPieceNodes each, after all other coarse nodes, whether it needs them or not.
constexpr int kPieceNodes = 16;
constexpr int kPieceUnknowns = 3 * kPieceNodes, kPiecePanels = kPieceUnknowns / kBlock;
constexpr std::size_t kPieceRows = static_cast<std::size_t>(kPieceUnknowns) * kPiecePanels; ///< in an inverse
constexpr int firstPieceNode(int coarseNodes) { return (coarseNodes + kPieceNodes - 1) / kPieceNodes * kPieceNodes; }
/// The piece that a coarse node belongs to; -1 if it is one of the `coarseNodes` others.
constexpr int pieceOfNode(int node, int coarseNodes)
{
    return node < coarseNodes ? -1 : (node - firstPieceNode(coarseNodes)) / kPieceNodes;
}

/// Where the nodes of small pieces are now.
struct PieceMotion {
    const std::vector<RotationBlock>& rotations; ///< R of each node
    const NodeArray& x;                          ///< positions
    std::span<const float> masses;               ///< per node, as in the matrix
    double massWeight = 1.0;                     ///< factor on the masses in the matrix
};

/// The part of a coarse level that belongs to small pieces.
///
///     A_p   the matrix of a piece at rest; y = A_p^-1 x is exact
///     m, J  mass and inertia of a piece that nothing holds
///     d_i   arm of its node i, from its centre of mass
///     R_i   rotation of node i
///
/// If nothing holds a piece, followRigidMotions() replaces A_p^-1 by its rigid motions. An impulse at one node of it
/// moves another by
///
///     1 / massWeight  R_i^T (1/m + [d_i]^T J^-1 [d_j]) R_j
///
/// in the rest frames of both nodes ([d] is the matrix of the cross product with d). The matrix at rest says little
/// about such a piece once it is crushed, and would treat its rotations as stiff.
class SmallPieces {
public:
    SmallPieces() = default;
    /// `inverses`: kPieceRows rows per piece. `latticeNodes`: the coarse nodes in front of theirs.
    SmallPieces(std::vector<PanelRow> inverses, std::span<const char> freePieces, int latticeNodes);

    /// y = A_p^-1 x per piece, in vectors over all coarse nodes. Pieces whose x is zero are only set to zero.
    void solve(std::span<const float> x, std::span<float> y) const;

    /// From now on the pieces that nothing holds have their rigid motions at x, and nothing else.
    void followRigidMotions(const CoarseInterpolation& interpolation, const PieceMotion& motion);

private:
    std::vector<PanelRow> inverses_; ///< A_p^-1, one piece after another
    std::vector<char> freePieces_;   ///< per piece: 1 if nothing holds it
    int firstNode_ = 0;              ///< the first coarse node of the first piece
};

} // namespace filasofia::linalg
