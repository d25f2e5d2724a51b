#include "filasofia/linalg/coarse_inverse.h"

#include "filasofia/linalg/eigen_blocking.h"
#include "filasofia/linalg/small_pieces.h"
#include "filasofia/linalg/write_panels.h"

#include <Eigen/Cholesky>

#include <algorithm>

namespace filasofia::linalg {
namespace {

// Coarse nodes that carry hardly anything of the body make A_c nearly singular. This addition to its diagonal, relative
// to the diagonal, does not slow the iteration, and floats can hold the inverse of the result.
constexpr double kShift = 1e-5;

struct CoarseMatrix {
    Eigen::MatrixXd lattice;
    std::vector<Eigen::MatrixXd> pieces;
};

/// P^T A P without forming P: each block of A goes to the four times four coarse nodes of its row and column. What
/// couples a small piece with anything else, by a node that is held, is left out.
CoarseMatrix galerkin(const PreconditionerInput& in)
{
    std::vector<bool> unknown(static_cast<std::size_t>(in.matrix.rows()));
    for (int row : in.rows) unknown[row] = true;
    CoarseMatrix coarse{Eigen::MatrixXd::Zero(3 * in.coarseNodes, 3 * in.coarseNodes),
                        {in.freePieces.size(), Eigen::MatrixXd::Zero(kPieceUnknowns, kPieceUnknowns)}};
    const int firstPiece = firstPieceNode(in.coarseNodes);
    const auto pieceOf = [&](int node) { return pieceOfNode(node, in.coarseNodes); };
    const auto blockAt = [&](int row, int column) {
        if (row < in.coarseNodes) return coarse.lattice.block<3, 3>(3 * row, 3 * column);
        const int piece = pieceOf(row), first = firstPiece + piece * kPieceNodes;
        return coarse.pieces[static_cast<std::size_t>(piece)].block<3, 3>(3 * (row - first), 3 * (column - first));
    };
    for (int row : in.rows)
        for (int at = in.matrix.rowStarts()[row]; at < in.matrix.rowStarts()[row + 1]; ++at) {
            const int column = in.matrix.columns()[at];
            if (!unknown[column]) continue;
            const Mat3& m = in.matrix.block(at);
            const Eigen::Matrix3d block{{m[0].x, m[0].y, m[0].z}, {m[1].x, m[1].y, m[1].z}, {m[2].x, m[2].y, m[2].z}};
            for (std::size_t a = 0; a < 4; ++a)
                for (std::size_t b = 0; b < 4; ++b) {
                    const double weight = static_cast<double>(in.weights[row][a]) * in.weights[column][b];
                    if (weight == 0.0 || pieceOf(in.corners[row][a]) != pieceOf(in.corners[column][b])) continue;
                    blockAt(in.corners[row][a], in.corners[column][b]) += weight * in.scale * block;
                }
        }
    return coarse;
}

/// A = L L^T of a positive definite matrix whose lower half is given, after kShift has made it well conditioned.
Eigen::LLT<Eigen::MatrixXd> factorOf(Eigen::MatrixXd coarse)
{
    fixBlocking();
    const double largest = coarse.diagonal().maxCoeff();
    for (Eigen::Index i = 0; i < coarse.rows(); ++i) coarse(i, i) += kShift * coarse(i, i) + 1e-12 * largest;
    return Eigen::LLT<Eigen::MatrixXd>(coarse);
}

/// Empty if the matrix is not positive definite to rounding.
Eigen::MatrixXd inverseOf(Eigen::MatrixXd coarse)
{
    const Eigen::LLT<Eigen::MatrixXd> factor = factorOf(std::move(coarse));
    if (factor.info() != Eigen::Success) return {};
    Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(factor.rows(), factor.cols()));
    return inverse.allFinite() ? inverse : Eigen::MatrixXd();
}

/// The same without the operations on zeros: A^-1 = L^-T L^-1 in blocks of columns.
Eigen::MatrixXd quickInverseOf(Eigen::MatrixXd coarse)
{
    constexpr Eigen::Index kColumns = 48;
    const Eigen::LLT<Eigen::MatrixXd> factor = factorOf(std::move(coarse));
    if (factor.info() != Eigen::Success) return {};
    const Eigen::Index n = factor.rows();
    Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(n, n), inverse(n, n); // L^-1
    for (Eigen::Index j = 0; j < n; j += kColumns) {
        const Eigen::Index left = n - j, columns = std::min(kColumns, left);
        lower.block(j, j, left, columns) = factor.matrixLLT()
                                               .bottomRightCorner(left, left)
                                               .triangularView<Eigen::Lower>()
                                               .solve(Eigen::MatrixXd::Identity(left, columns));
    }
    for (Eigen::Index i = 0; i < n; i += kColumns) {
        const Eigen::Index left = n - i, rows = std::min(kColumns, left), columns = i + rows;
        inverse.block(i, 0, rows, columns).noalias() =
            lower.block(i, i, left, rows).transpose() * lower.block(i, 0, left, columns);
        inverse.block(0, i, columns, rows) = inverse.block(i, 0, rows, columns).transpose().eval();
    }
    return inverse.allFinite() ? inverse : Eigen::MatrixXd();
}

/// The inverse of a small piece's matrix, with zeros for the unknowns that the piece does not have. Empty as above.
Eigen::MatrixXd pieceInverseOf(Eigen::MatrixXd piece)
{
    std::vector<Eigen::Index> unused;
    for (Eigen::Index i = 0; i < piece.rows(); ++i)
        if (piece(i, i) == 0.0) unused.push_back(i);
    for (Eigen::Index i : unused) piece(i, i) = 1.0;
    Eigen::MatrixXd inverse = inverseOf(std::move(piece));
    for (Eigen::Index i : unused)
        if (inverse.size() > 0) inverse(i, i) = 0.0;
    return inverse;
}

Eigen::MatrixXd matrixOf(const double* rows, Eigen::Index unknowns)
{
    return Eigen::Map<const Eigen::MatrixXd>(rows, unknowns, unknowns).transpose();
}

std::optional<CoarseInverse> panelsOf(const Eigen::MatrixXd& lattice, int coarseNodes,
                                      const std::vector<Eigen::MatrixXd>& pieces)
{
    if (coarseNodes > 0 && lattice.size() == 0) return std::nullopt;
    CoarseInverse inverse;
    const int rows = coarseRows(coarseNodes);
    inverse.lattice.assign(static_cast<std::size_t>(blocksFor(3 * coarseNodes)) * static_cast<std::size_t>(rows), {});
    writePanels(lattice, rows, inverse.lattice.data());
    inverse.pieces.assign(pieces.size() * kPieceRows, {});
    for (std::size_t p = 0; p < pieces.size(); ++p)
        writePanels(pieces[p], kPieceUnknowns, inverse.pieces.data() + p * kPieceRows);
    return inverse;
}

} // namespace

std::optional<CoarseInverse> coarseInverse(const PreconditionerInput& in)
{
    CoarseMatrix coarse = galerkin(in);
    Eigen::MatrixXd lattice;
    std::vector<Eigen::MatrixXd> pieces;
    if (in.coarseNodes > 0) lattice = inverseOf(std::move(coarse.lattice));
    for (Eigen::MatrixXd& each : coarse.pieces) pieces.push_back(pieceInverseOf(std::move(each)));
    return panelsOf(lattice, in.coarseNodes, pieces);
}

std::optional<CoarseInverse> coarseInverse(const CoarseInput& in)
{
    Eigen::MatrixXd lattice;
    std::vector<Eigen::MatrixXd> pieces;
    if (in.coarseNodes > 0) lattice = quickInverseOf(matrixOf(in.matrix.data(), 3 * in.coarseNodes));
    constexpr std::size_t kNumbers = static_cast<std::size_t>(kPieceUnknowns) * kPieceUnknowns;
    for (std::size_t at = 0; at < in.pieces.size(); at += kNumbers)
        pieces.push_back(pieceInverseOf(matrixOf(in.pieces.data() + at, kPieceUnknowns)));
    return panelsOf(lattice, in.coarseNodes, pieces);
}

bool writePieceInverse(std::span<const double> matrix, std::span<PanelRow> out)
{
    const Eigen::MatrixXd inverse = pieceInverseOf(matrixOf(matrix.data(), kPieceUnknowns));
    if (inverse.size() == 0) return false;
    writePanels(inverse, kPieceUnknowns, out.data());
    return true;
}

} // namespace filasofia::linalg
