#pragma once

#include "filasofia/linalg/two_level_preconditioner.h"

#include "linalg/random_matrix.h"

#include <Eigen/Cholesky>

#include <numeric>

/// What the tests of the two-level preconditioner share: random problems, and the dense matrices that define it.
namespace filasofia::linalg {

/// A copy without the blocks of rows and columns for which `same` does not hold.
template <class Same> BlockSparseMatrix uncoupled(const BlockSparseMatrix& all, const Same& same)
{
    std::vector<std::vector<int>> columns(static_cast<std::size_t>(all.rows()));
    for (int row = 0; row < all.rows(); ++row)
        for (int at = all.rowStarts()[row]; at < all.rowStarts()[row + 1]; ++at)
            if (same(row, all.columns()[at])) columns[static_cast<std::size_t>(row)].push_back(all.columns()[at]);
    BlockSparseMatrix matrix(columns);
    for (int row = 0; row < all.rows(); ++row)
        for (int column : columns[static_cast<std::size_t>(row)])
            matrix.block(matrix.find(row, column)) = all.block(all.find(row, column));
    return matrix;
}

/// A matrix of which some rows are unknowns, in a random order, with coarse nodes for all rows. The first kPieceRows
/// rows are a small piece, the next kPieceRows another, and so on; nothing couples the pieces.
struct PreconditionerProblem {
    static constexpr int kPieceRows = 6;
    PreconditionerProblem(std::mt19937& random, int matrixRows, int unknowns, int coarse, int smallPieces = 0)
        : pieces(smallPieces), matrix(randomSpd(random, matrixRows)), rows(static_cast<std::size_t>(matrixRows)),
          coarseNodes(coarse), corners(rows.size()), weights(rows.size())
    {
        std::iota(rows.begin(), rows.end(), 0);
        std::shuffle(rows.begin(), rows.end(), random);
        rows.resize(static_cast<std::size_t>(unknowns));
        for (std::size_t row = 0; row < corners.size() && coarse > 0; ++row)
            for (std::size_t k = 0; k < 4; ++k) {
                corners[row][k] = static_cast<int>(random() % static_cast<unsigned>(coarse));
                weights[row][k] = k == 3 ? 0.0f : randomFloat(random);
            }
        const auto pieceOf = [&](int row) { return std::min(row / kPieceRows, pieces); };
        matrix = uncoupled(matrix, [&](int row, int column) { return pieceOf(row) == pieceOf(column); });
        for (int row = 0; row < matrixRows && pieces > 0; ++row) {
            if (pieceOf(row) == pieces) continue;
            corners[row].fill(firstPieceNode(coarse) + pieceOf(row) * kPieceNodes + row % kPieceRows);
            weights[row] = {1.0f, 0.0f, 0.0f, 0.0f};
        }
    }
    /// The same without any coarse node.
    [[nodiscard]] PreconditionerProblem withoutCoarseLevel() const
    {
        PreconditionerProblem flat = *this;
        flat.coarseNodes = flat.pieces = 0;
        flat.freePieces.clear();
        return flat;
    }
    [[nodiscard]] int count() const { return static_cast<int>(rows.size()); }
    [[nodiscard]] int allCoarseNodes() const
    {
        return pieces == 0 ? coarseNodes : firstPieceNode(coarseNodes) + pieces * kPieceNodes;
    }
    [[nodiscard]] PreconditionerInput input() const
    {
        return {.matrix = matrix,
                .rows = rows,
                .scale = 2.5,
                .coarseNodes = coarseNodes,
                .freePieces = freePieces,
                .corners = corners,
                .weights = weights};
    }

    int pieces;
    std::vector<char> freePieces = std::vector<char>(static_cast<std::size_t>(pieces), 1);
    BlockSparseMatrix matrix;
    std::vector<int> rows;
    int coarseNodes;
    std::vector<std::array<int, 4>> corners;
    std::vector<std::array<float, 4>> weights;
};

inline Eigen::VectorXd dense(const NodeArray& nodes, int unknowns)
{
    Eigen::VectorXd all(3 * unknowns);
    for (int i = 0; i < 3 * unknowns; ++i) all[i] = static_cast<double>(nodes[i / 3][i % 3]);
    return all;
}

inline Eigen::Matrix3d dense(const Mat3& m)
{
    return Eigen::Matrix3d{{m[0].x, m[0].y, m[0].z}, {m[1].x, m[1].y, m[1].z}, {m[2].x, m[2].y, m[2].z}};
}

/// A_rest over the unknowns, scaled.
inline Eigen::MatrixXd denseMatrix(const PreconditionerProblem& problem)
{
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(3 * problem.count(), 3 * problem.count());
    for (int i = 0; i < problem.count(); ++i)
        for (int j = 0; j < problem.count(); ++j)
            if (const int at = problem.matrix.find(problem.rows[static_cast<std::size_t>(i)],
                                                   problem.rows[static_cast<std::size_t>(j)]);
                at >= 0)
                a.block<3, 3>(3 * i, 3 * j) = problem.input().scale * dense(problem.matrix.block(at));
    return a;
}

/// P, from all coarse nodes to the unknowns.
inline Eigen::MatrixXd denseInterpolation(const PreconditionerProblem& problem)
{
    Eigen::MatrixXd p = Eigen::MatrixXd::Zero(3 * problem.count(), 3 * problem.allCoarseNodes());
    for (int i = 0; i < problem.count(); ++i) {
        const auto row = static_cast<std::size_t>(problem.rows[static_cast<std::size_t>(i)]);
        for (std::size_t k = 0; k < 4 && problem.allCoarseNodes() > 0; ++k)
            p.block<3, 3>(3 * i, 3 * problem.corners[row][k]) +=
                static_cast<double>(problem.weights[row][k]) * Eigen::Matrix3d::Identity();
    }
    return p;
}

/// R D^-1 R^T + R' P A_c^-1 P^T R'^T. The diagonal of A_c is enlarged as the preconditioner does it: by 1e-5 of itself,
/// and by 1e-12 of its largest entry, for coarse nodes that carry nothing.
inline Eigen::MatrixXd densePreconditioner(const PreconditionerProblem& problem,
                                           const std::vector<RotationBlock>& rotations,
                                           const std::vector<RotationBlock>& coarseRotations)
{
    const Eigen::MatrixXd a = denseMatrix(problem), p = denseInterpolation(problem);
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(a.rows(), a.cols()), r = sum, turned = sum;
    for (int i = 0; i < problem.count(); ++i) {
        sum.block<3, 3>(3 * i, 3 * i) =
            Eigen::LLT<Eigen::Matrix3d>(a.block<3, 3>(3 * i, 3 * i)).solve(Eigen::Matrix3d::Identity());
        r.block<3, 3>(3 * i, 3 * i) = dense(rotationOf(rotations, i));
        turned.block<3, 3>(3 * i, 3 * i) = dense(rotationOf(coarseRotations, i));
    }
    sum = r * sum * r.transpose();
    if (problem.allCoarseNodes() > 0) {
        Eigen::MatrixXd coarse = p.transpose() * a * p;
        const double largest = coarse.diagonal().maxCoeff();
        if (largest == 0.0) return sum;
        for (Eigen::Index i = 0; i < coarse.rows(); ++i) coarse(i, i) += 1e-5 * coarse(i, i) + 1e-12 * largest;
        const Eigen::MatrixXd moved = turned * p;
        sum += moved * Eigen::LLT<Eigen::MatrixXd>(coarse).solve(moved.transpose());
    }
    return sum;
}
inline Eigen::MatrixXd densePreconditioner(const PreconditionerProblem& problem,
                                           const std::vector<RotationBlock>& rotations)
{
    return densePreconditioner(problem, rotations, rotations);
}

/// The preconditioner of a problem, with random rotations.
inline TwoLevelPreconditioner rotatedPreconditioner(const PreconditionerProblem& problem, std::mt19937& random)
{
    TwoLevelPreconditioner m(problem.input());
    m.rotations() = randomRotations(random, blocksFor(problem.count()));
    return m;
}

} // namespace filasofia::linalg
