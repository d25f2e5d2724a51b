#pragma once

#include "filasofia/linalg/block_sparse_matrix.h"

#include <array>
#include <span>

namespace filasofia::linalg {

/// What a TwoLevelPreconditioner is built from: a matrix, which of its rows are unknowns and in which order, and how
/// these are interpolated from coarse nodes.
struct PreconditionerInput {
    const BlockSparseMatrix& matrix;               ///< A_rest; rows that are not unknowns are left out
    std::span<const int> rows;                     ///< per unknown node: its row in the matrix
    double scale = 1.0;                            ///< factor on the matrix
    int coarseNodes = 0;                           ///< coarse nodes of the lattice; small pieces have their own
    std::span<const char> freePieces = {};         ///< per small piece: 1 if nothing holds it
    std::span<const std::array<int, 4>> corners;   ///< per matrix row: its coarse nodes
    std::span<const std::array<float, 4>> weights; ///< per matrix row
    int blocks = 0;                                ///< blocks of nodes, if more are wanted than the rows need
};

/// What a CoarseLevel alone is built from if the coarse matrix is known.
struct CoarseInput {
    std::span<const double> matrix;   ///< A_c of the lattice, dense, three rows per coarse node; its lower half is read
    std::span<const double> pieces;   ///< the same for small pieces, kPieceUnknowns rows each, one after another
    std::span<const char> freePieces; ///< as in PreconditionerInput
    int coarseNodes = 0;              ///< as in PreconditionerInput
    std::span<const int> rows;        ///< as in PreconditionerInput
    std::span<const std::array<int, 4>> corners;   ///< as in PreconditionerInput
    std::span<const std::array<float, 4>> weights; ///< as in PreconditionerInput
};

} // namespace filasofia::linalg
